/* A table being learned, after dom.js: a slider over babbled rows counts what the tables hold after each, and draws it. */

/* Put it into `root`; told(n) hears how many rows are shown. Returns a function that shows n rows. */
function learningView(root, data, told = () => {}) {
  const total = data.rows.length / 4, G = data.gaits.length, MOST_NAMES = 40;
  const ink = (name) => getComputedStyle(root).getPropertyValue(`--bh-${name}`).trim();
  let counts, totals, shown = 0, playing = 0;
  root.classList.add("bh-learning");
  const place = element("div", { class: "parts" }, root), parts = {};
  const card = (name, title, label = title) => {
    const box = element("section", { class: name, "aria-label": label }, place);
    if (title) element("h2", {}, box, title);
    return box;
  };
  const top = card("slider", "", "Rows");
  parts.play = element("button", { type: "button", class: "play", "data-part": "play" }, top, "Play");
  parts.n = element("input", { type: "range", min: 1, max: total, value: total, step: 1, "aria-label": "Rows learned from", "data-part": "n" }, top);
  parts.said = element("output", {}, top);
  const filled = card("tables", "Tables fill", "Tables");
  parts.tables = element("div", {}, filled);
  element("p", { class: "muted" }, filled, "Rows are gaits, columns bins; the stronger, the more probable. Point at a cell, or go to it by Tab and the arrow keys, for its count.");
  parts.cell = element("p", { "data-part": "cell", "aria-live": "polite" }, filled);
  parts.map = element("canvas", { class: "map", role: "img", "aria-label": "Coverage map" }, card("coverage", "Where gaits have led", "Coverage"));
  parts.curves = element("div", {}, card("curves", "What that is worth", "Curves"));
  const next = element("table", {}, card("next", "Babble next"));
  element("caption", {}, next, "Bits that one more row of a gait is expected to tell");
  parts.next = element("tbody", {}, next);

  const heats = data.tables.map(({ name, labels }, t) => {
    element("h3", {}, parts.tables, name);
    const box = element("div", { class: "heats" }, parts.tables), names = element("div", { class: "names", "aria-hidden": "true" }, box);
    if (G <= MOST_NAMES) for (const gait of data.gaits) element("span", {}, names, gait);
    const place = element("div", { class: "heat", role: "application", tabindex: 0, "aria-roledescription": "table" }, box);
    const canvas = element("canvas", { "aria-hidden": "true" }, place), mark = element("i", { hidden: "" }, place);
    [canvas.width, canvas.height] = [labels.length, G];
    let at = [0, 0]; // bin, gait
    const read = (bin, gait) => {
      if (!(bin in labels && gait in data.gaits)) return;
      at = [bin, gait];
      mark.hidden = false;
      mark.style.cssText = `left:${(100 * bin) / labels.length}%;top:${(100 * gait) / G}%;width:${100 / labels.length}%;height:${100 / G}%`;
      parts.cell.textContent = `${name} ${labels[bin]}, ${data.gaits[gait]}: ${counts[t][bin * G + gait]} of ${totals[gait]} rows`;
    };
    for (const kind of ["pointermove", "pointerdown"])
      canvas.addEventListener(kind, (event) => {
        const around = canvas.getBoundingClientRect();
        read(Math.floor(((event.clientX - around.left) / around.width) * labels.length), Math.floor(((event.clientY - around.top) / around.height) * G));
      });
    place.addEventListener("focus", () => read(...at));
    place.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!step) return;
      event.preventDefault();
      read(at[0] + step[0], at[1] + step[1]);
    });
    return { canvas, place, again: () => mark.hidden || read(...at) };
  });

  const curves = data.curves.map(({ name, at, values }) => {
    const head = element("h3", {}, parts.curves, name), picture = shape("svg", { viewBox: "0 0 100 40", preserveAspectRatio: "none", "aria-hidden": "true" }, parts.curves);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const y = (value) => 38 - (36 * (value - low)) / Math.max(high - low, 1e-12), x = (n) => (100 * (n - 1)) / Math.max(total - 1, 1);
    shape("line", { class: "axis", x1: 0, x2: 100, y1: 39, y2: 39 }, picture);
    shape("polyline", { points: at.map((n, i) => `${x(n).toFixed(2)},${y(values[i]).toFixed(2)}`).join(" ") }, picture);
    const now = shape("line", { y1: 0, y2: 40 }, picture);
    return (n) => {
      const i = Math.max(0, at.findLastIndex((m) => m <= n));
      head.textContent = `${name}: ${Number(values[i].toPrecision(4))} after ${at[i]} rows`;
      now.setAttribute("x1", x(n));
      now.setAttribute("x2", x(n));
    };
  });

  const bars = data.gaits.map((gait) => {
    const row = element("tr", {}, parts.next), head = element("th", {}, row, gait), bar = element("div", {}, element("td", { class: "bar" }, row));
    head.scope = "row";
    return { row, bar, value: element("td", {}, row) };
  });

  /* Count on from where we are; from the start if that is behind us. */
  function count(n) {
    if (!counts || n < shown) {
      counts = data.tables.map(({ labels }) => new Int32Array(labels.length * G));
      totals = new Int32Array(G);
      shown = 0;
    }
    for (; shown < n; shown += 1) {
      const [gait, ...bins] = data.rows.slice(4 * shown, 4 * shown + 4);
      totals[gait] += 1;
      bins.forEach((bin, t) => { counts[t][bin * G + gait] += 1; });
    }
  }

  function drawHeat(canvas, table) {
    const g = canvas.getContext("2d"), bar = ink("bar"); // #rrggbb
    const colour = [1, 3, 5].map((at) => parseInt(bar.slice(at, at + 2), 16));
    const image = g.createImageData(canvas.width, G);
    for (let bin = 0; bin < canvas.width; bin += 1)
      for (let gait = 0; gait < G; gait += 1) {
        const share = totals[gait] ? table[bin * G + gait] / totals[gait] : 0, at = 4 * (gait * canvas.width + bin);
        image.data.set([...colour, 255 * Math.sqrt(share)], at);
      }
    g.putImageData(image, 0, 0);
  }

  function drawMap(n) {
    const box = parts.map.getBoundingClientRect(), ratio = window.devicePixelRatio || 1, g = parts.map.getContext("2d");
    [parts.map.width, parts.map.height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
    const size = Math.min(parts.map.width, parts.map.height) / 2, far = data.tables[0].labels.length, turn = (2 * Math.PI) / data.tables[1].labels.length;
    const seen = new Map();
    for (let i = 0; i < n; i += 1) {
      const key = data.rows[4 * i + 1] * 1000 + data.rows[4 * i + 2];
      seen.set(key, (seen.get(key) || 0) + 1);
    }
    g.translate(parts.map.width / 2, parts.map.height / 2);
    g.strokeStyle = ink("line");
    for (const share of [0.25, 0.5, 0.75, 1]) {
      g.beginPath();
      g.arc(0, 0, share * size, 0, 2 * Math.PI);
      g.stroke();
    }
    g.fillStyle = ink("hunter");
    for (const [key, times] of seen) {
      const [distance, angle] = [Math.floor(key / 1000), key % 1000];
      const from = (angle - Math.floor(data.tables[1].labels.length / 2) - 0.5) * turn - Math.PI / 2;
      g.globalAlpha = Math.min(1, 0.25 + 0.15 * Math.log2(times + 1));
      g.beginPath();
      g.arc(0, 0, ((distance + 1) / far) * size, from, from + turn);
      g.arc(0, 0, (distance / far) * size, from + turn, from, true);
      g.fill();
    }
    g.globalAlpha = 1;
    parts.map.setAttribute("aria-label", `Coverage map: ${seen.size} coordinates reached`);
  }

  function show() {
    const n = Number(parts.n.value);
    count(n);
    parts.said.textContent = `${n} of ${total} rows; ${totals.filter((rows) => rows > 0).length} of ${G} gaits babbled`;
    heats.forEach(({ canvas, place, again }, t) => {
      drawHeat(canvas, counts[t]);
      place.setAttribute("aria-label", `${data.tables[t].name}: ${counts[t].filter((c) => c > 0).length} cells hold rows; arrow keys go from cell to cell`);
      again();
    });
    drawMap(n);
    curves.forEach((curve) => curve(n));
    const bits = data.next[Math.max(0, data.at.findLastIndex((m) => m <= n))], most = Math.max(...bits);
    bars.forEach(({ row, bar, value }, i) => {
      bar.style.width = `${(100 * bits[i]) / most}%`;
      value.textContent = bits[i].toFixed(3);
      row.classList.toggle("best", bits[i] >= most - 1e-9);
    });
  }

  function play() {
    if (playing) {
      cancelAnimationFrame(playing);
      playing = 0;
      parts.play.textContent = "Play";
      told(Number(parts.n.value));
      return;
    }
    if (Number(parts.n.value) >= total) parts.n.value = 1;
    parts.play.textContent = "Pause";
    const go = () => {
      parts.n.value = Number(parts.n.value) + Math.max(1, Math.round(total / 600));
      show();
      if (Number(parts.n.value) >= total) play();
      else playing = requestAnimationFrame(go);
    };
    playing = requestAnimationFrame(go);
  }

  parts.n.addEventListener("input", show);
  parts.n.addEventListener("change", () => told(Number(parts.n.value)));
  parts.play.addEventListener("click", play);
  new ResizeObserver(show).observe(root);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
  show();
  return (n) => {
    if (n === Number(parts.n.value)) return;
    parts.n.value = n;
    show();
  };
}
