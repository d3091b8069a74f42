"use strict";
/* Draws the field of a hunt from above: ground, robots, plans. A pen is { g: canvas context, at: world to pixels, ink:
   colours by their meaning, view }. Before player.js. */

/* Points of the arc that leaves `from` [x, y, theta] along its heading and ends at `to`. */
function arcPoints(from, to) {
  const dx = to[0] - from[0], dy = to[1] - from[1];
  const chord = Math.hypot(dx, dy), bend = wrap(Math.atan2(dy, dx) - from[2]);
  if (chord < 1e-6 || Math.abs(bend) < 1e-3 || Math.abs(bend) > 1.9) return [to];
  const radius = chord / (2 * Math.sin(bend));
  return Array.from({ length: 12 }, (_, i) => {
    const heading = from[2] + (2 * bend * (i + 1)) / 12;
    return [
      from[0] + radius * (Math.sin(heading) - Math.sin(from[2])),
      from[1] - radius * (Math.cos(heading) - Math.cos(from[2])),
    ];
  });
}

function line({ g, at }, points) {
  g.beginPath();
  points.forEach((point, i) => (i ? g.lineTo(...at(point)) : g.moveTo(...at(point))));
  g.stroke();
}

function dot({ g, at }, point, size, hollow) {
  g.beginPath();
  g.arc(...at(point), size, 0, 2 * Math.PI);
  if (hollow) g.stroke();
  else g.fill();
}

function drawGround({ g, at, ink, view }, walls) {
  const cell = [0.1, 0.2, 0.5, 1, 2, 5].find((size) => size * view.scale >= 26) || 10;
  const halfWidth = view.width / 2 / view.scale, halfHeight = view.height / 2 / view.scale;
  g.strokeStyle = ink("grid");
  g.lineWidth = 1;
  g.beginPath();
  for (let x = Math.ceil((view.x - halfWidth) / cell) * cell; x <= view.x + halfWidth; x += cell) {
    g.moveTo(at([x, 0])[0], 0);
    g.lineTo(at([x, 0])[0], view.height);
  }
  for (let y = Math.ceil((view.y - halfHeight) / cell) * cell; y <= view.y + halfHeight; y += cell) {
    g.moveTo(0, at([0, y])[1]);
    g.lineTo(view.width, at([0, y])[1]);
  }
  g.stroke();
  if (!walls) return;
  const [left, top] = at([-walls[0] / 2, walls[1] / 2]);
  g.strokeStyle = ink("wall");
  g.lineWidth = 4;
  g.strokeRect(left - 2, top - 2, walls[0] * view.scale + 4, walls[1] * view.scale + 4);
}

function drawObstacles({ g, at, ink }, outlines) {
  g.fillStyle = ink("wall");
  for (const outline of outlines) {
    g.beginPath();
    outline.forEach((point, i) => (i ? g.lineTo(...at(point)) : g.moveTo(...at(point))));
    g.closePath();
    g.fill();
  }
}

/* What the camera sees now, where the prey may have been at the decision, what was sighted in the step before it. */
function drawBelief(pen, belief, hunter, [half, reach]) {
  const { g, at, ink, view } = pen, [x, y] = at(hunter);
  g.fillStyle = ink("hunter");
  g.globalAlpha = 0.09;
  g.beginPath();
  if (half < Math.PI) g.moveTo(x, y);
  g.arc(x, y, reach * view.scale, -hunter[2] - half, -hunter[2] + half);
  g.closePath();
  g.fill();
  if (!belief) return void (g.globalAlpha = 1);
  g.fillStyle = g.strokeStyle = ink("prey");
  g.globalAlpha = 0.4;
  for (const point of belief.cloud) dot(pen, point, 1.8);
  g.globalAlpha = 0.9;
  g.lineWidth = 1.5;
  for (const point of belief.sighted) {
    const [sx, sy] = at(point);
    g.strokeRect(sx - 4, sy - 4, 8, 8);
  }
  g.globalAlpha = 1;
}

/* Where the prey is expected 1, 2, ... steps ahead; the one the plan aims at is filled. */
function drawPredicted(pen, step, radius) {
  const { g, ink, at, view } = pen, points = step.predicted;
  g.strokeStyle = g.fillStyle = ink("prey");
  g.font = "600 11px system-ui, sans-serif";
  g.textAlign = "left";
  if (points.length > 1) {
    g.setLineDash([2, 5]);
    g.lineWidth = 1.5;
    line(pen, points);
    g.setLineDash([]);
    const size = Math.max(4, radius * view.scale);
    points.slice(1).forEach((point, i) => {
      g.globalAlpha = Math.max(0.35, 1 - 0.07 * i);
      g.lineWidth = i + 1 === step.aimed ? 2.5 : 1.5;
      dot(pen, point, size, true);
      const [x, y] = at(point);
      g.fillText(String(i + 1), x + size + 3, y - size + 3);
    });
    g.globalAlpha = 1;
  }
  if (step.aim) cross(pen, step.aim, 6);
}

function cross({ g, at }, point, size) {
  const [x, y] = at(point);
  g.lineWidth = 2.5;
  g.beginPath();
  g.moveTo(x - size, y - size);
  g.lineTo(x + size, y + size);
  g.moveTo(x - size, y + size);
  g.lineTo(x + size, y - size);
  g.stroke();
}

/* The mean path that the forward model expects of the planned gaits. */
function drawPlan(pen, step) {
  const { g, ink } = pen, poses = step.planned;
  if (poses.length < 2) return;
  g.strokeStyle = g.fillStyle = ink("hunter");
  g.lineWidth = 2;
  g.setLineDash([7, 5]);
  line(pen, [poses[0], ...poses.slice(1).flatMap((pose, i) => arcPoints(poses[i], pose))]);
  g.setLineDash([]);
  for (const pose of poses.slice(1)) dot(pen, pose, 3.5);
}

/* Where a node ends in the world: [x, y, theta], null where nobody knows; start: the hunter's pose when it decided. */
function endOf({ end }, node, [x, y, theta]) {
  if (!end || end[3 * node] === null) return null;
  const [ahead, right, turned] = end.slice(3 * node, 3 * node + 3).map((value) => value / 1e4);
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  return [x + ahead * cos + right * sin, y + ahead * sin - right * cos, theta - turned];
}

/* The ends of all alternatives. */
function drawConsidered(pen, { considered: nodes }, start) {
  if (!nodes || !nodes.end) return;
  const { g, ink } = pen;
  g.fillStyle = ink("bar");
  g.globalAlpha = 0.45;
  nodes.gait.forEach((_, node) => {
    const end = endOf(nodes, node, start);
    if (end) dot(pen, end, 1.6);
  });
  g.globalAlpha = 1;
}

/* One alternative: from node to node, its end, and where the prey is expected by then. */
function drawPath(pen, step, start, path, ahead) {
  const { g, ink } = pen, nodes = step.considered;
  const poses = [start, ...path.map((node) => endOf(nodes, node, start)).filter(Boolean)];
  if (poses.length < 2) return;
  g.strokeStyle = g.fillStyle = ink("chosen");
  g.lineWidth = 3;
  line(pen, [poses[0], ...poses.slice(1).flatMap((pose, i) => arcPoints(poses[i], pose))]);
  for (const pose of poses.slice(1)) dot(pen, pose, 4);
  const prey = step.predicted[ahead];
  if (!prey) return;
  g.lineWidth = 1.5;
  g.setLineDash([2, 4]);
  line(pen, [poses[poses.length - 1], prey]);
  g.setLineDash([]);
}

/* A disc with two wheels, or with legs, and a nose that points where it faces. */
function drawRobot({ g, at, ink, view }, pose, radius, colour, legs = []) {
  const whole = Math.max(6, radius * view.scale), scale = whole / radius;
  const r = legs.length ? 0.6 * whole : whole;
  g.save();
  g.translate(...at(pose));
  g.rotate(-pose[2]);
  g.lineWidth = Math.max(1.5, 0.12 * whole);
  g.strokeStyle = colour;
  for (const [x, y, footX, footY] of legs) {
    g.beginPath();
    g.moveTo(0.6 * x * scale, -0.6 * y * scale);
    g.lineTo(footX * scale, -footY * scale);
    g.stroke();
  }
  g.beginPath();
  g.arc(0, 0, r, 0, 2 * Math.PI);
  g.fillStyle = colour;
  g.fill();
  g.lineWidth = 1;
  g.strokeStyle = ink("paper");
  g.stroke();
  g.fillStyle = ink("ink");
  for (const side of legs.length ? [] : [-1, 1]) g.fillRect(-0.32 * r, side * 0.76 * r - 0.13 * r, 0.64 * r, 0.26 * r);
  g.beginPath();
  g.moveTo(0.85 * r, 0);
  g.lineTo(-0.35 * r, 0.5 * r);
  g.lineTo(-0.1 * r, 0);
  g.lineTo(-0.35 * r, -0.5 * r);
  g.closePath();
  g.fillStyle = ink("paper");
  g.fill();
  g.restore();
}

function drawCatch({ g, at, ink, view }, hunter, prey, outcome) {
  const [x, y] = at([(hunter[0] + prey[0]) / 2, (hunter[1] + prey[1]) / 2]);
  g.strokeStyle = g.fillStyle = ink("good");
  g.lineWidth = 3;
  g.beginPath();
  g.arc(x, y, 28, 0, 2 * Math.PI);
  g.stroke();
  g.font = "600 14px system-ui, sans-serif";
  g.textAlign = "center";
  const half = g.measureText(outcome).width / 2 + 6;
  const below = y + 52 < view.height - 34 ? y + 47 : y - 37;
  const middle = Math.min(Math.max(x, half), view.width - half);
  g.strokeStyle = ink("paper");
  g.lineWidth = 5;
  g.strokeText(outcome, middle, below);
  g.fillText(outcome, middle, below);
}

function drawScale({ g, ink, view }, above) {
  const reach = [0.05, 0.1, 0.2, 0.5, 1, 2, 5].find((size) => size * view.scale >= 56) || 10;
  const pixels = reach * view.scale, y = view.height - above;
  g.strokeStyle = g.fillStyle = ink("faint");
  g.lineWidth = 2;
  g.beginPath();
  g.moveTo(14, y - 4);
  g.lineTo(14, y);
  g.lineTo(14 + pixels, y);
  g.lineTo(14 + pixels, y - 4);
  g.stroke();
  g.font = "12px system-ui, sans-serif";
  g.textAlign = "left";
  g.strokeStyle = ink("paper");
  g.lineWidth = 5;
  const label = length(reach);
  g.strokeText(label, 14, y - 9);
  g.fillText(label, 14, y - 9);
}
