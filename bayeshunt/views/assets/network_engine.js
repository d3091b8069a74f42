/* Exact inference in a discrete Bayesian network by bucket elimination, forth and back: one pass gives every marginal.
   Source: R. Dechter, Bucket elimination, Artificial Intelligence 113, 1999. A factor has variables (numbers of nodes)
   and values, the last variable running fastest. known: state of each node, -1 where it is open; soft: a likelihood per
   state, or null. After nothing; the same numbers as bayeshunt/models/inference/network.py. */

/* Places of cells over `scope`, the last variable fastest, in a table where each variable goes by `steps` (0: not in it). */
function cellsOf(scope, steps, start, sizes) {
  let places = Int32Array.of(start);
  for (const variable of scope) {
    const size = sizes[variable], by = steps.get(variable) || 0, next = new Int32Array(places.length * size);
    for (let i = 0, at = 0; i < places.length; i += 1)
      for (let state = 0; state < size; state += 1, at += 1) next[at] = places[i] + state * by;
    places = next;
  }
  return places;
}

function stepsOf(variables, sizes) {
  const steps = new Map();
  let step = 1;
  for (let i = variables.length - 1; i >= 0; i -= 1) {
    steps.set(variables[i], step);
    step *= sizes[variables[i]];
  }
  return steps;
}

const MOST_KEPT = 1 << 23; // cells of maps that are kept for the next question

/* For each cell over `scope`, the cell over `kept`, a part of it; made once, since questions are alike. */
function project(scope, kept, sizes) {
  const maps = (sizes.maps ||= new Map()), key = `${scope}|${kept}`;
  if (!maps.has(key)) {
    const places = cellsOf(scope, stepsOf(kept, sizes), 0, sizes);
    if ((maps.cells = (maps.cells || 0) + places.length) > MOST_KEPT) {
      maps.clear();
      maps.cells = places.length;
    }
    maps.set(key, places);
  }
  return maps.get(key);
}

/* The product over all variables of the factors, those of the largest first: its values need not be moved. */
function product(factors, sizes) {
  const [first, ...others] = [...factors].sort((a, b) => b.values.length - a.values.length);
  const scope = [...new Set([first, ...others].flatMap((factor) => factor.variables))];
  const whole = scope.length === first.variables.length;
  const values = whole ? first.values.slice() : new Float64Array(scope.reduce((cells, variable) => cells * sizes[variable], 1)).fill(1);
  for (const factor of whole ? others : [first, ...others]) {
    const places = project(scope, factor.variables, sizes);
    for (let i = 0; i < values.length; i += 1) values[i] *= factor.values[places[i]];
  }
  return { variables: scope, values };
}

/* Sum (or, for the best, maximum) over what is not kept. */
function reduced(factor, kept, sizes, best) {
  const values = new Float64Array(kept.reduce((cells, variable) => cells * sizes[variable], 1));
  const places = project(factor.variables, kept, sizes);
  for (let i = 0; i < places.length; i += 1) {
    if (!best) values[places[i]] += factor.values[i];
    else if (factor.values[i] > values[places[i]]) values[places[i]] = factor.values[i];
  }
  return { variables: kept, values };
}

/* The factor at what is known, those variables gone. */
function restricted(factor, known, sizes) {
  const open = factor.variables.filter((variable) => known[variable] < 0);
  if (open.length === factor.variables.length) return factor;
  const steps = stepsOf(factor.variables, sizes);
  const start = factor.variables.reduce((sum, variable) => sum + Math.max(0, known[variable]) * steps.get(variable), 0);
  return { variables: open, values: Float64Array.from(cellsOf(open, steps, start, sizes), (place) => factor.values[place]) };
}

/* The open nodes in the order in which they leave the smallest tables. */
function eliminationOrder(factors, open, sizes) {
  const near = new Map(open.map((node) => [node, new Set()]));
  for (const { variables } of factors)
    for (const one of variables) for (const other of variables) if (one !== other) near.get(one).add(other);
  const order = [];
  while (near.size) {
    let chosen = -1, least = Infinity;
    for (const [node, others] of near) {
      let cells = 1;
      for (const other of others) cells *= sizes[other];
      if (cells < least) [chosen, least] = [node, cells];
    }
    const others = [...near.get(chosen)];
    near.delete(chosen);
    for (const one of others) {
      near.get(one).delete(chosen);
      for (const other of others) if (one !== other) near.get(one).add(other);
    }
    order.push(chosen);
  }
  return order;
}

/* Every open node's bucket: a table over the node and others, proportional to their joint distribution given what is
   known; `total` is P(known) times the likelihoods, or for the best the probability of the best states. */
function propagate(net, known, soft, best = false) {
  const { sizes } = net;
  let total = 1;
  const all = [...net.factors, ...soft.flatMap((values, node) => (values ? [{ variables: [node], values, of: -1 }] : []))];
  let left = [];
  for (const factor of all) {
    const cut = { ...restricted(factor, known, sizes), of: factor.of };
    if (cut.variables.length) left.push(cut);
    else total *= cut.values[0];
  }
  const open = known.flatMap((state, node) => (state < 0 ? [node] : []));
  const buckets = [], bucketOf = new Map(), familyIn = new Map();
  for (const node of eliminationOrder(left, open, sizes)) {
    const touched = left.filter((factor) => factor.variables.includes(node));
    const bucket = { node, table: product(touched, sizes), above: null }, scope = bucket.table.variables;
    for (const factor of touched) {
      if (factor.from) factor.from.above = bucket;
      else if (factor.of >= 0) familyIn.set(factor.of, bucket);
    }
    bucket.message = reduced(bucket.table, scope.filter((other) => other !== node), sizes, best);
    left = left.filter((factor) => !touched.includes(factor));
    if (bucket.message.variables.length) left.push({ ...bucket.message, from: bucket });
    else total *= bucket.message.values[0];
    buckets.push(bucket);
    bucketOf.set(node, bucket);
  }
  for (const bucket of buckets.reverse()) {
    if (!bucket.above) continue;
    const { message, table } = bucket, above = reduced(bucket.above.table, message.variables, sizes, best).values;
    const places = project(table.variables, message.variables, sizes);
    for (let i = 0; i < places.length; i += 1) {
      const said = message.values[places[i]];
      table.values[i] = said > 0 ? (table.values[i] / said) * above[places[i]] : 0;
    }
  }
  return { total, bucketOf, familyIn };
}

function normalised(values) {
  let sum = 0;
  for (const value of values) sum += value;
  return Float64Array.from(values, (value) => value / sum);
}

function entropy(values) {
  let bits = 0;
  for (const value of values) if (value > 0) bits -= value * Math.log2(value);
  return bits;
}

/* Values from runs, [value, how often, ...]. */
function unrolled(runs) {
  const values = new Float64Array(runs.reduce((cells, part, i) => cells + (i % 2 ? part : 0), 0));
  for (let i = 0, at = 0; i < runs.length; i += 2) values.fill(runs[i], at, (at += runs[i + 1]));
  return values;
}

/* A network from its nodes: { name, states, parents (numbers), runs of its table with the node's own states running
   fastest, and of its Dirichlet weights where they are known }. */
function makeNetwork(nodes) {
  const sizes = nodes.map((node) => node.states.length);
  const factors = nodes.map((node, of) => ({ variables: [...node.parents, of], values: unrolled(node.runs), of }));
  const weights = nodes.map((node) => (node.weights ? unrolled(node.weights) : null));
  const edges = nodes.flatMap((node, child) => node.parents.map((parent) => [parent, child]));
  return { nodes, sizes, factors, weights, edges };
}

/* Everything at once: total, marginals (by node), bits (mutual information by edge); null if the evidence is impossible. */
function answerAll(net, known, soft) {
  const { sizes } = net, found = propagate(net, known, soft);
  if (!(found.total > 0)) return null;
  const marginals = known.map((state, node) => {
    if (state >= 0) return Float64Array.from({ length: sizes[node] }, (_, i) => Number(i === state));
    return normalised(reduced(found.bucketOf.get(node).table, [node], sizes).values);
  });
  const bits = net.edges.map(([parent, child]) => {
    if (known[parent] >= 0 || known[child] >= 0) return 0;
    const both = normalised(reduced(found.familyIn.get(child).table, [parent, child], sizes).values);
    return Math.max(0, entropy(marginals[parent]) + entropy(marginals[child]) - entropy(both));
  });
  return { total: found.total, marginals, bits };
}

/* The most probable states of all nodes, of equals the first, and their probability given what is known. */
function mostProbable(net, known, soft, total) {
  const states = [...known];
  let best = propagate(net, states, soft, true);
  const probability = best.total / total;
  for (let node = 0; node < states.length; node += 1) {
    if (states[node] >= 0) continue;
    const { values } = reduced(best.bucketOf.get(node).table, [node], net.sizes, true);
    const most = Math.max(...values);
    states[node] = values.findIndex((value) => value >= most * (1 - 1e-12));
    if (values.filter((value) => value >= most * (1 - 1e-12)).length > 1) best = propagate(net, states, soft, true);
  }
  return { states, probability };
}

/* Expected bits that observing each open node would take off the doubt about `asked`; 0 for what is known. */
function worthAsking(net, known, soft, asked, marginals) {
  if (known[asked] >= 0) return known.map(() => 0);
  const left = known.map(() => 0);
  marginals[asked].forEach((share, state) => {
    if (!(share > 0)) return;
    const given = answerAll({ ...net, edges: [] }, known.map((old, node) => (node === asked ? state : old)), soft);
    given.marginals.forEach((values, node) => { left[node] += share * entropy(values); });
  });
  return known.map((state, node) => (state >= 0 || node === asked ? 0 : Math.max(0, entropy(marginals[node]) - left[node])));
}

function ancestry(net, nodes) {
  const found = new Set(), left = [...nodes];
  while (left.length) {
    const node = left.pop();
    if (found.has(node)) continue;
    found.add(node);
    left.push(...net.nodes[node].parents);
  }
  return found;
}

/* Whether the edges alone say that two nodes are independent given others: in the moral graph of the ancestors every
   path passes through what is given. */
function separated(net, one, other, given) {
  if (given.includes(one) || given.includes(other)) return true;
  const cliques = [...ancestry(net, [one, other, ...given])].map((node) => [node, ...net.nodes[node].parents]);
  const reached = new Set([one]), left = [one];
  while (left.length) {
    const here = left.pop();
    for (const clique of cliques.filter((nodes) => nodes.includes(here)))
      for (const node of clique)
        if (!reached.has(node) && !given.includes(node)) {
          reached.add(node);
          left.push(node);
        }
  }
  return !reached.has(other);
}

/* Parents, children and the children's other parents. */
function markovBlanket(net, asked) {
  const near = new Set(net.nodes[asked].parents);
  net.nodes.forEach((node, child) => {
    if (node.parents.includes(asked)) for (const one of [child, ...node.parents]) near.add(one);
  });
  near.delete(asked);
  return near;
}
