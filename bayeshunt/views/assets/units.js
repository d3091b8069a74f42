/* Units that people read, as in bayeshunt/core/units.py: metres become mm (m from 1 m on), radians degrees. */
const length = (metres) => {
  if (Math.abs(metres) >= 0.9995) return `${Number(metres.toPrecision(3))} m`;
  const mm = 1000 * metres;
  return `${Math.abs(mm) >= 10 ? mm.toFixed(0) : Number(mm.toPrecision(2))} mm`;
};
const degrees = (radians) => `${((180 * radians) / Math.PI).toFixed(0).replace(/^-0$/, "0").replace("-", "−")}°`;
/* A bin around its middle, as "154 to 160 mm" or "−5° to 5°". */
const lengths = (low, high) => `${length(high).endsWith(" mm") ? Math.max(0, 1000 * low).toFixed(0) : length(low)} to ${length(high)}`;
const angles = (low, high) => `${degrees(low)} to ${degrees(high)}`;
const range = (middle, width, words) => words(middle - width / 2, middle + width / 2);
const wrap = (angle) => Math.PI - ((((Math.PI - angle) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI));
