/* The explorer in the browser: draws the scene and the answer, and tells Python where the target is.
   After dom.js, units.js and trace.js. Screen: the robot faces up, metres to the right and ahead; angles are clockwise
   from ahead. */

const SIZE = 400;

/* Pixels and metres: the robot is in the middle of the picture. */
class Plane {
  constructor(scene) {
    this.scene = scene;
    this.extent = 1.12 * scene.reach;
    this.scale = SIZE / 2 / this.extent;
  }

  at(forward, right) {
    return [SIZE / 2 + right * this.scale, SIZE / 2 - forward * this.scale];
  }

  polar(distance, angle) {
    return this.at(distance * Math.cos(angle), distance * Math.sin(angle));
  }

  /* Outline of a (distance, angle) cell: a piece of a ring. */
  sector(distanceBin, angleBin) {
    const { distance_width: width, angle_bins: bins } = this.scene, turn = (2 * Math.PI) / bins;
    const from = (angleBin - Math.floor(bins / 2) - 0.5) * turn;
    const near = distanceBin * width, far = near + width;
    const [a, b, c, d] = [[near, from], [far, from], [far, from + turn], [near, from + turn]].map((p) => this.polar(...p));
    const [n, f] = [near * this.scale, far * this.scale];
    const large = turn > Math.PI ? 1 : 0;
    return `M${a}L${b}A${f} ${f} 0 ${large} 1 ${c}L${d}A${n} ${n} 0 ${large} 0 ${a}Z`;
  }

  centre(distanceBin, angleBin) {
    const { distance_width: width, angle_bins: bins } = this.scene;
    return this.polar((distanceBin + 0.5) * width, ((angleBin - Math.floor(bins / 2)) * 2 * Math.PI) / bins);
  }
}

function drawGround(svg, plane) {
  const { scene } = plane;
  const step = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10].find((size) => scene.reach / size <= 5) || scene.reach;
  for (let radius = step; radius <= plane.extent; radius += step) {
    shape("circle", { class: "ring", cx: SIZE / 2, cy: SIZE / 2, r: radius * plane.scale }, svg);
    const label = shape("text", { class: "scale", x: SIZE / 2 + 3, y: SIZE / 2 + radius * plane.scale - 3 }, svg);
    label.textContent = length(radius);
  }
  const learned = shape("g", { class: "learned" }, svg);
  const most = scene.cells.reduce((largest, cell) => Math.max(largest, cell[2]), 1);
  for (const [distance, angle, support] of scene.cells) {
    const [x, y] = plane.centre(distance, angle);
    // where nobody knows how many rows there were, all dots are alike
    shape("circle", { cx: x, cy: y, r: support === null ? 1.2 : 0.8 + 1.6 * Math.sqrt(support / most) }, learned);
  }
}

function drawRobot(svg, plane) {
  const [x, y] = plane.at(0, 0), r = Math.max(5, plane.scene.radius * plane.scale);
  shape("circle", { class: "body", cx: x, cy: y, r }, svg);
  shape("path", { class: "nose", d: `M${x} ${y - 0.8 * r}l${0.5 * r} ${1.2 * r}l${-0.5 * r} ${-0.3 * r}l${-0.5 * r} ${0.3 * r}z` }, svg);
}

/* The name of every gait beside its end, as far as they do not lie upon each other. */
function nameEnds(svg, plane) {
  const taken = [];
  return plane.scene.paths.map((points, i) => {
    const text = shape("text", { class: "gait-name" }, svg);
    if (!points.length) return text;
    const [x, y] = plane.at(...points[points.length - 1]), left = x < SIZE / 2 - 4, name = plane.scene.gaits[i];
    const width = 5.6 * name.length, from = left ? x - 6 - width : x + 6;
    let at = y + 4;
    for (const shift of [0, 11, -11, 22, -22, 33, -33, 44, -44]) {
      at = y + 4 + shift;
      if (!taken.some(([u, v, w]) => Math.abs(v - at) < 10 && from < u + w && u < from + width)) break;
    }
    taken.push([from, at, width]);
    for (const [key, value] of Object.entries({ x: left ? x - 6 : x + 6, y: at, "text-anchor": left ? "end" : "start" })) text.setAttribute(key, value);
    text.textContent = name;
    return text;
  });
}

/* The moving parts of the picture; `update` shows an answer, `point` moves the target alone. */
function drawField(svg, plane) {
  drawGround(svg, plane);
  const outcomes = shape("g", {}, svg);
  drawRobot(svg, plane); // below the paths: gaits that turn on the spot end upon it
  const paths = plane.scene.paths.map((points) => {
    const group = shape("g", {}, svg);
    if (!points.length) return group;
    const pixels = points.map(([forward, right]) => plane.at(forward, right));
    shape("polyline", { class: "path", points: pixels.join(" ") }, group);
    const [x, y] = pixels[pixels.length - 1];
    shape("circle", { class: "end", cx: x, cy: y, r: 3 }, group);
    return group;
  });
  const names = nameEnds(svg, plane);
  const snap = shape("line", { class: "snap" }, svg), cell = shape("path", { class: "cell" }, svg);
  const grip = shape("circle", { class: "target-grip", r: 13 }, svg), cross = shape("path", { class: "target" }, svg);
  let tip = [0, 0];
  const join = (answer) => {
    const [x, y] = plane.centre(...answer.cell);
    for (const [key, value] of Object.entries({ x1: tip[0], y1: tip[1], x2: x, y2: y })) snap.setAttribute(key, value);
    snap.style.display = answer.snapped ? "" : "none";
  };
  return {
    point(distance, angle, answer) {
      tip = plane.polar(distance, angle);
      grip.setAttribute("cx", tip[0]);
      grip.setAttribute("cy", tip[1]);
      cross.setAttribute("d", `M${tip[0] - 5} ${tip[1]}h10M${tip[0]} ${tip[1] - 5}v10`);
      join(answer);
    },
    update(answer) {
      cell.setAttribute("d", plane.sector(...answer.cell));
      join(answer);
      const most = answer.outcomes.length ? answer.outcomes[0][2] : 1;
      outcomes.replaceChildren(...answer.outcomes.map(([distance, angle, probability]) =>
        shape("path", { class: "outcome", d: plane.sector(distance, angle), "fill-opacity": (0.1 + (0.6 * probability) / most).toFixed(3) })));
      paths.forEach((group, i) => {
        group.setAttribute("opacity", (0.35 + 0.65 * answer.probabilities[i]).toFixed(3));
        names[i].classList.toggle("best", plane.scene.gaits[i] === answer.best);
        if (group.firstChild) group.firstChild.classList.toggle("best", plane.scene.gaits[i] === answer.best);
      });
    },
  };
}

function buildSide(side, scene, open) {
  element("p", { class: "title" }, side, "P(Gait | Distance, Angle)");
  const table = element("table", { class: "gaits" }, side);
  const rows = scene.gaits.map((gait) => {
    const row = element("tr", {}, table), head = element("th", {}, row);
    const button = element("button", { class: "plain" }, head, gait);
    button.type = "button";
    button.title = `${gait}: where this number comes from`;
    button.addEventListener("click", () => open(gait));
    head.scope = "row";
    const track = element("td", { class: "bar" }, row);
    const bar = element("div", {}, track), whisker = element("span", { class: "whisker" }, track);
    return { row, bar, whisker, value: element("td", { class: "value" }, row), within: element("td", { class: "within" }, row) };
  });
  const list = element("dl", {}, side);
  // an imported network has learned nothing: its cells are those of positive probability
  const cell = scene.counted ? "learned cell" : "cell used";
  const facts = Object.fromEntries(["target", "learned cell", "P(evidence)", "support", ...(scene.counted ? ["how sure"] : [])].map((name) => {
    element("dt", {}, list, name === "learned cell" ? cell : name);
    const value = element("dd", {}, list);
    value.dataset.fact = name;
    return [name, value];
  }));
  const legend = element("ul", { class: "legend" }, side);
  const marks = {
    "target": '<circle class="target-grip" cx="10" cy="6" r="5"/>',
    [scene.counted ? "learned cell used" : cell]: '<rect class="cell" x="5" y="1.5" width="10" height="9"/>',
    [scene.counted ? "learned coordinates" : "coordinates of positive probability"]: '<circle class="learned" cx="10" cy="6" r="2"/>',
    "mean paths, the chosen gait's strong": '<path class="path best" d="M1 9Q10 2 19 5"/>',
    "predicted outcome": '<rect class="outcome" x="4" y="1" width="12" height="10" fill-opacity="0.45"/>',
  };
  for (const [name, mark] of Object.entries(marks)) {
    const item = element("li", {}, legend);
    item.innerHTML = `<svg viewBox="0 0 20 12" aria-hidden="true">${mark}</svg>`; // constants of this file alone
    item.append(name);
  }
  element("p", { class: "help" }, side, "Drag the target, or focus the picture and use the arrow keys (with shift: larger steps).");
  return (answer, distance, angle) => {
    rows.forEach(({ row, bar, whisker, value, within }, i) => {
      const probability = answer.probabilities[i];
      const [low, high, said] = answer.within?.[i] ?? [0, 0, ""];
      bar.style.width = `${100 * probability}%`;
      whisker.hidden = !said;
      whisker.style.left = `${100 * low}%`;
      whisker.style.width = `${100 * (high - low)}%`;
      value.textContent = probability.toFixed(3);
      within.textContent = said && `(${said})`;
      row.classList.toggle("best", scene.gaits[i] === answer.best);
    });
    facts.target.textContent = `${length(distance)} at ${degrees(wrap(angle))}`;
    facts["learned cell"].textContent = `${answer.labels[0]}, ${answer.labels[1]}${answer.snapped ? " (nearest)" : ""}`;
    facts["P(evidence)"].textContent = answer.evidence_probability.toPrecision(4);
    facts.support.textContent = answer.rows;
    if (answer.sure) facts["how sure"].textContent = answer.sure;
  };
}

function render({ model, el }) {
  const scene = model.get("_scene"), plane = new Plane(scene);
  const root = element("div", { class: "bh-explorer" }, el);
  const svg = shape("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, tabindex: 0, role: "application" }, root);
  const side = element("div", { class: "side" }, root);
  const status = element("p", { class: "spoken" }, root); // one line: to hear the whole panel at each step is too much
  status.setAttribute("role", "status");
  const field = drawField(svg, plane), trace = new TracePanel(root);
  const tell = buildSide(side, scene, (gait) => {
    const { opened, within } = model.get("_answer");
    trace.open(opened, gait, within && within.map(([, , said]) => said));
  });
  let waiting = 0, dragging = false;

  const show = () => {
    const answer = model.get("_answer"), distance = model.get("distance"), angle = model.get("angle");
    field.point(distance, angle, answer);
    field.update(answer);
    tell(answer, distance, angle);
    const spoken = `Most probable gait ${answer.best}; support ${answer.rows}.`;
    if (status.textContent !== spoken) status.textContent = spoken;
    svg.setAttribute("aria-label", `Target ${length(distance)} at ${degrees(wrap(angle))}; ` +
      `most probable gait ${answer.best}. Arrow keys move the target.`);
  };
  const move = (forward, right) => {
    const distance = Math.min(Math.hypot(forward, right), 2 * plane.extent);
    model.set("distance", distance);
    model.set("angle", distance > 0 ? Math.atan2(right, forward) : 0);
    field.point(distance, model.get("angle"), model.get("_answer"));
    waiting ||= requestAnimationFrame(() => { // one message a frame, however fast the hand
      waiting = 0;
      model.save_changes();
    });
  };
  const follow = (event) => {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const limit = (value) => Math.min(Math.max(value, 6), SIZE - 6);
    move((SIZE / 2 - limit(point.y)) / plane.scale, (limit(point.x) - SIZE / 2) / plane.scale);
  };
  svg.addEventListener("pointerdown", (event) => {
    dragging = true;
    svg.setPointerCapture(event.pointerId);
    follow(event);
  });
  svg.addEventListener("pointermove", (event) => dragging && follow(event));
  for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, () => { dragging = false; });
  svg.addEventListener("keydown", (event) => {
    const step = scene.distance_width * (event.shiftKey ? 4 : 1);
    const moves = { ArrowUp: [step, 0], ArrowDown: [-step, 0], ArrowLeft: [0, -step], ArrowRight: [0, step] };
    if (!(event.key in moves)) return;
    event.preventDefault();
    event.stopPropagation(); // the notebook would move to another cell
    const distance = model.get("distance"), angle = model.get("angle"), [ahead, across] = moves[event.key];
    move(distance * Math.cos(angle) + ahead, distance * Math.sin(angle) + across);
  });
  for (const name of ["change:_answer", "change:distance", "change:angle"]) model.on(name, show);
  show();
  return () => {
    cancelAnimationFrame(waiting);
    for (const name of ["change:_answer", "change:distance", "change:angle"]) model.off(name, show);
  };
}

export default { render };
