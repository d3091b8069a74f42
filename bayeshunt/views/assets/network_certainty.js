/* How sure an answer is, after network_engine.js and network_draws.js: every column of the tables is drawn from its
   Dirichlet, and each draw of the tables gives one answer; the interval holds the middle 95 % of them. The same rule as
   bayeshunt/models/certainty, for any node and whatever is known. In logarithms: with pseudo-counts far below 1 a
   probability is often smaller than any number. Source: Gelman et al., Bayesian Data Analysis, 3rd ed., section 3.4. */

const MOST_DRAWN = 1 << 13; // cells; more would keep the page busy for seconds
const DRAWN = 1 << 18, FEWEST_DRAWS = 512, MOST_DRAWS = 1 << 14;

/* The tables behind P(asked, what is known) over `scope`, the open nodes that have to do with it, cut down to what is
   known. `logs` of each is filled by its `draw(value, draw)`, where it is uncertain: of `size` variables from `first` on. */
function tablesBehind(net, known, soft, asked) {
  const { sizes } = net, given = known.flatMap((state, node) => (state >= 0 || soft[node] ? [node] : []));
  const needed = [...ancestry(net, [asked, ...given])].sort((a, b) => a - b), scope = needed.filter((node) => known[node] < 0);
  const variables = [];
  const tables = needed.map((node) => {
    const { parents } = net.nodes[node], steps = stepsOf([...parents, node], sizes), states = sizes[node], state = known[node];
    const open = parents.filter((parent) => known[parent] < 0);
    const start = parents.reduce((sum, parent) => sum + Math.max(0, known[parent]) * steps.get(parent), 0);
    const columns = cellsOf(open, steps, start, sizes), places = project(scope, state < 0 ? [...open, node] : open, sizes);
    const from = net.weights[node] || net.factors[node].values;
    const cut = state < 0 ? Float64Array.from({ length: columns.length * states }, (_, i) => from[columns[Math.floor(i / states)] + (i % states)])
      : Float64Array.from(columns, (base) => from[base + state]);
    if (!net.weights[node]) return { places, logs: cut.map(Math.log), draw: null };
    const sums = Float64Array.from(columns, (base) => from.subarray(base, base + states).reduce((a, b) => a + b, 0));
    const first = variables.length, logs = new Float64Array(cut.length);
    cut.forEach((own, i) => variables.push(state < 0 ? [own] : [own, sums[i] - own]));
    return { places, logs, draw: state < 0 ? dirichlet(logs, first, cut, states) : beta(logs, first, cut, sums) };
  });
  soft.forEach((values, node) => {
    if (values) tables.push({ places: project(scope, [node], sizes), logs: values.map(Math.log), draw: null });
  });
  return { scope, tables, variables };
}

/* What draws one state of each column: certain where all weight is its own, never where it has none. */
const beta = (logs, first, own, sums) => (value, draw) => {
  for (let i = 0; i < logs.length; i += 1) logs[i] = !(own[i] > 0) ? -Infinity : sums[i] > own[i] ? value(first + i, draw) : 0;
};

/* What draws whole columns: Gamma variables, each column divided by its sum. */
const dirichlet = (logs, first, own, states) => (value, draw) => {
  for (let base = 0; base < logs.length; base += states) {
    let most = -Infinity, sum = 0;
    for (let i = base; i < base + states; i += 1) {
      logs[i] = own[i] > 0 ? value(first + i, draw) : -Infinity;
      if (logs[i] > most) most = logs[i];
    }
    for (let i = base; i < base + states; i += 1) sum += Math.exp(logs[i] - most);
    for (let i = base; i < base + states; i += 1) logs[i] -= most + Math.log(sum);
  }
};

/* The quantiles of a Gamma [shape] or a Beta [own, rest], kept: cells without rows are alike. */
function quantilesOf(net, weights) {
  const known = (net.quantiles ||= new Map()), key = weights.join();
  if (!known.has(key)) known.set(key, weights.some((weight) => !(weight > 0)) ? null : weights.length > 1 ? logBetaQuantiles(...weights) : logGammaQuantiles(...weights));
  return known.get(key);
}

/* Low and high ends of the 95 % intervals of P(asked | what is known), around `point`, state by state; null where nobody
   knows the counts or there are too many cells. A generator: after each step it may be left alone for a while. */
function* intervals(net, known, soft, asked, point) {
  if (known[asked] >= 0 || !net.weights.some(Boolean)) return null;
  const { scope, tables, variables } = tablesBehind(net, known, soft, asked), places = project(scope, [asked], net.sizes);
  if (!variables.length || Math.max(variables.length, places.length) > MOST_DRAWN) return null;
  const quantiles = [];
  for (const weights of variables) {
    quantiles.push(quantilesOf(net, weights));
    yield;
  }
  const draws = Math.min(MOST_DRAWS, Math.max(FEWEST_DRAWS, 2 ** Math.floor(Math.log2(DRAWN / variables.length))));
  const value = yield* spread(quantiles, draws), joint = new Float64Array(places.length);
  const shares = Array.from(point, () => new Float64Array(draws));
  for (let draw = 0; draw < draws; draw += 1) {
    if (draw % 32 === 0) yield;
    joint.fill(0);
    for (const table of tables) {
      if (table.draw) table.draw(value, draw);
      for (let i = 0; i < joint.length; i += 1) joint[i] += table.logs[table.places[i]];
    }
    const most = joint.reduce((a, b) => Math.max(a, b), -Infinity);
    let sum = 0;
    for (let i = 0; i < joint.length; i += 1) {
      const part = most === -Infinity ? 1 : Math.exp(joint[i] - most);
      shares[places[i]][draw] += part;
      sum += part;
    }
    for (const share of shares) share[draw] /= sum;
  }
  return shares.map((values, state) => {
    values.sort();
    return [Math.min(point[state], quantile(values, 0.025)), Math.max(point[state], quantile(values, 0.975))];
  });
}

function quantile(sorted, level) {
  const at = level * (sorted.length - 1), below = Math.floor(at);
  return sorted[below] + (at - below) * (sorted[Math.min(below + 1, sorted.length - 1)] - sorted[below]);
}
