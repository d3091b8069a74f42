"use strict";
/* Plays one recorded hunt: a canvas with both robots, and beside it, in step, what the hunter knew.
   Lengths in metres, angles in radians: world poses [x, y, theta] counter-clockwise, what the hunter
   sees [distance, angle, heading] clockwise. All text is set as text, never as markup. */

const SPEEDS = [0.5, 1, 2, 4, 8, 16];

const polar = (pose) => `${length(pose[0])} at ${degrees(pose[1])}`;

function sayThere(body, words) {
  body.append(element("p", { class: "formula" }, null, words));
}

function fillFacts(list, pairs) {
  list.replaceChildren(...pairs.flatMap(([term, value, key]) => {
    const detail = element("dd", {}, null, value);
    detail.dataset.fact = key;
    return [element("dt", {}, null, term), detail];
  }));
}

class Player {
  /* root: the markup of player.html.j2; keys: where keyboard shortcuts are heard, null where another player leads;
     followers: players of other hunts that go in step with this one. */
  constructor(root, keys, followers = []) {
    this.parts = Object.fromEntries([...root.querySelectorAll("[data-part]")].map((node) => [node.dataset.part, node]));
    this.root = root;
    this.hunt = null;
    this.playing = false;
    this.followers = followers;
    this.decided = () => {}; // told the number of each decision that is shown
    this.path = [];
    const parts = this.parts;
    this.lanes = new Lanes(parts.lanes, (time) => (this.leader || this).scrubTo(time));
    this.icicle = new Icicle({ box: parts["icicle-box"], picture: parts.icicle, readout: parts["icicle-words"] }, (path, steps) => {
      [this.path, this.ahead] = [path, steps];
      this.draw();
    });
    this.trace = new TracePanel(root);
    for (const follower of followers) follower.leader = this;
    this.listen(keys);
  }

  listen(keys) {
    const { play, previous, next, scrub, speed, canvas, follow } = this.parts;
    play.addEventListener("click", () => this.toggle());
    previous.addEventListener("click", () => this.step(-1));
    next.addEventListener("click", () => this.step(1));
    scrub.addEventListener("input", () => this.seek(this.hunt.trail.time[Number(scrub.value)], true));
    speed.addEventListener("change", () => this.say(`speed ${speed.value} times`));
    for (const part of [follow, this.parts["show-plan"], this.parts["show-predicted"], this.parts["show-considered"], this.parts["show-belief"]])
      part.addEventListener("change", () => [this, ...this.followers].forEach((player) => player.draw()));
    if (keys) keys.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  /* Show a hunt from its start. */
  load(hunt) {
    this.pause();
    this.hunt = hunt;
    this.shown = -1;
    for (const part of ["belief-layer", "belief-card"]) if (this.parts[part]) this.parts[part].hidden = !hunt.fov;
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
    this.lanes.load(hunt, (this.leader || this).duration);
    this.seek(0);
  }

  /* To the beginning of a decision, counted from 1; where there is none of that number, stay. */
  toDecision(number) {
    const step = this.hunt.steps[number - 1];
    if (step) this.seek(step.time, true);
  }

  scrubTo(time) {
    this.pause();
    this.seek(time);
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
      b: () => this.parts["show-belief"].click(),
      f: () => this.parts.follow.click(),
      c: () => this.parts["show-considered"].click(),
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
      this.decided(now + 1);
    }
    for (const follower of this.followers) follower.seek(this.time);
    if (spoken) this.say(this.summary());
    this.draw();
    this.lanes.show(this.time, now);
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
      [step.belief ? "prey believed" : "prey seen", `${polar(step.seen)}, heading ${degrees(step.seen[2])}`, "seen"],
      ["aims at", step.target ? polar(step.target) : "no single point", "target"],
      ["prey model", step.known ? "used" : step.observations ? "not asked" : "empty: nothing seen yet", "known"],
      ...(step.energy === null ? [] : [["spent so far", `${step.energy.toFixed(1)} J`, "energy"], ["falls so far", String(step.falls), "falls"]]),
    ]);
    this.showBars(step);
    this.showPlan(step);
    this.showConsidered(step);
    this.showPrey(step);
    if (step.belief) this.showBelief(step.belief);
  }

  showBelief(belief) {
    const never = belief.lastSeen === null, spread = belief.spread === null ? "any distance" : length(belief.spread);
    this.parts["belief-summary"].textContent =
      `${never ? "Never seen yet" : belief.lastSeen < 1e-6 ? "Seen now" : `Last seen ${belief.lastSeen.toFixed(1)} s ago`}; ` +
      `give or take ${spread}; heading known to ${belief.resultant.toFixed(2)} of 1; ` +
      `P(in view) ${belief.inView.toFixed(2)}.`;
    this.parts.belief.replaceChildren(...belief.table.map(([ring, sector, p, sightings]) => {
      const line = element("tr");
      line.append(...[ring, sector, p.toFixed(3), sightings.toFixed(1)].map((text) => element("td", {}, null, text)));
      return line;
    }));
  }

  showBars(step) {
    const { bars } = this.parts, table = step.bars, posterior = table.kind === "posterior";
    const sure = posterior && table.within ? table.within[table.gaits.indexOf(step.gait)] : null;
    this.parts["bars-title"].textContent = table.title;
    this.parts["bars-caption"].textContent = table.caption + (sure ? `; 95 % interval of ${step.gait}: ${sure[2]}` : "");
    const draw = posterior ? this.bar(table) : this.dot(step);
    bars.replaceChildren(...table.gaits.map((gait, i) => {
      const row = element("tr"), head = element("th"), open = element("button", { class: "plain" }, null, gait);
      head.scope = "row";
      head.append(open);
      open.type = "button";
      open.title = `${gait}: where this number comes from`;
      open.addEventListener("click", () => this.openNumber(step, gait));
      const value = table.values[i];
      const last = element("td", {}, null, posterior ? value.toFixed(3) : String(Number(value.toPrecision(4))));
      if (posterior && table.within) last.dataset.within = `(${table.within[i][2]})`;
      row.append(head, ...draw(gait, i), last);
      if (gait === step.gait) {
        row.className = "chosen";
        row.setAttribute("aria-current", "true");
      }
      return row;
    }));
  }

  /* Where the number beside a gait comes from, in the panel at the side. */
  openNumber(step, gait) {
    this.pause();
    const decision = { title: `Decision ${step.number + 1}`, fill: (body) => {
      sayThere(body, `At ${step.time.toFixed(3)} s the prey is seen ${polar(step.seen)}. ${step.objective}: ${step.value}; decided for ${step.gait}, of ${step.nodes}.`);
    } };
    const within = step.opened && step.bars.within;
    if (step.opened) return this.trace.open(step.opened, gait, within && within.map(([, , said]) => said), [decision]);
    const nodes = step.considered, tree = nodes ? treeOf(nodes) : [], rows = [];
    tree.forEach((item, i) => {
      const path = [];
      for (let at = i; at > 0; at = tree[at].above) path.unshift(tree[at].label);
      if (item.node >= 0 && path.length && path[0].replace(/ x\d+$/, "") === gait && nodes.value[item.node] !== null)
        rows.push([path.join(" → "), nodes.value[item.node]]);
    });
    const best = step.bars.values[step.bars.gaits.indexOf(gait)];
    rows.sort((a, b) => Math.abs(a[1] - best) - Math.abs(b[1] - best));
    return this.trace.show([decision, { title: gait, fill: (body) => {
      sayThere(body, `${step.objective}: ${best}, the best of ${rows.length} sequences that begin with ${gait}`);
      this.trace.table(body, ["sequence", "value"], rows.slice(0, 40).map(([words, value]) => [words, String(Number(value.toPrecision(4)))]));
    } }]);
  }

  /* Cells of a probability: a bar with the whisker of its interval. */
  bar(table) {
    return (gait, i) => {
      const cell = element("td", { class: "bar" }), bar = element("div");
      bar.style.width = `${100 * table.values[i]}%`;
      cell.append(bar);
      if (table.within) {
        const [low, high, words] = table.within[i], whisker = element("span", { class: "whisker" });
        whisker.style.left = `${100 * low}%`;
        whisker.style.width = `${100 * (high - low)}%`;
        cell.title = `95 % interval ${words}`;
        cell.append(whisker);
      }
      cell.setAttribute("aria-hidden", "true");
      return [cell];
    };
  }

  /* Cells of a value: a dot on an axis that begins at the best, a line to the worst that this gait begins, and how
     much worse than the best it is. */
  dot(step) {
    const { values, gaits } = step.bars, chosen = values[gaits.indexOf(step.gait)];
    const high = Math.max(...values), low = Math.min(...values), best = chosen === high && high > low ? high : low;
    const wide = Math.max(high - low, 1e-12), spread = step.considered ? spreads(step.considered) : new Map();
    const unit = unitOf(step.objective), place = (value) => Math.min(100, (100 * Math.abs(value - best)) / wide);
    return (gait, i) => {
      const cell = element("td", { class: "dots" }), line = element("span", { class: "spread" }), mark = element("i");
      const [from, to] = spread.get(gait) || [values[i], values[i]];
      line.style.left = `${Math.min(place(from), place(to))}%`;
      line.style.width = `${Math.abs(place(to) - place(from))}%`;
      mark.style.left = `${place(values[i])}%`;
      cell.append(line, mark);
      cell.setAttribute("aria-hidden", "true");
      const off = values[i] - best, more = Number(Math.abs(off).toPrecision(3));
      const words = Math.abs(off) < 1e-9 ? "best" : `${off > 0 ? "+" : "−"}${more}${unit ? ` ${unit}` : ""}`;
      const said = element("td", { class: "worse" }, null, words);
      if (words !== "best") element("span", {}, said, " worse");
      return [cell, said];
    };
  }

  showPlan(step) {
    this.parts.sequence.replaceChildren(...step.plan.map(([gait, times], i) => {
      const item = element("li", {}, null, times > 1 ? `${gait} × ${times}` : gait);
      if (!i) item.className = "now";
      return item;
    }));
    fillFacts(this.parts["plan-facts"], [
      ["value", step.value === null ? "not finite" : String(Number(step.value.toPrecision(4))), "value"],
      ["which is", step.objective, "objective"],
      ...(promise(step) ? [["came true", promise(step).split(" / ")[1], "realised"]] : []),
      ["considered", `${step.nodes} ${step.nodes === 1 ? "alternative" : "alternatives"}`, "nodes"],
    ]);
  }

  showConsidered(step) {
    const nodes = step.considered;
    this.icicle.load(nodes, (node, path) => {
      const known = nodes.gait.length, unit = unitOf(step.objective);
      if (node === null) return `${known} alternatives; point at one for its path. The stronger, the better; purple is chosen.`;
      const words = path.slice(1).map((i) => this.icicle.tree[i].label).join(" → ") || "now";
      const value = node >= 0 ? nodes.value[node] : null, best = step.value;
      if (value === null) return `${words}: not weighed itself`;
      const off = best === null || Math.abs(value - best) < 1e-4 * Math.abs(best) ? 0 : value - best, more = Number(Math.abs(off).toPrecision(3));
      const worse = more ? `, ${off > 0 ? "+" : "−"}${more} against the chosen` : "";
      return `${words}: ${Number(value.toPrecision(4))} ${unit}${worse}`;
    });
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
      const cells = [range(row[0], far, lengths), range(row[1], wide, angles), range(row[2], turned, angles), String(Number(row[3].toPrecision(3))), share];
      line.append(...cells.map((text) => element("td", {}, null, text)));
      const open = element("button", { class: "plain", title: "the decisions before which this was seen" }, null, cells[0]);
      open.type = "button";
      open.addEventListener("click", () => this.openTransition(step, row, cells));
      line.firstElementChild.replaceChildren(open);
      if (i === step.fresh) {
        line.className = "new";
        line.title = "seen in the step just before";
      }
      return line;
    }));
    this.parts["prey-box"].hidden = !step.prey.length;
  }

  /* A cell of the prey table, in the panel at the side: its count, and the steps that fell into it. */
  openTransition(step, row, cells) {
    this.pause();
    const same = (other) => other && [0, 1, 2].every((k) => other[k] === row[k]);
    const seen = this.hunt.steps.slice(0, step.number + 1).filter((past) => past.fresh >= 0 && same(past.prey[past.fresh]));
    const total = step.prey.reduce((sum, other) => sum + other[3], 0), table = { title: "Prey table", fill: (body) => {
      sayThere(body, `${step.observations} transitions seen before decision ${step.number + 1}, in ${step.prey.length} cells`);
    } };
    this.trace.show([table, { title: cells.slice(0, 3).join(", "), fill: (body) => {
      sayThere(body, `${Number(row[3].toPrecision(3))} of ${Number(total.toPrecision(3))} = ${cells[4]}`);
      if (seen.length) this.trace.table(body, ["seen before", "at", "then decided"], seen.map((past) => [`decision ${past.number + 1}`, `${past.time.toFixed(1)} s`, past.gait]), (k) => this.toDecision(seen[k].number + 1));
    } }]);
  }

  // --- canvas -------------------------------------------------------------------------------

  findBounds() {
    const { walls, trail, radius } = this.hunt;
    if (walls) return { x0: -walls[0] / 2, x1: walls[0] / 2, y0: -walls[1] / 2, y1: walls[1] / 2, pad: 0.04 };
    const poses = [...trail.hunter, ...trail.prey, ...(this.hunt.obstacles || []).flat()];
    const xs = poses.map((pose) => pose[0]), ys = poses.map((pose) => pose[1]);
    const range = { x0: Math.min(...xs), x1: Math.max(...xs), y0: Math.min(...ys), y1: Math.max(...ys) };
    // predictions are seen too, as far as they do not make all else small
    const more = 0.3 * Math.max(range.x1 - range.x0, range.y1 - range.y0);
    const told = this.hunt.steps.flatMap((step) => [...step.predicted, ...step.planned]);
    const grown = (end, edge, sign, axis) => told.reduce((far, point) => sign * Math.max(sign * far, Math.min(sign * point[axis], sign * edge + more)), end);
    return {
      x0: grown(range.x0, range.x0, -1, 0), x1: grown(range.x1, range.x1, 1, 0),
      y0: grown(range.y0, range.y0, -1, 1), y1: grown(range.y1, range.y1, 1, 1), pad: 3 * Math.max(...radius),
    };
  }

  /* Pixels per metre and the world point in the middle. */
  camera(width, height, hunter, prey) {
    let { x0, x1, y0, y1, pad } = this.bounds;
    if ((this.leader || this).parts.follow.checked) {
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
    const style = getComputedStyle(this.root); // read once a frame
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
    const layer = (name) => (this.leader || this).parts[name].checked; // the leader's switches serve all
    const start = this.hunt.trail.hunter[this.frameAt(step.time)];
    if (layer("show-considered")) drawConsidered(pen, step, start);
    if (this.hunt.fov && layer("show-belief")) drawBelief(pen, step.belief, hunter, this.hunt.fov);
    if (layer("show-predicted")) drawPredicted(pen, step, this.hunt.radius[1]);
    if (layer("show-plan")) drawPlan(pen, step);
    if (this.path.length) drawPath(pen, step, start, this.path, this.ahead);
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
