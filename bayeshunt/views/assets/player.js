"use strict";
/* Plays one recorded hunt: a canvas with both robots, and beside it, in step, what the hunter knew.
   Lengths in metres, angles in radians: world poses [x, y, theta] counter-clockwise, what the hunter
   sees [distance, angle, heading] clockwise. All text is set as text, never as markup. */

const SPEEDS = [0.5, 1, 2, 4, 8, 16];

const polar = (pose) => `${length(pose[0])} at ${degrees(pose[1])}`;

function element(name, text, className) {
  const node = document.createElement(name);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  return node;
}

function fillFacts(list, pairs) {
  list.replaceChildren(...pairs.flatMap(([term, value, key]) => {
    const detail = element("dd", value);
    detail.dataset.fact = key;
    return [element("dt", term), detail];
  }));
}

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

class Player {
  /* root: the markup of player.html.j2; keys: where keyboard shortcuts are heard. */
  constructor(root, keys) {
    this.parts = Object.fromEntries([...root.querySelectorAll("[data-part]")].map((node) => [node.dataset.part, node]));
    this.root = root;
    this.hunt = null;
    this.playing = false;
    this.listen(keys);
  }

  listen(keys) {
    const { play, previous, next, scrub, speed, canvas, follow } = this.parts;
    play.addEventListener("click", () => this.toggle());
    previous.addEventListener("click", () => this.step(-1));
    next.addEventListener("click", () => this.step(1));
    scrub.addEventListener("input", () => this.seek(this.hunt.trail.time[Number(scrub.value)], true));
    speed.addEventListener("change", () => this.say(`speed ${speed.value} times`));
    for (const part of [follow, this.parts["show-plan"], this.parts["show-predicted"]])
      part.addEventListener("change", () => this.draw());
    keys.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  /* Show a hunt from its start. */
  load(hunt) {
    this.pause();
    this.hunt = hunt;
    this.shown = -1;
    const frames = hunt.trail.time;
    this.duration = frames[frames.length - 1];
    this.parts.scrub.max = frames.length - 1;
    this.ticks = hunt.steps.map((step) => {
      const tick = element("i");
      tick.style.left = `${(100 * this.frameAt(step.time)) / Math.max(1, frames.length - 1)}%`;
      return tick;
    });
    this.parts.ticks.replaceChildren(...this.ticks);
    this.bounds = this.findBounds();
    this.seek(0);
  }

  // --- time ---------------------------------------------------------------------------------

  frameAt(time) {
    const times = this.hunt.trail.time;
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  stepAt(time) {
    const steps = this.hunt.steps;
    let now = 0;
    while (now + 1 < steps.length && steps[now + 1].time <= time + 1e-9) now += 1;
    return now;
  }

  seek(time, spoken) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.show(spoken);
  }

  /* To the previous or next decision; after the last one, to the end. */
  step(change) {
    this.pause();
    const steps = this.hunt.steps, now = this.stepAt(this.time);
    if (change > 0) this.seek(now + 1 < steps.length ? steps[now + 1].time : this.duration, true);
    else this.seek(this.time > steps[now].time + 1e-6 ? steps[now].time : steps[Math.max(0, now - 1)].time, true);
  }

  frame(change) {
    this.pause();
    const times = this.hunt.trail.time;
    const frame = Math.min(Math.max(this.frameAt(this.time) + change, 0), times.length - 1);
    this.seek(times[frame], true);
  }

  toggle() {
    if (this.playing) return this.pause(true);
    if (this.time >= this.duration - 1e-9) this.seek(0);
    this.playing = true;
    this.parts.play.textContent = "Pause";
    this.root.dataset.playing = "true";
    this.say("playing");
    let before = performance.now();
    const advance = (now) => {
      if (!this.playing) return;
      this.seek(this.time + (Math.max(0, now - before) / 1000) * Number(this.parts.speed.value));
      before = now;
      if (this.time >= this.duration) return this.pause(true);
      this.request = requestAnimationFrame(advance);
    };
    this.request = requestAnimationFrame(advance);
  }

  pause(spoken) {
    this.playing = false;
    cancelAnimationFrame(this.request);
    this.parts.play.textContent = "Play";
    delete this.root.dataset.playing;
    if (spoken) this.say(this.summary());
  }

  changeSpeed(change) {
    const { speed } = this.parts;
    const place = SPEEDS.indexOf(Number(speed.value)) + change;
    speed.value = String(SPEEDS[Math.min(Math.max(place, 0), SPEEDS.length - 1)]);
    this.say(`speed ${speed.value} times`);
  }

  key(event) {
    if (!this.hunt || event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target, name = target.tagName;
    if (name === "SELECT" || name === "TEXTAREA") return;
    const ownSpace = name === "BUTTON" || name === "SUMMARY" || target.type === "checkbox";
    if (event.key === " " && ownSpace) return;
    const ownArrows = target.type === "range" || target === this.parts["prey-box"];
    if (ownArrows && /^(Arrow|Home|End|Page)/.test(event.key)) return;
    const acts = {
      " ": () => this.toggle(),
      ArrowRight: () => this.step(1),
      ArrowLeft: () => this.step(-1),
      ".": () => this.frame(1),
      ",": () => this.frame(-1),
      Home: () => { this.pause(); this.seek(0, true); },
      End: () => { this.pause(); this.seek(this.duration, true); },
      "+": () => this.changeSpeed(1),
      "=": () => this.changeSpeed(1),
      "-": () => this.changeSpeed(-1),
      p: () => this.parts["show-plan"].click(),
      o: () => this.parts["show-predicted"].click(),
      f: () => this.parts.follow.click(),
    };
    if (!(event.key in acts)) return;
    event.preventDefault();
    acts[event.key]();
  }

  // --- panels -------------------------------------------------------------------------------

  show(spoken) {
    const frame = this.frameAt(this.time), now = this.stepAt(this.time), total = this.hunt.steps.length;
    const { scrub, clock, canvas } = this.parts;
    scrub.value = frame;
    clock.textContent = `${this.time.toFixed(2)} s of ${this.duration.toFixed(2)} s · decision ${now + 1} of ${total}`;
    scrub.setAttribute("aria-valuetext", `${this.time.toFixed(1)} seconds, decision ${now + 1} of ${total}`);
    if (now !== this.shown) {
      this.shown = now;
      this.ticks.forEach((tick, i) => tick.classList.toggle("now", i === now));
      this.showStep(this.hunt.steps[now], now);
      canvas.setAttribute("aria-label", `The hunt seen from above. ${this.summary()}`);
    }
    if (spoken) this.say(this.summary());
    this.draw();
  }

  summary() {
    const step = this.hunt.steps[this.stepAt(this.time)];
    const ended = this.time >= this.duration - 1e-9 ? ` ${this.hunt.outcome}.` : "";
    return `Decision ${step.number + 1} at ${step.time.toFixed(1)} s: prey ${polar(step.seen)}; gait ${step.gait}.${ended}`;
  }

  say(text) {
    this.parts.status.textContent = text;
  }

  showStep(step, now) {
    const parts = this.parts;
    this.root.dataset.step = now;
    parts.heading.textContent = `Decision ${now + 1}: ${step.gait}`;
    fillFacts(parts.facts, [
      ["time", `${step.time.toFixed(3)} s`, "time"],
      ["prey seen", `${polar(step.seen)}, heading ${degrees(step.seen[2])}`, "seen"],
      ["aims at", step.target ? polar(step.target) : "no single point", "target"],
      ["prey model", step.known ? "used" : step.observations ? "not asked" : "empty: nothing seen yet", "known"],
      ...(step.energy === null ? [] : [["spent so far", `${step.energy.toFixed(1)} J`, "energy"], ["falls so far", String(step.falls), "falls"]]),
    ]);
    this.showBars(step);
    this.showPlan(step);
    this.showPrey(step);
  }

  showBars(step) {
    const { bars } = this.parts, table = step.bars;
    this.parts["bars-title"].textContent = table.title;
    this.parts["bars-caption"].textContent = table.caption;
    const most = table.kind === "posterior" ? 1 : Math.max(...table.values, 1e-12);
    bars.replaceChildren(...table.gaits.map((gait, i) => {
      const row = element("tr"), head = element("th", gait), cell = element("td", undefined, "bar"), bar = element("div");
      head.scope = "row";
      head.title = gait;
      bar.style.width = `${(100 * table.values[i]) / most}%`;
      cell.append(bar);
      cell.setAttribute("aria-hidden", "true");
      row.append(head, cell, element("td", table.kind === "posterior" ? table.values[i].toFixed(3) : String(Number(table.values[i].toPrecision(4)))));
      if (gait === step.gait) {
        row.className = "chosen";
        row.setAttribute("aria-current", "true");
      }
      return row;
    }));
  }

  showPlan(step) {
    this.parts.sequence.replaceChildren(...step.plan.map(([gait, times], i) => {
      const item = element("li", times > 1 ? `${gait} × ${times}` : gait);
      if (!i) item.className = "now";
      return item;
    }));
    fillFacts(this.parts["plan-facts"], [
      ["value", step.value === null ? "not finite" : String(Number(step.value.toPrecision(4))), "value"],
      ["which is", step.objective, "objective"],
      ["considered", `${step.nodes} ${step.nodes === 1 ? "alternative" : "alternatives"}`, "nodes"],
    ]);
  }

  showPrey(step) {
    const { prey } = this.parts;
    this.parts["prey-summary"].textContent = step.observations
      ? `${step.observations} pose ${step.observations === 1 ? "transition" : "transitions"} seen` +
        (step.expected ? `; on average ${polar(step.expected)}, turning ${degrees(step.expected[2])} a step` : "")
      : "No pose transition seen yet.";
    const total = step.prey.reduce((sum, row) => sum + row[3], 0);
    prey.replaceChildren(...step.prey.map((row, i) => {
      const line = element("tr");
      const share = `${((100 * row[3]) / total).toFixed(1)} %`;
      const [far, wide, turned] = this.hunt.bins; // a cell is all of its bin, not the middle
      const cells = [range(row[0], far, lengths), range(row[1], wide, angles), range(row[2], turned, angles), String(row[3]), share];
      line.append(...cells.map((text) => element("td", text)));
      if (i === step.fresh) {
        line.className = "new";
        line.title = "seen in the step just before";
      }
      return line;
    }));
    this.parts["prey-box"].hidden = !step.prey.length;
  }

  // --- canvas -------------------------------------------------------------------------------

  findBounds() {
    const { walls, trail, radius } = this.hunt;
    if (walls) return { x0: -walls[0] / 2, x1: walls[0] / 2, y0: -walls[1] / 2, y1: walls[1] / 2, pad: 0.04 };
    const poses = [...trail.hunter, ...trail.prey, ...(this.hunt.obstacles || []).flat()];
    const xs = poses.map((pose) => pose[0]), ys = poses.map((pose) => pose[1]);
    const range = { x0: Math.min(...xs), x1: Math.max(...xs), y0: Math.min(...ys), y1: Math.max(...ys) };
    return { ...range, pad: 3 * Math.max(...radius) };
  }

  /* Pixels per metre and the world point in the middle. */
  camera(width, height, hunter, prey) {
    let { x0, x1, y0, y1, pad } = this.bounds;
    if (this.parts.follow.checked) {
      const reach = Math.max(0.25, 0.75 * Math.hypot(prey[0] - hunter[0], prey[1] - hunter[1]));
      const x = (hunter[0] + prey[0]) / 2, y = (hunter[1] + prey[1]) / 2;
      [x0, x1, y0, y1, pad] = [x - reach, x + reach, y - reach, y + reach, 0];
    }
    const scale = Math.min(width / (x1 - x0 + 2 * pad), height / (y1 - y0 + 2 * pad));
    return { scale, x: (x0 + x1) / 2, y: (y0 + y1) / 2, width, height };
  }

  draw() {
    const { canvas } = this.parts, box = canvas.getBoundingClientRect();
    if (!this.hunt || !box.width) return;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.round(box.width * ratio), height = Math.round(box.height * ratio);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const style = getComputedStyle(this.root);
    const ink = (name) => style.getPropertyValue(`--bh-${name}`).trim();
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, box.width, box.height);
    g.lineJoin = g.lineCap = "round";
    const [hunter, prey] = [this.poseAt("hunter"), this.poseAt("prey")];
    const view = this.camera(box.width, box.height, hunter, prey);
    const at = ([x, y]) => [view.width / 2 + (x - view.x) * view.scale, view.height / 2 - (y - view.y) * view.scale];
    const pen = { g, at, ink, view };
    drawGround(pen, this.hunt.walls);
    drawObstacles(pen, this.hunt.obstacles || []);
    this.drawTrails(pen, hunter, prey);
    const step = this.hunt.steps[this.shown];
    if (this.parts["show-predicted"].checked) drawPredicted(pen, step, this.hunt.radius[1]);
    if (this.parts["show-plan"].checked) drawPlan(pen, step);
    drawRobot(pen, prey, this.hunt.radius[1], ink("prey"));
    drawRobot(pen, hunter, this.hunt.radius[0], ink("hunter"), this.hunt.legs);
    if (this.hunt.caught && this.time >= this.duration - 1e-9) drawCatch(pen, hunter, prey, this.hunt.outcome);
    drawScale(pen, this.hunt.walls ? 26 : 14);
  }

  poseAt(who) {
    const { time } = this.hunt.trail, poses = this.hunt.trail[who], i = this.frameAt(this.time);
    if (i + 1 >= poses.length) return poses[i];
    const share = (this.time - time[i]) / (time[i + 1] - time[i]), [a, b] = [poses[i], poses[i + 1]];
    return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * wrap(b[2] - a[2])];
  }

  drawTrails(pen, hunter, prey) {
    const { g } = pen, { trail, steps } = this.hunt, end = this.frameAt(this.time) + 1;
    for (const [who, now] of [["prey", prey], ["hunter", hunter]]) {
      g.strokeStyle = g.fillStyle = pen.ink(who);
      g.globalAlpha = 0.18;
      g.lineWidth = 1.5;
      line(pen, trail[who]);
      g.globalAlpha = 0.85;
      g.lineWidth = 2.25;
      line(pen, [...trail[who].slice(0, end), now]);
      g.globalAlpha = 1;
      for (const step of steps.slice(0, this.shown + 1)) dot(pen, trail[who][this.frameAt(step.time)], 2.6);
    }
  }
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
