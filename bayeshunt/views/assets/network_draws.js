/* Draws of Beta and Gamma variables that are the same every time and spread evenly, in logarithms: each variable takes its
   own quantiles at evenly spaced levels, tails included, in an order of its own (a Latin hypercube: M. McKay, R. Beckman
   and W. Conover, Technometrics 21, 1979). The counterpart of bayeshunt/models/certainty/draws.py. */

/* Levels u at which quantiles are worked out, even in log u / (1 - u). */
const LEVELS = 145, FARTHEST = 18, POINTS = 2048, SMALL = 1e-4;

/* Numbers in (0, 1), the same every time (mulberry32). */
function uniforms(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return (((t ^ (t >>> 14)) >>> 0) + 0.5) / 4294967296;
  };
}

/* log Gamma(x), x > 0: Stirling's series from 10 on. */
function logGamma(x) {
  let below = 0;
  for (; x < 10; x += 1) below += Math.log(x);
  return (x - 0.5) * Math.log(x) - x + 0.9189385332046727 + 1 / (12 * x) - 1 / (360 * x ** 3) + 1 / (1260 * x ** 5) - below;
}

/* Log of the quantiles of Beta(a, b) at the levels: the density of x = log p / (1 - p), summed up. */
function logBetaQuantiles(a, b) {
  const scale = logGamma(a) + logGamma(b) - logGamma(a + b), tail = Math.log(SMALL / (a + b + 1));
  const middle = Math.log(a / b), far = a > 1 && b > 1 ? 12 * Math.sqrt(1 / a + 1 / b) : Infinity;
  const [low, high] = [Math.max(tail, middle - far), Math.min(-tail, middle + far)];
  const ends = [Math.exp(a * low - scale) / a, Math.exp(-b * high - scale) / b]; // what lies beyond, the rest of p near 1
  return quantiles((x) => a * x - (a + b) * softplus(x) - scale, [low, high], ends, [a, b]).map((x) => -softplus(-x));
}

/* Log of the quantiles of Gamma(a) at the levels. */
function logGammaQuantiles(a) {
  const scale = logGamma(a), low = Math.max(Math.log(SMALL), a > 1 ? Math.log(a) - 12 / Math.sqrt(a) : -Infinity);
  return quantiles((x) => a * x - Math.exp(x) - scale, [low, Math.log(a + 8 * Math.sqrt(a) + 25)], [Math.exp(a * low - scale) / a, 0], [a, 1]);
}

const softplus = (x) => Math.max(x, 0) + Math.log1p(Math.exp(-Math.abs(x)));

/* Quantiles of a variable from its log density between two ends; what lies beyond them falls off by `rates`. */
function quantiles(logDensity, [low, high], [below, above], rates) {
  const step = (high - low) / (POINTS - 1), reached = new Float64Array(POINTS);
  let before = Math.exp(logDensity(low)), total = below;
  reached[0] = total;
  for (let i = 1; i < POINTS; i += 1) {
    const here = Math.exp(logDensity(low + i * step));
    reached[i] = total += (step * (before + here)) / 2;
    before = here;
  }
  total += above;
  let at = 0;
  return Float64Array.from({ length: LEVELS }, (_, k) => {
    const odds = Math.exp(FARTHEST * ((2 * k) / (LEVELS - 1) - 1)), level = (odds / (1 + odds)) * total, left = total / (1 + odds);
    if (level <= below) return low + Math.log(level / below) / rates[0];
    if (left <= above) return high - Math.log(left / above) / rates[1];
    while (at < POINTS - 2 && reached[at + 1] < level) at += 1;
    const gained = reached[at + 1] - reached[at];
    return low + step * (at + (gained > 0 ? Math.min(1, (level - reached[at]) / gained) : 0));
  });
}

/* Draws of variables given by their quantiles: value(variable, draw). A generator that may be left alone for a while. */
function* spread(tables, draws) {
  const uniform = uniforms(20100), orders = new Uint16Array(tables.length * draws), places = new Float64Array(draws);
  for (let i = 0; i < draws; i += 1) {
    const level = (i + 0.5) / draws;
    places[i] = ((Math.log(level / (1 - level)) / FARTHEST + 1) * (LEVELS - 1)) / 2;
  }
  for (let v = 0; v < tables.length; v += 1, yield) {
    const order = orders.subarray(v * draws, (v + 1) * draws);
    for (let i = 0; i < draws; i += 1) { // inside-out shuffle
      const j = Math.floor(uniform() * (i + 1));
      order[i] = order[j];
      order[j] = i;
    }
  }
  return (variable, draw) => {
    const place = places[orders[variable * draws + draw]], below = Math.floor(place), table = tables[variable];
    return table[below] + (place - below) * (table[below + 1] - table[below]);
  };
}
