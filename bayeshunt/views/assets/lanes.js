"use strict";
/* Lanes over the time of a hunt: its gaits, the distance to the prey, what each plan promised against what came, and
   how unsure the prey table is. After icicle.js, before player.js. */

const LANE = 30, GUTTER = 86, MARGIN = 92;

/* Bits of doubt over the cells of a prey table, rows of [..., count]. */
function doubt(rows) {
  const total = rows.reduce((sum, row) => sum + row[3], 0);
  return rows.reduce((bits, row) => bits - (row[3] / total) * Math.log2(row[3] / total), 0);
}

const unitOf = (objective) => (/\[(.+)\]$/.exec(objective) || ["", ""])[1];

/* What a plan promised and what came, in words; "" where nobody can say. */
function promise(step) {
  if (step.realised === null || step.value === null) return "";
  const unit = unitOf(step.objective), far = unit === "mm" && Math.max(step.value, step.realised) >= 999.5;
  const [plan, real] = [step.value, step.realised].map((value) => Number((far ? value / 1000 : value).toPrecision(3)));
  return `${plan} / ${real} ${far ? "m" : unit}`;
}

class Lanes {
  /* picture: an svg; seek hears the time that was clicked. */
  constructor(picture, seek) {
    this.picture = picture;
    const go = (event) => {
      const box = picture.getBoundingClientRect();
      if (this.hunt) seek(((event.clientX - box.left - GUTTER) / (box.width - GUTTER - MARGIN)) * this.span);
    };
    picture.addEventListener("pointerdown", (event) => {
      picture.setPointerCapture(event.pointerId);
      go(event);
    });
    picture.addEventListener("pointermove", (event) => event.buttons && go(event));
    new ResizeObserver(() => this.hunt && this.build()).observe(picture.parentElement);
  }

  /* span: seconds that the lanes are wide: those of the longer of two hunts. */
  load(hunt, span) {
    Object.assign(this, { hunt, span, wide: 0 });
    const { time, hunter, prey } = hunt.trail;
    this.end = time[time.length - 1];
    this.distances = time.map((_, i) => Math.hypot(hunter[i][0] - prey[i][0], hunter[i][1] - prey[i][1]));
    this.doubts = hunt.steps.map((step) => (step.observations ? doubt(step.prey) : null));
    const lanes = ["gaits", "distance", "promises", "uncertain"];
    this.lanes = lanes.filter((name) => name !== "promises" || hunt.steps.some(promise));
    this.build();
  }

  build() {
    const { picture } = this, whole = picture.clientWidth, height = LANE * this.lanes.length;
    if (!whole || whole === this.wide) return;
    this.wide = whole;
    this.width = whole - GUTTER - MARGIN;
    picture.setAttribute("viewBox", `0 0 ${whole} ${height}`);
    picture.style.height = `${height}px`;
    picture.replaceChildren();
    this.words = this.lanes.map((name, k) => {
      shape("rect", { class: "lane", x: GUTTER, y: k * LANE + 3, width: this.width, height: LANE - 6 }, picture);
      const label = this[name](k * LANE + 5, LANE - 10);
      shape("text", { class: "name", x: 0, y: k * LANE + LANE / 2 + 4 }, picture, label);
      return shape("text", { x: GUTTER + this.width + 6, y: k * LANE + LANE / 2 + 4 }, picture);
    });
    this.now = shape("line", { class: "playhead", y1: 0, y2: height }, picture);
    if (this.last) this.show(...this.last);
  }

  /* The moment shown: a line across the lanes, and what each is then. */
  show(now, decision) {
    this.last = [now, decision];
    if (!this.now) return;
    const x = this.x(Math.min(now, this.span)), { steps } = this.hunt, bits = this.doubts[decision];
    this.now.setAttribute("x1", x);
    this.now.setAttribute("x2", x);
    const said = {
      gaits: steps[decision].gait, distance: length(this.distances[this.frameAt(now)]), promises: promise(steps[decision]),
      uncertain: bits === null ? "empty" : `${bits.toFixed(2)} bits`,
    };
    this.lanes.forEach((name, k) => { this.words[k].textContent = said[name]; });
  }

  frameAt(now) {
    const { time } = this.hunt.trail, after = time.findIndex((t) => t > now + 1e-9);
    return after < 0 ? time.length - 1 : Math.max(0, after - 1);
  }

  x(time) { return Number((GUTTER + (this.width * time) / this.span).toFixed(1)); }

  until(i) { return this.x(i + 1 < this.hunt.steps.length ? this.hunt.steps[i + 1].time : this.end); }

  gaits(top, height) {
    const { steps, colours, stripes } = this.hunt;
    steps.forEach((step, i) => {
      const x = this.x(step.time), width = Math.max(this.until(i) - x - 1, 1);
      const rect = shape("rect", { class: "gait", x, y: top, width, height }, this.picture);
      if (colours[step.gait]) rect.style.fill = `var(--bh-${colours[step.gait]})`;
      const many = stripes[step.gait] ?? 0; // so many stripes tell it from another gait of its colour
      for (let k = 1; k <= many; k++) {
        const y = top + (height * k) / (many + 1);
        shape("line", { class: "stripe", x1: x, x2: x + width, y1: y, y2: y }, this.picture);
      }
    });
    return "gait";
  }

  distance(top, height) {
    const { time } = this.hunt.trail, most = Math.max(...this.distances);
    const points = this.distances.map((d, i) => `${this.x(time[i])},${(top + height * (1 - d / most)).toFixed(1)}`);
    shape("polyline", { class: "distance", points: points.join(" ") }, this.picture);
    return "distance";
  }

  /* What a plan promised, a ring, and what then was, a dot. */
  promises(top, height) {
    const known = this.hunt.steps.filter(promise), most = Math.max(...known.flatMap((step) => [step.value, step.realised]), 1e-9);
    const y = (value) => (top + 3 + (height - 6) * (1 - value / most)).toFixed(1);
    for (const step of known) {
      const x = this.x(step.time);
      shape("line", { class: "promised", x1: x, x2: x, y1: y(step.value), y2: y(step.realised) }, this.picture);
      shape("circle", { class: "came", cx: x, cy: y(step.realised), r: 2.5 }, this.picture);
      shape("circle", { class: "promised", cx: x, cy: y(step.value), r: 3 }, this.picture);
    }
    return "○ plan ● real";
  }

  uncertain(top, height) {
    const most = Math.max(...this.doubts.map((bits) => bits ?? 0), 1), points = [];
    this.doubts.forEach((bits, i) => {
      if (bits === null) return;
      const y = (top + height * (1 - bits / most)).toFixed(1);
      points.push(`${this.x(this.hunt.steps[i].time)},${y}`, `${this.until(i)},${y}`);
    });
    shape("polyline", { class: "doubt", points: points.join(" ") }, this.picture);
    return "prey table";
  }
}
