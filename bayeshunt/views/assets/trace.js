/* Where a number comes from: one panel at the side, with a breadcrumb from the number down to the rows. Its contents
   are those of views/opened.py. After dom.js. */

class TracePanel {
  /* place: an element; the panel is put into it and shown when something is opened. */
  constructor(place) {
    this.panel = element("aside", { class: "bh-trace" }, place);
    this.panel.hidden = true;
    this.panel.setAttribute("role", "region");
    this.panel.setAttribute("aria-label", "Where a number comes from");
    const head = element("div", { class: "head" }, this.panel);
    this.crumbs = element("ol", { class: "crumbs" }, element("nav", {}, head));
    this.crumbs.parentElement.setAttribute("aria-label", "Way down to the rows");
    const close = element("button", { class: "close" }, head, "Close");
    close.type = "button";
    close.addEventListener("click", () => this.close());
    this.body = element("div", { class: "body" }, this.panel);
    this.panel.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.close();
      event.stopPropagation(); // the keys of what lies behind rest
    });
  }

  close() {
    this.panel.hidden = true;
    if (this.from && this.from.isConnected) this.from.focus();
  }

  /* Show the last of some levels, each { title, fill(body) }. */
  show(levels) {
    const active = document.activeElement;
    if (this.panel.hidden || !this.panel.contains(active)) this.from = active;
    this.panel.hidden = false;
    this.crumbs.replaceChildren();
    levels.forEach(({ title }, i) => {
      const item = element("li", {}, this.crumbs), button = element("button", {}, item, title);
      button.type = "button";
      if (i === levels.length - 1) button.setAttribute("aria-current", "page");
      button.addEventListener("click", () => this.show(levels.slice(0, i + 1)));
    });
    this.body.replaceChildren();
    levels[levels.length - 1].fill(this.body);
    this.crumbs.lastElementChild.firstElementChild.focus();
  }

  /* An answer and one of its gaits; `sure` is the interval of each gait in words, null where nobody knows; `before` what it
     is an answer of, as { title, fill }. */
  open(opened, gait, sure, before = []) {
    const g = opened.gaits.indexOf(gait), product = (k) => opened.factors.reduce((all, values) => all * values[k], 1);
    const whole = opened.gaits.reduce((sum, _, k) => sum + product(k), 0), digits = (p) => String(Number(p.toPrecision(6)));
    const named = (v) => (v ? `${opened.variables[v]} ${opened.states[v]}` : "P(Gait)");
    const level = { title: `P(${gait})` };
    level.fill = (body) => {
      const parts = opened.factors.map((values) => digits(values[g])).join(" × ");
      element("p", { class: "formula" }, body, `P(${gait} | ${opened.variables.slice(1).join(", ")}) = ${parts} / ${digits(whole)} = ${digits(product(g) / whole)}`);
      if (sure) element("p", {}, body, `95 % interval ${sure[g]}`);
      const within = (v) => (opened.within ? [opened.within[v][g] || "set"] : []);
      this.table(body, ["factor", "P", ...(opened.within ? ["95 % interval"] : []), "rows"], opened.variables.map((_, v) => [
        v ? `P(${named(v)} | ${gait})` : "P(Gait)", digits(opened.factors[v][g]), ...within(v), opened.counts ? String(opened.counts[v][g]) : "unknown",
      ]), (v) => this.show([...before, level, this.cell(opened, v, g, named(v))]));
      element("p", {}, body, "Every gait:");
      const beside = (k) => (sure ? [sure[k]] : []);
      this.table(body, ["gait", "product", "share", ...(sure ? ["95 % interval"] : [])],
        opened.gaits.map((name, k) => [name, digits(product(k)), digits(product(k) / whole), ...beside(k)]),
        (k) => this.open(opened, opened.gaits[k], sure, before));
    };
    this.show([...before, level]);
  }

  /* A cell of a table: its count and, where they are held, its rows. */
  cell(opened, v, g, title) {
    return {
      title,
      fill: (body) => {
        const gait = opened.gaits[g], count = opened.counts && opened.counts[v][g];
        const total = opened.counts && opened.counts[0][g], p = String(Number(opened.factors[v][g].toPrecision(6)));
        element("p", { class: "formula" }, body, !opened.counts ? `${p}: given, nobody counted`
          : v ? `${p}: ${count} of ${total} rows of ${gait}` : `${p}: ${count} rows of ${gait}`);
        const within = opened.within && opened.within[v][g];
        if (within) element("p", {}, body, `95 % interval ${within}`);
        const rows = opened.rows && gait === opened.best ? opened.rows[v] : null;
        if (!rows) {
          const at = v ? `"${opened.variables[v]}", "${opened.states[v]}", "${gait}"` : `"Gait", "${gait}"`;
          if (opened.counts && count) element("p", {}, body, `The rows themselves are in the model: model.rows(${at}) in Python.`);
          return;
        }
        this.table(body, rows.columns, rows.lines);
        if (rows.count > rows.lines.length) element("p", {}, body, `and ${rows.count - rows.lines.length} more rows`);
      },
    };
  }

  /* A table; act(i), where given, is what a click on the first cell of a row does. */
  table(body, heads, lines, act) {
    const table = element("table", {}, body), row = element("tr", {}, element("thead", {}, table));
    for (const head of heads) element("th", {}, row, head).scope = "col";
    const rows = element("tbody", {}, table);
    lines.forEach((cells, i) => {
      const line = element("tr", {}, rows);
      cells.forEach((cell, k) => {
        const place = element(k ? "td" : "th", {}, line, !k && act ? undefined : cell);
        if (k) return;
        place.scope = "row";
        if (!act) return;
        const button = element("button", {}, place, cell);
        button.type = "button";
        button.addEventListener("click", () => act(i));
      });
    });
  }
}
