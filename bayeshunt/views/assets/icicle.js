"use strict";
/* Every alternative of a decision as an icicle: the root above, each node as wide as the nodes below it are many.
   nodes: { names, gait (numbers of names), parent, value, end: [forward, right, heading, ...] in 0.1 mm and mrad as
   the hunter sees them, null where nobody knows, chosen: numbers of nodes }. Before player.js. */

const ROW = 26, TALLEST = 180; // pixels of one level and of all, at most

/* The nodes as a tree: those of a trace that is none are put below the runs of their sequences. */
function growTree(nodes) {
  const tree = [{ label: "now", node: -1, children: [], above: -1 }], placed = new Map(), groups = new Map();
  const put = (label, node, above) => {
    tree.push({ label, node, children: [], above });
    tree[above].children.push(tree.length - 1);
    return tree.length - 1;
  };
  nodes.gait.forEach((name, i) => {
    const label = nodes.names[name], parent = nodes.parent[i];
    if (parent >= 0) return placed.set(i, put(label, i, placed.get(parent) ?? 0));
    if (!label) {
      tree[0].node = i;
      return placed.set(i, 0);
    }
    const runs = label.split(", ");
    let above = 0;
    runs.slice(0, -1).forEach((run, k) => {
      const key = runs.slice(0, k + 1).join(", ");
      if (!groups.has(key)) groups.set(key, put(run, -1, above));
      above = groups.get(key);
    });
    if (groups.has(label) && tree[groups.get(label)].node < 0) tree[groups.get(label)].node = i;
    else groups.set(label, put(runs[runs.length - 1], i, above));
    return placed.set(i, groups.get(label));
  });
  const order = tree.map((_, i) => i);
  for (const i of order) tree[i].depth = i ? tree[tree[i].above].depth + 1 : 0;
  for (const i of order.reverse()) tree[i].width = tree[i].children.reduce((sum, child) => sum + tree[child].width, 0) || 1;
  const place = (i, from) => {
    tree[i].from = from;
    for (const child of tree[i].children) {
      place(child, from);
      from += tree[child].width;
    }
  };
  place(0, 0);
  return tree;
}

/* The tree of a step's nodes, which several ask for in turn: the last one is kept. */
const grown = { nodes: null, tree: null };
function treeOf(nodes) {
  if (nodes !== grown.nodes) Object.assign(grown, { nodes, tree: growTree(nodes) });
  return grown.tree;
}

/* Least and greatest value among the sequences that begin with each gait. */
function spreads(nodes) {
  const tree = treeOf(nodes), found = new Map();
  tree.forEach((item, i) => {
    if (!i || item.node < 0 || nodes.value[item.node] === null) return;
    let first = i;
    while (tree[first].above > 0) first = tree[first].above;
    const gait = tree[first].label.replace(/ x\d+$/, ""), value = nodes.value[item.node];
    const [low, high] = found.get(gait) || [value, value];
    found.set(gait, [Math.min(low, value), Math.max(high, value)]);
  });
  return found;
}

class Icicle {
  /* parts: box (takes the keys), picture (an svg), readout; told(path, steps) hears which nodes lead to the one pointed at,
     and how many gaits that is. */
  constructor({ box, picture, readout }, told) {
    Object.assign(this, { box, picture, readout, told, tree: null, at: 0, pointed: -1 });
    const find = (event) => (event.target.dataset.at === undefined ? -1 : Number(event.target.dataset.at));
    picture.addEventListener("pointermove", (event) => event.pointerType === "mouse" && this.point(find(event)));
    picture.addEventListener("pointerleave", () => this.point(this.held ?? -1));
    picture.addEventListener("click", (event) => this.hold(find(event)));
    box.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(box);
  }

  /* Show the nodes of a step; words(node) says one of them. */
  load(nodes, words) {
    this.nodes = nodes;
    this.words = words;
    this.held = null;
    this.tree = nodes && nodes.gait.length ? treeOf(nodes) : null;
    this.box.hidden = !this.tree;
    if (!this.tree) {
      this.told([], 0); // no path is left of the step before
      return;
    }
    const known = nodes.value.filter((value) => value !== null);
    [this.low, this.high] = [Math.min(...known), Math.max(...known)];
    const chosen = new Set(nodes.chosen);
    this.lit = new Set(this.tree.flatMap((item, i) => (chosen.has(item.node) ? [i] : [])));
    this.levels = 1 + Math.max(...this.tree.map((item) => item.depth));
    const last = nodes.chosen[nodes.chosen.length - 1];
    this.at = Math.max(0, this.tree.findIndex((item) => item.node === last));
    this.most = nodes.value[last] === this.high && this.high > this.low; // more is better
    this.width = 0;
    this.draw();
    this.point(-1);
  }

  point(at) {
    if (!this.tree) return;
    this.pointed = at;
    const path = new Set(at >= 0 ? this.path(at) : []);
    this.drawn.forEach((rect, i) => rect.classList.toggle("pointed", path.has(i)));
    const item = at >= 0 ? this.tree[at] : null;
    this.readout.textContent = this.words(item ? item.node : null, item ? this.path(at) : []);
    const below = at >= 0 ? this.path(at).slice(1).map((i) => this.tree[i]) : [];
    const steps = below.reduce((sum, { label }) => sum + Number((/ x(\d+)$/.exec(label) || [0, 1])[1]), 0);
    this.told(below.map(({ node }) => node).filter((node) => node >= 0), steps);
  }

  hold(at) {
    this.held = at >= 0 && at !== this.held ? at : null;
    if (at >= 0) this.at = at;
    this.point(this.held ?? -1);
  }

  path(at) {
    const path = [];
    for (let i = at; i >= 0; i = this.tree[i].above) path.unshift(i);
    return path;
  }

  key(event) {
    if (!this.tree || event.ctrlKey || event.metaKey || event.altKey) return;
    const item = this.tree[this.at], family = item.above >= 0 ? this.tree[item.above].children : [this.at];
    const beside = (change) => family[Math.min(Math.max(family.indexOf(this.at) + change, 0), family.length - 1)];
    const moves = {
      ArrowDown: () => item.children[0] ?? this.at, ArrowUp: () => Math.max(item.above, 0), ArrowLeft: () => beside(-1),
      ArrowRight: () => beside(1), Home: () => family[0], End: () => family[family.length - 1],
    };
    if (event.key === "Escape" && this.pointed >= 0) this.hold(-1);
    else if (event.key in moves) {
      this.at = this.held = moves[event.key]();
      this.point(this.at);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  draw() {
    const { picture, tree } = this, width = this.box.clientWidth;
    if (!tree || !width || width === this.width) return;
    this.width = width;
    const height = Math.min(ROW * this.levels, TALLEST), row = height / this.levels, unit = width / tree[0].width;
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    picture.style.height = `${height}px`;
    picture.replaceChildren();
    this.drawn = tree.map((item, i) => {
      const x = item.from * unit, y = item.depth * row, wide = item.width * unit;
      const lit = this.lit.has(i), share = lit ? 1 : this.share(item.node);
      const box = { x: x.toFixed(1), y: y.toFixed(1), width: Math.max(wide - (wide > 4 ? 1 : 0), 0.5).toFixed(1), height: (row - 1).toFixed(1) };
      const rect = shape("rect", { ...box, class: lit ? "lit" : "", "fill-opacity": share.toFixed(2), "data-at": i }, picture);
      const letters = Math.floor((wide - 6) / 6.2);
      if (letters > 2) {
        const text = item.label.length > letters ? `${item.label.slice(0, letters - 1)}…` : item.label;
        shape("text", { x: (x + 4).toFixed(1), y: (y + row / 2 + 4).toFixed(1), class: share > 0.85 ? "on" : "" }, picture, text);
      }
      return rect;
    });
    if (this.pointed >= 0) this.point(this.pointed);
  }

  /* How strong a node is drawn: the better, the stronger. */
  share(node) {
    const value = node >= 0 ? this.nodes.value[node] : null;
    if (value === null || !(this.high > this.low)) return 0.2;
    const worse = (value - this.low) / (this.high - this.low);
    return 0.12 + 0.8 * (this.most ? worse : 1 - worse) ** 2;
  }
}
