/* The whole network as an instrument, after dom.js, network_engine.js and network_certainty.js: every node with prior and
   posterior; a click sets evidence, a second gesture a likelihood; edges as wide as their ends have to say of each other;
   how sure the answer is that was asked for. */

const LIST_UP_TO = 12; // states written one below the other; more stand side by side
const EXPLAINED_UP_TO = 10; // nodes
const MOST_SURE = 4; // states whose interval is written out
const SLICE = 12; // ms that drawing intervals may keep the page at a time
const SOFTER = 3; // how much more probable a second gesture makes what was seen in a state
const WIDE = 212, NARROW = 140, GAP = 16;

const share = (p) => (p === 0 ? "0" : p < 0.0005 ? "<.001" : p > 0.9995 && p < 1 ? ">.999" : p.toFixed(3));
const said = (p) => (p >= 0.001 ? p.toPrecision(4) : p.toExponential(3)).replace("-", "−");

/* An interval of probabilities, rounded outwards, as in bayeshunt/core/units.py: "0.31 to 1". */
const bounds = ([low, high]) => `${Math.floor(100 * low + 1e-9) / 100} to ${Math.ceil(100 * high - 1e-9) / 100}`;

/* The first of the most probable states, whatever the last digit says. */
const mostOf = (values) => values.findIndex((value) => value >= Math.max(...values) * (1 - 1e-12));

/* Columns from causes to effects: a node one column after its last parent, one without parents just before its first child. */
function columnsOf(nodes) {
  const at = nodes.map(() => -1);
  const depth = (i) => {
    if (at[i] < 0) at[i] = nodes[i].parents.reduce((most, parent) => Math.max(most, depth(parent) + 1), 0);
    return at[i];
  };
  nodes.forEach((_, i) => depth(i));
  nodes.forEach((node, i) => {
    const children = nodes.flatMap((other, j) => (other.parents.includes(i) ? [at[j]] : []));
    if (!node.parents.length && children.length) at[i] = Math.min(...children) - 1;
  });
  const columns = Array.from({ length: Math.max(...at) + 1 }, () => []);
  nodes.forEach((_, i) => columns[at[i]].push(i));
  const near = nodes.map((node, i) => [...node.parents, ...nodes.flatMap((other, j) => (other.parents.includes(i) ? [j] : []))]);
  const place = new Map();
  const number = () => columns.forEach((column) => column.forEach((i, k) => place.set(i, (k + 0.5) / column.length)));
  number();
  for (let sweep = 0; sweep < 8; sweep += 1) { // next to their neighbours, so that few edges cross
    for (const column of columns) {
      const wish = new Map(column.map((i) => [i, near[i].length ? near[i].reduce((sum, j) => sum + place.get(j), 0) / near[i].length : place.get(i)]));
      column.sort((a, b) => wish.get(a) - wish.get(b));
      number();
    }
  }
  return columns;
}

class NetworkView {
  /* data: { nodes: [{ name, states (as data have them), labels (as people read them), parents, runs }], asked };
     told(evidence, likelihood, asked) hears of every change. */
  constructor(root, data, told) {
    this.root = root;
    this.data = data;
    this.told = told || (() => {});
    this.net = makeNetwork(data.nodes);
    this.known = data.nodes.map(() => -1);
    this.soft = data.nodes.map(() => null);
    this.asked = Math.max(0, data.nodes.findIndex((node) => node.name === data.asked));
    this.prior = answerAll(this.net, this.known, this.soft);
    this.build();
    new ResizeObserver(() => this.arrange()).observe(root);
    this.show();
  }

  // --- what is known --------------------------------------------------------------------------

  /* Evidence and likelihoods by name, as Python has them. */
  set(evidence, likelihood, asked) {
    this.data.nodes.forEach((node, i) => {
      this.known[i] = node.name in evidence ? node.states.indexOf(evidence[node.name]) : -1;
      this.soft[i] = node.name in likelihood ? Float64Array.from(likelihood[node.name]) : null;
      if (node.name === asked) this.asked = i;
    });
    this.show();
  }

  tell(words) {
    const evidence = {}, likelihood = {};
    this.data.nodes.forEach((node, i) => {
      if (this.known[i] >= 0) evidence[node.name] = node.states[this.known[i]];
      if (this.soft[i]) likelihood[node.name] = [...this.soft[i]];
    });
    this.show();
    this.told(evidence, likelihood, this.data.nodes[this.asked].name);
    const best = this.answer ? `${this.nameOf(this.asked)}: ${this.bestOf(this.asked)}.` : "This evidence is impossible.";
    this.parts.status.textContent = `${words} ${best}`;
  }

  observe(node, state) {
    const gone = this.known[node] === state;
    this.known[node] = gone ? -1 : state;
    this.soft[node] = null;
    this.tell(`${this.nameOf(node)} ${gone ? "open again" : `is ${this.labelOf(node, state)}`}.`);
  }

  /* What was perceived is three times as probable in this state, against the others, as was said before. */
  lean(node, state) {
    this.known[node] = -1;
    const values = this.soft[node] ? [...this.soft[node]] : this.data.nodes[node].states.map(() => 1);
    values[state] *= SOFTER;
    const most = Math.max(...values);
    this.soft[node] = Float64Array.from(values, (value) => value / most);
    this.tell(`${this.nameOf(node)} is more likely ${this.labelOf(node, state)}.`);
  }

  clear(nodes) {
    for (const node of nodes) [this.known[node], this.soft[node]] = [-1, null];
    this.tell(nodes.length > 1 ? "Nothing is known." : `${this.nameOf(nodes[0])} open again.`);
  }

  ask(node) {
    this.asked = node;
    this.tell(`Asked: ${this.nameOf(node)}.`);
  }

  nameOf(node) { return this.data.nodes[node].name; }

  labelOf(node, state) { return this.data.nodes[node].labels[state]; }

  bestOf(node) {
    const values = this.answer.marginals[node], most = mostOf(values);
    return `${this.labelOf(node, most)} ${share(values[most])}${this.within(node, most)}`;
  }

  /* " (0.31 to 1)" where the interval is known. */
  within(node, state) {
    return this.sure && node === this.asked ? ` (${bounds(this.sure[state])})` : "";
  }

  // --- the picture ----------------------------------------------------------------------------

  build() {
    const { root, data } = this;
    root.classList.add("bh-network");
    const top = element("div", { class: "top" }, root);
    const stage = element("div", { class: "stage", role: "region", tabindex: 0, "aria-label": "The network" }, root);
    const plane = element("div", { class: "plane" }, stage), side = element("div", { class: "side" }, root);
    const svg = shape("svg", { class: "edges", "aria-hidden": "true" }, plane);
    const tips = shape("marker", { id: "bh-tip", viewBox: "0 0 8 8", refX: 7, refY: 4, markerWidth: 11, markerHeight: 11,
      markerUnits: "userSpaceOnUse", orient: "auto" }, shape("defs", {}, svg));
    shape("path", { class: "tip", d: "M0 0L8 4L0 8z" }, tips);
    this.edges = this.net.edges.map(() => shape("path", { class: "edge", "marker-end": "url(#bh-tip)" }, svg));
    this.columns = columnsOf(data.nodes);
    this.cards = [];
    for (const node of this.columns.flat()) this.cards[node] = this.card(node, plane);
    this.parts = { stage, plane, svg };
    this.buildTop(top);
    this.buildSide(side);
    this.parts.status = element("p", { class: "spoken", role: "status" }, root);
    root.addEventListener("keydown", (event) => this.key(event));
  }

  card(node, plane) {
    const { labels, name, parents } = this.data.nodes[node], listed = labels.length <= LIST_UP_TO;
    const box = element("section", { class: `node ${listed ? "listed" : "columns"}`, "aria-label": name }, plane);
    const head = element("button", { type: "button", class: "name", title: `Ask about ${name}` }, box, name);
    const from = parents.length ? `from ${parents.map((parent) => this.nameOf(parent)).join(", ")}` : "";
    if (from) element("p", { class: "from" }, box, from);
    const prefix = `bh-${node}-${Math.random().toString(36).slice(2, 8)}`;
    const list = element("div", { class: "states", role: "listbox", tabindex: 0, "aria-label": name,
      "aria-orientation": listed ? "vertical" : "horizontal" }, box);
    const options = labels.map((label, state) => {
      const option = element("div", { class: "state", role: "option", id: `${prefix}-${state}`, "aria-selected": "false" }, list);
      if (listed) element("span", { class: "label" }, option, label);
      const track = element("span", { class: "track" }, option);
      const ghost = element("span", { class: "ghost" }, track), bar = element("span", { class: "bar" }, track);
      return { option, track, whisker: null, ghost, bar, value: listed ? element("span", { class: "value" }, option) : null };
    });
    const readout = listed ? null : element("p", { class: "readout" }, box);
    const card = { box, head, list, options, readout, active: mostOf(this.prior.marginals[node]) };
    head.addEventListener("click", () => this.ask(node));
    this.gestures(node, card);
    return card;
  }

  /* A click is evidence; shift and click, a right click or a long press a likelihood. */
  gestures(node, card) {
    const stateOf = (event) => card.options.findIndex(({ option }) => option.contains(event.target));
    let timer = 0, held = false;
    card.list.addEventListener("pointerdown", (event) => {
      held = false;
      const state = stateOf(event);
      clearTimeout(timer);
      if (event.pointerType !== "mouse" && state >= 0)
        timer = setTimeout(() => { held = true; this.lean(node, state); }, 550);
    });
    for (const name of ["pointerup", "pointercancel", "pointerleave"]) card.list.addEventListener(name, () => clearTimeout(timer));
    card.list.addEventListener("click", (event) => {
      const state = stateOf(event);
      if (state < 0 || held) return;
      this.activate(node, state);
      if (event.shiftKey) this.lean(node, state);
      else this.observe(node, state);
    });
    card.list.addEventListener("contextmenu", (event) => {
      const state = stateOf(event);
      event.preventDefault();
      if (state >= 0 && !held) this.lean(node, state);
    });
    card.list.addEventListener("pointermove", (event) => {
      const state = stateOf(event);
      if (event.pointerType === "mouse" && state >= 0) this.read(node, state);
    });
    card.list.addEventListener("pointerleave", () => this.read(node, card.active));
    card.list.addEventListener("focus", () => this.activate(node, card.active));
  }

  activate(node, state) {
    const card = this.cards[node], most = card.options.length - 1;
    card.options[card.active].option.classList.remove("active");
    card.chosen = true;
    card.active = Math.min(Math.max(state, 0), most);
    const { option } = card.options[card.active];
    option.classList.add("active");
    card.list.setAttribute("aria-activedescendant", option.id);
    this.read(node, card.active);
  }

  read(node, state) {
    const { readout } = this.cards[node];
    if (readout) readout.textContent = this.words(node, state);
  }

  words(node, state) {
    const label = this.labelOf(node, state), prior = share(this.prior.marginals[node][state]);
    if (!this.answer) return label;
    const now = share(this.answer.marginals[node][state]), within = this.within(node, state);
    return now === prior ? `${label}: ${now}${within}` : `${label}: ${now}${within}, before ${prior}`;
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const node = this.cards.findIndex((card) => card.list === event.target);
    const acts = { Escape: () => this.clear(this.known.map((_, i) => i)) };
    if (node >= 0) {
      const card = this.cards[node], by = (change) => () => this.activate(node, card.active + change);
      Object.assign(acts, {
        ArrowDown: by(1), ArrowRight: by(1), ArrowUp: by(-1), ArrowLeft: by(-1), PageDown: by(10), PageUp: by(-10),
        Home: by(-Infinity), End: by(Infinity),
        Enter: () => (event.shiftKey ? this.lean(node, card.active) : this.observe(node, card.active)),
        " ": () => this.observe(node, card.active),
        l: () => this.lean(node, card.active),
        L: () => this.lean(node, card.active),
        a: () => this.ask(node),
        Delete: () => this.clear([node]),
        Backspace: () => this.clear([node]),
      });
    }
    if (!(event.key in acts)) return;
    event.preventDefault();
    event.stopPropagation(); // the notebook around would act too
    acts[event.key]();
  }

  /* Where the cards are: in columns where there is room, else one below the other. */
  arrange() {
    const { plane, svg } = this.parts, room = this.root.clientWidth;
    const wide = this.data.nodes.length <= EXPLAINED_UP_TO ? WIDE : NARROW, many = this.data.nodes.length > EXPLAINED_UP_TO;
    this.root.classList.toggle("stacked", room < 620);
    this.root.classList.toggle("many", many);
    if (room < 620) {
      plane.style.width = plane.style.height = "";
      for (const { box } of this.cards) box.style.left = box.style.top = box.style.width = "";
      return;
    }
    const least = this.columns.length * (wide + 60) - 60;
    this.root.classList.toggle("below", !many && room < least + 320); // what is said of the node asked
    const between = many ? 28 : Math.max(60, Math.min(140, (this.parts.stage.clientWidth - this.columns.length * wide) / this.columns.length));
    for (const { box } of this.cards) box.style.width = `${wide}px`;
    const heights = this.cards.map(({ box }) => box.offsetHeight);
    const tall = this.columns.map((column) => column.reduce((sum, i) => sum + heights[i] + GAP, -GAP));
    const height = Math.max(...tall);
    this.columns.forEach((column, k) => {
      const gap = column.length > 1 ? Math.min(60, (height - tall[k]) / (column.length + 1)) : 0;
      let y = (height - tall[k] - gap * (column.length - 1)) / 2;
      for (const i of column) {
        this.cards[i].box.style.left = `${k * (wide + between)}px`;
        this.cards[i].box.style.top = `${y}px`;
        this.cards[i].at = [k * (wide + between), y + heights[i] / 2];
        y += heights[i] + GAP + gap;
      }
    });
    const across = this.columns.length * (wide + between) - between;
    plane.style.width = `${across}px`;
    plane.style.height = `${height}px`;
    svg.setAttribute("viewBox", `0 0 ${across} ${height}`);
    this.net.edges.forEach(([parent, child], i) => {
      const [x, y] = this.cards[parent].at, [u, v] = this.cards[child].at, start = x + wide, bend = Math.max(30, (u - start) / 2);
      this.edges[i].setAttribute("d", `M${start} ${y}C${start + bend} ${y} ${u - 2 - bend} ${v} ${u - 2} ${v}`);
    });
  }

  // --- what moves -----------------------------------------------------------------------------

  show() {
    const before = performance.now();
    const any = this.known.some((state) => state >= 0) || this.soft.some(Boolean);
    this.answer = any ? answerAll(this.net, this.known, this.soft) : this.prior;
    const given = this.known.flatMap((state, node) => (state >= 0 ? [node] : []));
    // a likelihood is a child that is seen: it opens the same paths as evidence on a child would
    const seen = { ...this.net, nodes: [...this.net.nodes] };
    this.soft.forEach((values, node) => {
      if (values) given.push(seen.nodes.push({ parents: [node] }) - 1);
    });
    const blanket = markovBlanket(this.net, this.asked);
    this.cards.forEach((card, node) => this.showCard(card, node, blanket, node !== this.asked && separated(seen, this.asked, node, given)));
    this.net.edges.forEach(([parent, child], i) => {
      const bits = this.answer ? this.answer.bits[i] : 0;
      this.edges[i].style.strokeWidth = `${0.75 + 3.2 * Math.sqrt(bits)}px`;
      this.edges[i].classList.toggle("mute", bits < 1e-9);
    });
    this.sure = null;
    this.showSide();
    this.root.dataset.ms = (performance.now() - before).toFixed(1);
    this.doubt();
  }

  /* Work out how sure the answer is, a few ms at a time once it is painted; another question ends it. */
  doubt() {
    const { net, known, soft, asked, answer } = this;
    clearTimeout(this.doubting);
    this.showDoubt();
    if (!answer) return;
    const drawing = intervals(net, [...known], [...soft], asked, answer.marginals[asked]);
    const go = () => {
      const end = performance.now() + SLICE;
      let step;
      do step = drawing.next(); while (!step.done && performance.now() < end);
      if (!step.done) this.doubting = setTimeout(go);
      else if (step.value) {
        this.sure = step.value;
        this.showDoubt();
      }
    };
    this.doubting = setTimeout(go, 40);
  }

  /* Whiskers on the bars of the node asked, and their numbers beside; none where nothing is known of them. */
  showDoubt() {
    const { parts, sure, asked, answer } = this;
    this.cards.forEach((card, node) => card.options.forEach((option, state) => {
      const { track } = option, side = card.readout ? ["bottom", "height"] : ["left", "width"];
      const drawn = sure && node === asked && sure[state][1] >= 0.005;
      if (!drawn && option.whisker) option.whisker = option.whisker.remove();
      if (!drawn) return;
      const [low, high] = sure[state].map((end) => Math.min(1, end / card.top));
      option.whisker ||= element("span", { class: "whisker" }, track);
      option.whisker.style[side[0]] = `${100 * low}%`;
      option.whisker.style[side[1]] = `${100 * (high - low)}%`;
    }));
    parts.sureTitle.hidden = parts.sure.hidden = parts.supposed.hidden = !sure;
    if (!sure) return;
    parts.asked.textContent = this.askedWords();
    this.read(asked, this.cards[asked].active);
    const first = sure.map((_, state) => state).sort((a, b) => answer.marginals[asked][b] - answer.marginals[asked][a] || sure[b][1] - sure[a][1]);
    this.facts(parts.sure, first.slice(0, MOST_SURE).map((state) => [this.labelOf(asked, state), `${share(answer.marginals[asked][state])}${this.within(asked, state)}`]));
    if (!this.cards[asked].readout) return;
    this.cards[asked].options.forEach(({ option }, state) => option.setAttribute("aria-label", this.words(asked, state)));
  }

  askedWords() {
    const { answer, asked } = this;
    return answer ? `Most probable: ${this.bestOf(asked)}; doubt left ${entropy(answer.marginals[asked]).toFixed(2)} bits.` : "";
  }

  showCard(card, node, blanket, apart) {
    const known = this.known[node], soft = this.soft[node], marginal = this.answer && this.answer.marginals[node];
    const prior = this.prior.marginals[node];
    const top = (card.top = card.readout ? Math.max(...prior, ...(marginal || [])) : 1), side = card.readout ? "height" : "width";
    card.box.classList.toggle("asked", node === this.asked);
    card.box.classList.toggle("blanket", blanket.has(node));
    card.box.classList.toggle("seen", known >= 0 || soft !== null);
    card.box.classList.toggle("apart", apart && known < 0);
    card.head.setAttribute("aria-pressed", String(node === this.asked));
    if (!card.chosen && marginal) card.active = mostOf(marginal); // what is read, as long as nobody chose a state
    card.options.forEach((parts, state) => {
      const { option, ghost, bar, value } = parts, p = marginal ? marginal[state] : 0;
      const leaning = soft !== null && soft[state] === Math.max(...soft), looks = [p, top, state === known, leaning].join(" ");
      if (parts.looks === looks) return; // what did not change is not drawn again
      parts.looks = looks;
      ghost.style[side] = `${(100 * prior[state]) / top}%`;
      bar.style[side] = `${(100 * p) / top}%`;
      option.classList.toggle("never", p === 0);
      option.classList.toggle("leaning", leaning);
      option.setAttribute("aria-selected", String(state === known));
      if (value) value.textContent = share(p);
      else option.setAttribute("aria-label", this.words(node, state));
    });
    this.read(node, card.active);
  }

  buildTop(top) {
    const { parts } = this;
    parts.total = element("p", { class: "total" }, top);
    parts.known = element("ul", { class: "chips", "aria-label": "What is known" }, top);
    parts.clear = element("button", { type: "button", class: "clear" }, top, "Clear all");
    parts.clear.addEventListener("click", () => this.clear(this.known.map((_, i) => i)));
  }

  buildSide(side) {
    const { parts } = this;
    parts.askedTitle = element("h2", {}, side);
    parts.asked = element("p", {}, side);
    parts.sureTitle = element("h2", {}, side, "How sure: 95 % intervals");
    parts.sure = element("ul", { class: "facts" }, side);
    parts.supposed = element("p", { class: "help" }, side, this.data.pseudo);
    parts.edges = element("ul", { class: "facts" }, side);
    if (this.data.nodes.length <= EXPLAINED_UP_TO) {
      parts.worthTitle = element("h2", {}, side);
      parts.worth = element("ul", { class: "facts" }, side);
      element("h2", {}, side, "Most probable explanation");
      parts.best = element("ul", { class: "facts" }, side);
    }
    const legend = element("ul", { class: "legend" }, side);
    const whiskers = this.data.pseudo ? [["whisker", "95 % interval of what is asked"]] : [];
    for (const [mark, words] of [["ghost", "before any evidence"], ["bar", "now"], ...whiskers, ["evidence", "known"], ["blanket", "Markov blanket of what is asked"],
      ["apart", "says nothing of what is asked"], ["wide", "wider edge: more bits in common"]]) {
      const item = element("li", {}, legend);
      element("i", { class: mark }, item);
      item.append(words);
    }
    element("p", { class: "help" }, side, "Click a state: it is known. Shift and click, or a long press: it was perceived, three times as probable there as elsewhere. Click a name: ask about it.");
    element("p", { class: "help" }, side, "Keys: Tab to a node, arrows to a state, Enter known, L likelihood, A ask, Delete open again, Esc clear all.");
  }

  showSide() {
    const { parts, net, known, soft, asked } = this, answer = this.answer;
    const any = known.some((state) => state >= 0) || soft.some(Boolean);
    parts.total.textContent = !answer ? "P(evidence) = 0: this cannot be, take something back"
      : any ? `P(evidence) = ${said(answer.total)}` : "P(evidence) = 1: nothing is known yet";
    parts.total.classList.toggle("impossible", !answer);
    parts.clear.hidden = parts.known.hidden = !any;
    parts.known.replaceChildren(...known.flatMap((state, node) => {
      if (state < 0 && !soft[node]) return [];
      const item = element("li", {}), words = `${this.nameOf(node)} ${state >= 0 ? `= ${this.labelOf(node, state)}` : `≈ ${this.labelOf(node, soft[node].indexOf(Math.max(...soft[node])))}`}`;
      const button = element("button", { type: "button", "aria-label": `Take back ${words}` }, item, `${words} ×`);
      button.addEventListener("click", () => this.clear([node]));
      return [item];
    }));
    const name = this.nameOf(asked);
    parts.askedTitle.textContent = `Asked: ${name}`;
    parts.asked.textContent = this.askedWords();
    this.facts(parts.edges, net.edges.flatMap(([parent, child], i) => (answer && (parent === asked || child === asked)
      ? [[`${this.nameOf(parent)} → ${this.nameOf(child)}`, `${answer.bits[i].toFixed(3)} bits`]] : [])));
    if (!parts.worth) return;
    parts.worthTitle.textContent = `Worth asking next, for ${name}`;
    if (!answer) return [parts.worth, parts.best].forEach((list) => list.replaceChildren());
    const { worth, best } = this.looked(any);
    const open = known.flatMap((state, node) => (state < 0 && node !== asked ? [node] : [])).sort((a, b) => worth[b] - worth[a]);
    this.facts(parts.worth, known[asked] >= 0 ? [] : open.map((node) => [this.nameOf(node), `${worth[node].toFixed(3)} bits`]));
    this.facts(parts.best, [...best.states.map((state, node) => [this.nameOf(node), this.labelOf(node, state)]), ["together", `P = ${said(best.probability)}`]]);
  }

  /* What is worth asking and the most probable explanation; where nothing is known, worked out once. */
  looked(any) {
    const { net, known, soft, asked, answer } = this, memory = any ? {} : (this.memory ||= {});
    return (memory[asked] ||= {
      worth: worthAsking(net, known, soft, asked, answer.marginals), best: mostProbable(net, known, soft, answer.total),
    });
  }

  facts(list, pairs) {
    list.replaceChildren(...pairs.map(([name, value]) => {
      const item = element("li", {});
      element("span", {}, item, name);
      element("b", {}, item, value);
      return item;
    }));
  }
}
