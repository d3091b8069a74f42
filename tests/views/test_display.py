"""What a notebook and a terminal show: valid, escaped, complete, and equal to the models' own numbers."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from html_checks import NASTY, Reader

import bayeshunt as bh
from bayeshunt.core import displays, units
from bayeshunt.views import grounds, theme
from bayeshunt.views.drawings import maps, network
from bayeshunt.views.notebook import html as display_html
from bayeshunt.views.sheets import models, sheet, tables

#: Elements that a display needs; none that runs code, loads anything or leaves the page.
ALLOWED = {
    "div", "span", "style", "dl", "dt", "dd", "details", "summary", "label", "input", "table", "thead", "tbody", "tr",
    "th", "td", "svg", "g", "rect", "circle", "polyline", "polygon", "path", "text", "title", "ol", "li", "p", "button",
}  # fmt: skip


def said(bin_name: str) -> str:
    """A bin as pages write it: "−10°" for "-10 deg"."""
    return units.true_minus(units.label(bin_name))


def check(html: str) -> Reader:
    """Read a display and check that it cannot do anything but be looked at."""
    page = Reader(html)
    for element in page.elements:
        assert element["tag"] in ALLOWED, element["tag"]
        for name, value in element["attributes"].items():
            assert not name.startswith("on"), name
            assert name not in ("href", "src", "action", "srcset"), name
            assert name == "xmlns" or "://" not in (value or ""), value
            assert name != "style" or re.fullmatch(r"[a-z0-9.%:;\-]+", value), value
    panels = {e["attributes"]["id"] for e in page.find("div", "bh-side")}
    for button in page.find("button"):  # all that one does is to open or close a panel of the same card
        assert button["attributes"]["type"] == "button"
        assert button["attributes"]["popovertarget"] in panels
    for style in page.find("style"):
        assert "@import" not in style["text"]
        assert "url(" not in style["text"]
    return page


def switches(page: Reader) -> list[dict]:
    return [e for e in page.find("input") if e["attributes"]["type"] == "checkbox"]


# --- everything ------------------------------------------------------------------------------------


def test_html_is_a_plain_text_as_every_notebook_takes_it(thing) -> None:
    assert type(thing._repr_html_()) is str  # marimo shows nothing for a subclass


def test_html_is_valid_and_harmless(thing) -> None:
    page = check(thing._repr_html_())
    assert page.find("div", "bh-title")[0]["text"].strip()
    for row in page.find("tr"):
        assert row["parents"][-1] in ("thead", "tbody")
    for cell in page.find("td"):
        assert cell["parents"][-1] == "tr"
    for drawing in page.find("svg"):
        size = [float(n) for n in drawing["attributes"]["viewbox"].split()]
        assert len(size) == 4
        assert min(size[2:]) > 0


def test_rows_of_a_table_have_as_many_cells_as_its_head(thing) -> None:
    html = thing._repr_html_()
    for table in re.findall(r"<table.*?</table>", html, re.S):
        widths = {len(re.findall(r"<t[hd][ >]", row)) for row in re.findall(r"<tr.*?</tr>", table, re.S)}
        assert len(widths) == 1, widths


def test_text_form_reads_well(thing) -> None:
    text = str(thing)
    lines = text.splitlines()
    assert len(lines) >= 2
    assert max(map(len, lines)) <= 140
    assert all(line == line.rstrip() for line in lines)
    assert "object at 0x" not in text
    assert "nan" not in text
    assert len(repr(thing)) < 160
    assert "\n" not in repr(thing)


def test_nothing_draws_without_a_drawer(shown) -> None:
    try:
        displays.arrange(None)
        assert shown.model._repr_html_() is None
        assert str(shown.plan) == repr(shown.plan)
    finally:
        displays.arrange("bayeshunt.views.notebook.display")
    assert shown.model._repr_html_()


def test_strangers_are_refused() -> None:
    with pytest.raises(TypeError, match="draws or prints a int"):
        displays.to_html(3)
    with pytest.raises(TypeError, match="draws or prints a int"):
        displays.to_text(3)


# --- escaping --------------------------------------------------------------------------------------


def test_no_name_becomes_code(nasty) -> None:
    for thing in nasty.things:
        check(thing._repr_html_())


def test_names_are_shown_as_they_are(nasty) -> None:
    page = check(nasty.model._repr_html_())
    heads = {e["text"] for e in page.find("th")}
    assert set(NASTY) <= heads


def test_terminals_obey_no_name(nasty) -> None:
    for thing in nasty.things:
        text = str(thing)
        assert "\x1b" not in text
        assert all(c == "\n" or c.isprintable() for c in text)


def test_tags_escape_text_and_attributes() -> None:
    html = display_html.tag("td", "<b>", title='"<&', open=True, hidden=None)
    assert html == '<td title="&quot;&lt;&amp;" open>&lt;b&gt;</td>'
    assert display_html.tag("p", html) == f"<p>{html}</p>"


# --- tables ----------------------------------------------------------------------------------------

HINT = re.compile(
    r"P\((?P<bin>.*?) \| (?P<gait>.*)\) = (?P<p>[\d.]+), 95 % interval (?P<low>[\d.]+) to (?P<high>[\d.]+), "
    r"(?P<n>\d+) of (?P<total>\d+) rows"
)


def test_every_cell_carries_its_count_and_interval(shown) -> None:
    table = shown.table
    page = check(table._repr_html_())
    cells = page.find("td")
    assert len(cells) == table.probability.size
    for cell, (row, column) in zip(cells, np.ndindex(table.probability.shape), strict=True):
        told = HINT.fullmatch(cell["attributes"]["title"])
        assert told["bin"] == f"Angle = {said(table.probability.index[row])}"
        assert told["gait"] == table.probability.columns[column]
        for name, frame in (("p", table.probability), ("low", table.low), ("high", table.high)):
            assert float(told[name]) == pytest.approx(frame.iloc[row, column], abs=5.1e-5)
        assert int(told["n"]) == table.count.iloc[row, column]
        assert int(told["total"]) == table.count.iloc[:, column].sum()


def test_every_cell_that_holds_something_can_be_picked_by_keyboard_and_by_a_click(shown) -> None:
    """A group of radio buttons has one tab stop and roving arrow keys by itself."""
    for table in (shown.table, shown.imported_table, shown.gait_table):
        page = check(table._repr_html_())
        choices = [e["attributes"] for e in page.find("input") if e["attributes"]["type"] == "radio"]
        held = table.probability.to_numpy() > 0
        assert len(choices) == held.sum() > 0
        assert len({choice["name"] for choice in choices}) == 1
        titles = [cell["attributes"]["title"] for cell in page.find("td")]
        assert [c["aria-label"] for c in choices] == [t for t, h in zip(titles, held.ravel(), strict=True) if h]
    names = {e["attributes"].get("name") for e in check(shown.model._repr_html_()).find("input")} - {None}
    assert len(names) == 4  # a group a table
    assert shown.table._repr_html_() == shown.table._repr_html_()


def panels(page: Reader) -> dict[str, str]:
    """The words of each panel, by the label of what opens it: the last words on the button, or its name."""
    said = {e["attributes"]["id"]: e["text"] for e in page.find("div", "bh-side")}
    buttons = [e for e in page.find("button") if "bh-side" not in str(e["parents"]) and e["text"] != "×"]
    return {e["attributes"].get("aria-label") or e["text"]: said[e["attributes"]["popovertarget"]] for e in buttons}


def test_a_cell_of_a_table_opens_its_rule_interval_and_rows(shown) -> None:
    for model in (shown.model, shown.tree):
        table = model.table("Angle")
        opened = panels(check(table._repr_html_()))
        counts = table.count.to_numpy()
        for i, j in np.argwhere(counts > 0).tolist():
            state, gait = table.count.index[i], table.count.columns[j]
            words = opened[f"Rows of P(Angle = {said(state)} | {gait})"]
            found = bh.trace(model, cell=("Angle", state, gait))
            assert units.true_minus(found.formula.replace(state, units.label(state))) in words
            low, high = table.low.iat[i, j], table.high.iat[i, j]
            assert f"95 % interval {low:.3f} to {high:.3f}" in words
            assert f"{counts[i, j]} of {counts[:, j].sum()} rows: distance, angle, heading" in words
            rows = found.rows()
            label, distance = rows.index[0], rows["distance"].iloc[0]
            assert f"{label}{units.length(distance)}, {units.true_minus(units.degrees(rows['angle'].iloc[0]))}" in words
        assert "Rows of P(Angle = 90° | straight)" not in opened  # nothing fell there
    gait = shown.model.gaits.names[0]
    words = panels(check(shown.model.table("Gait")._repr_html_()))[f"Rows of P({gait})"]
    assert "set, as in the paper; 40 rows" in words
    assert panels(check(shown.imported_table._repr_html_())) == {}


def test_of_very_many_cells_the_fullest_open(shown, monkeypatch) -> None:
    monkeypatch.setattr(tables, "_MOST_OPEN", 7)
    table = shown.model.table("Angle")
    page = check(table._repr_html_())
    said_of = [e["text"] for e in page.find("div", "bh-side")]
    counted = [int(re.search(r"interval 0.\d{3} to [01].\d{3}(\d+) of", text).group(1)) for text in said_of]
    assert counted == sorted(table.count.to_numpy().ravel(), reverse=True)[:7]


def test_a_row_of_the_prey_table_opens(shown) -> None:
    page = check(shown.prey._repr_html_())
    frame = shown.prey.cpt().sort_values("count", ascending=False, kind="stable")
    words = [e["text"] for e in page.find("div", "bh-side")]
    assert len(words) == len(frame)
    for text, (labels, row) in zip(words, frame.iterrows(), strict=True):
        count, total = int(row["count"]), shown.prey.observations
        assert ", ".join(map(said, labels)) in text
        assert f"P = {count} / {total} = {count / total:.4g}" in text
        assert f"95 % interval {row['low']:.3f} to {row['high']:.3f}" in text


def test_a_gait_of_the_energy_table_opens() -> None:
    robot = bh.load_robot("hexapod")
    model = bh.ForwardModel.fit(bh.babble(robot, 40, 0), robot.gaits, 0.1)
    opened = panels(check(model._repr_html_()))
    for name in robot.gaits.names:
        own = model.rows("Gait", name)
        cost = model.energy(name).iloc[0]
        assert (
            f"{cost['mean_j']:.3g} J, the mean of {'one row' if len(own) == 1 else f'{len(own)} rows'}" in opened[name]
        )
        assert f"{own['energy'].iloc[0]:.3g} J" in opened[name]


def test_a_table_says_what_it_sums_over(shown) -> None:
    table = shown.tree.table("Angle")
    others = [p for p in shown.tree.structure.parents("Angle") if p != "Gait"]
    angle = f"P(Angle | Gait), summed over {others[0]}" if others else "P(Angle | Gait)"
    assert any(shown.tree.table(e).summed_over for e in ("Distance", "Angle", "Heading"))
    for text in (table._repr_html_(), str(table), repr(table), shown.tree._repr_html_()):
        assert angle in text
    assert table.name == "P(Angle | Gait)"
    assert shown.table.title == shown.table.name


def test_a_gait_prior_that_is_set_shows_counts_alone(shown) -> None:
    page = check(shown.gait_table._repr_html_())
    assert len(switches(page)) == 1
    assert not page.find("span", "bh-i")
    counts = shown.gait_table.count["count"]
    assert [e["text"] for e in page.find("span", "bh-n")] == [str(n) for n in counts]
    titles = [cell["attributes"]["title"] for cell in page.find("td")]
    assert titles[0] == f"P({counts.index[0]}) = 0.1000, {counts.iloc[0]} of {counts.sum()} rows"
    assert not any("interval" in title for title in titles)


def test_the_switches_show_counts_and_intervals(shown) -> None:
    page = check(shown.table._repr_html_())
    assert len(switches(page)) == 2
    intervals = [e["text"].split(" to ") for e in page.find("span", "bh-i")]
    limits = zip(shown.table.low.to_numpy().ravel(), shown.table.high.to_numpy().ravel(), strict=True)
    for written, bounds in zip(intervals, limits, strict=True):
        assert [float(text) for text in written] == pytest.approx(bounds, abs=5.1e-4)
    counts = [e["text"] for e in page.find("span", "bh-n")]
    expected = ["·" if n == 0 else str(n) for n in shown.table.count.to_numpy().ravel()]
    assert counts == expected
    sheet = page.find("style")[0]["text"]
    assert ".bh-table:has(.bh-switch input:checked) .bh-n{display:inline}" in sheet


def test_darker_cells_are_likelier(shown) -> None:
    page = check(shown.table._repr_html_())
    shades = [float((c["attributes"].get("style") or "--p:0").removeprefix("--p:")) for c in page.find("td")]
    values = shown.table.probability.to_numpy().ravel()
    order = np.argsort(values, kind="stable")
    assert np.all(np.diff(np.array(shades)[order]) >= -0.011)
    assert max(shades) == 1.0


def test_long_tables_show_the_likeliest_bins(khepera_frame, khepera_model) -> None:
    axes = bh.EffectAxes.standard(0.057, angle_bins=720)
    table = bh.ForwardModel.fit(khepera_frame, khepera_model.gaits, axes=axes).table("Angle")
    page = check(table._repr_html_())
    assert len(page.find("tr")) == tables.MOST_ROWS + 1
    assert f"{720 - tables.MOST_ROWS} bins are not shown" in page.text
    kept = [e["text"] for e in page.find("th") if e["attributes"]["scope"] == "row"]
    seen = table.count.index[table.count.to_numpy().any(axis=1)]
    assert set(map(said, seen)) <= set(kept)
    assert kept == [label for label in map(said, table.count.index) if label in set(kept)]


def test_headers_stick_and_tables_scroll() -> None:
    sheet = theme.style()
    assert re.search(r"\.bh thead th\{position:sticky;top:0", sheet)
    assert re.search(r"\.bh tbody th\{position:sticky;left:0", sheet)
    assert re.search(r"\.bh \.bh-scroll\{overflow:auto;max-height", sheet)


# --- models and answers ----------------------------------------------------------------------------


def test_network_shows_the_marginals(shown) -> None:
    page = check(network.network(shown.model))
    prior = shown.model.probabilities("Gait")
    titles = [e["text"] for e in page.find("title")]
    for name, share in zip(shown.model.gaits.names, prior, strict=True):
        assert f"{name}: {share:.4g}" in titles
    for effect in ("Distance", "Angle", "Heading"):
        marginal = shown.model.probabilities(effect) @ prior
        for label, share in zip(shown.model.axes[effect].labels, marginal, strict=True):
            assert (f"{effect} {said(label)}: {share:.4g}" in titles) == (share > 0)


def test_posterior_of_the_heading_is_that_of_the_engine(shown) -> None:
    from pgmpy.inference import VariableElimination

    for model in (shown.model, shown.joint):
        answer = bh.InverseModel(model).posterior(0.15, 0.4)
        ours = network.posteriors(answer)["Heading"]
        engine = VariableElimination(model.network).query(["Heading"], evidence=answer.evidence, show_progress=False)
        theirs = [engine.get_value(Heading=label) for label in model.axes.heading.labels]
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12)


def test_edges_among_effects_are_drawn(shown) -> None:
    def arrows(model) -> int:
        return len(check(network.network(model)).find("polygon"))

    for model in (shown.model, shown.tree, shown.joint):
        assert arrows(model) == 2 * len(model.structure.edges)  # beside each other, and stacked for a phone


def test_answers_show_what_they_rest_on(shown) -> None:
    for answer in (shown.answer, shown.snapped):
        page = check(answer._repr_html_())
        for part in (*map(units.label, answer.evidence.values()), f"{answer.support} babbling rows"):
            assert units.true_minus(part) in page.text
            assert part in str(answer)
        assert f"{answer.evidence_probability:.6g}" in page.text
        assert f"{answer.evidence_probability:.6g}" in str(answer)
        lit = [e["text"] for e in page.find("tr", "bh-lit")]
        assert lit
        assert all(text.startswith(answer.best) for text in lit)


IMPORTED = ("imported", "imported_inverse", "imported_answer", "imported_table", "imported_aim", "imported_hunt")


@pytest.mark.parametrize("name", IMPORTED)
def test_no_display_of_an_import_pretends_to_counts(shown, name: str) -> None:
    thing = getattr(shown, name)
    page = check(thing._repr_html_())
    hints = (e["attributes"].get(name) or "" for e in page.elements for name in ("title", "data-hint"))
    seen = " ".join([page.text, *hints, str(thing), repr(thing)])
    assert not re.search(r"\d rows|\d babbl|babbling rows|babbled|None|<NA>|nan|interval\b|learned coordinate", seen)
    assert not switches(page)  # none to counts
    assert not page.find("span", "bh-n")


def test_what_is_unknown_of_an_import_is_said(shown) -> None:
    for name, words in {
        "imported_answer": "unknown: an imported network carries no counts",
        "imported_table": "no counts",
        "imported_aim": "unknown",
    }.items():
        thing = getattr(shown, name)
        assert words in check(thing._repr_html_()).text
        assert words in str(thing) or name == "imported_table"
    hints = [e["text"] for e in check(shown.imported_inverse._repr_html_()).find("title")]
    assert sum(hint.endswith("support unknown") for hint in hints) == len(shown.imported_inverse.table())
    assert shown.imported_answer.snapped
    assert "has probability 0" in str(shown.imported_answer)


def test_one_row_is_one_row() -> None:
    assert [grounds.rows(n) for n in (0, 1, 2, None)] == [
        "0 babbling rows", "1 babbling row", "2 babbling rows", "unknown"
    ]  # fmt: skip


def test_snapping_is_said(shown) -> None:
    assert shown.snapped.snapped
    assert "never babbled" in shown.snapped._repr_html_()
    exact = shown.inverse.posterior(*shown.inverse.posterior(0.15, 0.4).cell[2:4])
    assert not exact.snapped
    assert "never babbled" not in exact._repr_html_()


def test_a_target_out_of_reach_is_said(shown) -> None:
    for inverse, words in ((shown.inverse, "no gait ever went"), (shown.imported_inverse, "no gait goes")):
        far = inverse.posterior(16, -0.0)
        for text in (str(far), check(far._repr_html_()).text):
            assert words in text
            assert "16 m, 0°" in text
            assert f"{far.gap:.1f} m away" in text
        own = inverse.posterior(*far.cell[2:4])
        assert "out of reach" not in str(own) + own._repr_html_()


def test_a_bar_is_as_long_as_its_probability(shown) -> None:
    page = check(shown.answer._repr_html_())
    widths = [float(e["attributes"]["style"][6:-1]) for e in page.find("span", "bh-bar")]
    values = shown.answer.values
    drawn = np.array([float(f"{p:.4f}") > 0 for p in values])
    np.testing.assert_allclose(widths, 100 * values[drawn] / values.max(), atol=0.06)


def test_what_is_printed_as_zero_has_no_bar() -> None:
    page = Reader(sheet.Bars({"much": 0.99996, "little": 0.00004}).html())
    assert "0.0000" in page.text
    assert len(page.find("span", "bh-bar")) == 1


def test_explanation_is_the_answers_own(shown) -> None:
    page = check(shown.answer._repr_html_())
    frame = shown.answer.explain()
    for gait, row in frame.iterrows():
        numbers = "".join(display_html.number(row[c]) for c in ("prior", "Distance", "Angle", "log_odds"))
        assert any(e["text"] == f"{gait}{row['reference']}{numbers}" for e in page.find("tr"))


def test_prey_table_lists_every_cell(shown) -> None:
    page = check(shown.prey._repr_html_())
    rows = [e["text"] for e in page.find("tr")][1:]
    frame = shown.prey.cpt()
    assert len(rows) == len(frame)
    for labels, row in frame.iterrows():
        numbers = f"{row['probability']:.3f}{int(row['count'])}{row['low']:.3f} to {row['high']:.3f}"
        want = "".join(map(said, labels)) + numbers
        assert want in rows
    assert "Nothing observed" in shown.no_prey._repr_html_()


def test_nothing_counted_is_said(shown) -> None:
    assert "Nothing to show yet" in shown.empty._repr_html_()
    assert "Nothing to show yet" in str(shown.empty)


# --- plans and hunts -------------------------------------------------------------------------------


def test_the_chosen_branch_is_lit_and_open(shown) -> None:
    trace = shown.plan.trace
    page = check(shown.plan._repr_html_())
    lit = [e["text"] for e in page.find("span", "bh-lit")]
    branch = trace[trace["chosen"]].sort_values("T")
    assert len(lit) == len(branch)
    for text, row in zip(lit, branch.to_dict("records"), strict=True):
        assert (row["gait"] or "now") in text
        assert f"{display_html.number(1000 * row['value_m'])} mm" in text
    unfolded = [e for e in page.find("details") if "open" in e["attributes"]]
    inner = [row for row in branch.to_dict("records") if row["expanded"]]
    assert len(unfolded) == 1 + len(inner)  # the fold around the tree, and every inner node of the branch


def test_every_node_can_be_walked_to(shown) -> None:
    page = check(shown.plan._repr_html_())
    nodes = page.find("details")[1:] + [e for e in page.find("div", "bh-leaf") if "worse" not in e["text"]]
    families = shown.plan.trace.groupby("parent").size()
    assert families.max() <= 12  # so none is cut here
    assert len(nodes) == len(shown.plan.trace)


def test_a_plan_without_a_tree_shows_its_posterior(shown) -> None:
    page = check(shown.aim._repr_html_())
    rows = [e["text"] for e in page.find("tr")][1:]
    ends = zip(*shown.aim.answer.interval()[["low", "high"]].to_numpy().T, strict=True)
    for gait, share, (low, high) in zip(shown.aim.trace["gait"], shown.aim.posterior, ends, strict=True):
        assert f"{gait}{share:.4f} ({units.bounds(low, high)})" in rows


def test_other_traces_are_shown_as_they_are(shown) -> None:
    import pandas as pd

    trace = pd.DataFrame({"option": ["<a>", "b"], "cost": [0.5, math.inf], "chosen": [True, False]})
    plan = bh.Plan(gait="a", gaits=("a",), value=1.0, objective="cost", nodes=2, make_trace=lambda: trace)
    page = check(plan._repr_html_())
    assert page.find("tr", "bh-lit")[0]["text"].startswith("<a>")


@pytest.mark.parametrize("planner", ["intercept", "pure_pursuit"])
def test_plans_of_other_planners(khepera_model, planner: str) -> None:
    hunt = bh.hunt("paper", bh.make_planner(planner, khepera_model), arena="open", theta=2.0, seed=1)
    plan = hunt.plans[1]
    page = check(plan._repr_html_())
    assert page.find("span", "bh-lit") or page.find("tr", "bh-lit")
    assert plan.gait in str(plan)
    if planner == "intercept":
        first = plan.trace[plan.trace["chosen"] & (plan.trace["T"] == 1)].iloc[0]
        told = f"{display_html.number(first['value_s'])} s"
        assert any(first["gait"] in e["text"] and told in e["text"] for e in page.find("span", "bh-lit"))
        assert f"* {first['gait']}  {first['value_s']:.2f} s" in str(plan)


def test_a_hunt_shows_every_decision(shown) -> None:
    for episode in (shown.episode, shown.long, shown.loaded):
        page = check(episode._repr_html_())
        rows = page.find("tr")[1:]
        assert len(rows) == len(episode.frame)
        for row, gait in zip(rows, episode.frame["gait"], strict=True):
            assert gait in row["text"]
        ending = "caught after" if episode.caught else "not caught"
        assert ending in page.text
        assert ending in str(episode)
    assert str(shown.loaded) == str(shown.episode)


def test_walls_are_drawn_where_there_are_walls(shown) -> None:
    assert len(check(shown.long._repr_html_()).find("rect")) == 1
    assert not check(shown.episode._repr_html_()).find("rect")


# --- small pieces ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "·"), (0.0004, "<.001"), (0.25, ".250"), (1.0, "1.000")],
)
def test_probabilities_are_short(value: float, text: str) -> None:
    assert display_html.probability(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (math.nan, "-"), (math.inf, "∞"), (-math.inf, "−∞"), (-0.5, "−0.5"), (1234.5, "1.23e+03")],
)
def test_numbers_are_short(value: float | None, text: str) -> None:
    assert display_html.number(value) == text


def test_sparks_show_whatever_is_not_zero() -> None:
    assert models.spark(np.array([0.0, 1e-9, 0.5, 1.0]), 4) == " ▁▄█"
    assert models.spark(np.zeros(5), 3) == "   "
    assert len(models.spark(np.ones(100), 12)) == 12


def test_themes_follow_the_system_and_the_notebook() -> None:
    sheet = theme.style()
    assert "@media (prefers-color-scheme:dark)" in sheet
    for light, dark in theme.COLOURS.values():
        assert light in sheet
        assert dark in sheet
    assert sheet.index("prefers-color-scheme") < sheet.index('data-jp-theme-light="true"')


@pytest.mark.parametrize(("name", "robots"), [("omniscient", None), ("constant_velocity", 0), ("pure_pursuit", 1)])
def test_a_pose_without_a_heading_has_no_nose(khepera_model, name, robots) -> None:
    """Where only places are predicted discs are drawn, and a point aimed at is not drawn as the prey."""
    plan = bh.hunt("paper", bh.make_planner(name, khepera_model), arena="open", theta=2.0, seed=1).plans[1]
    drawing = str(maps.plan_map(plan))
    assert "nan" not in drawing
    if robots is None:  # the prey now, which is seen, and its places ahead
        discs = re.findall(r"<circle[^>]*><title>prey, (\d+) ahead", drawing)
        assert discs == [str(step) for step in range(1, len(plan.gaits) + 1)]
        robots = 1
    assert len(re.findall(r"<polygon[^>]*><title>prey, ", drawing)) == robots
    assert len(re.findall("<title>target", drawing)) == 1


def test_the_card_of_an_inverse_model_stays_small_however_wide_its_tables() -> None:
    """Neighbouring coordinates share a sector; every one of them is still counted in the words."""
    import pandas as pd

    distances, angles = np.meshgrid((np.arange(640) + 0.5) * 0.001, (np.arange(36) - 17) * math.tau / 36)
    count = distances.size
    gaits = np.where(angles.ravel() < 0, "left", "right")
    frame = pd.DataFrame({"gait": gaits, "distance": distances.ravel(), "angle": angles.ravel(), "heading": 0.0})
    axes = bh.EffectAxes.standard(0.01)
    inverse = bh.InverseModel(bh.ForwardModel.fit(frame, ["left", "right"], axes=axes))
    html = inverse._repr_html_()
    page = check(html)
    assert count == len(inverse.table()) == 23_040
    assert len(html.encode()) < 500_000
    hints = [e["text"] for e in page.find("title")]
    assert sum(int(found.group(1)) for hint in hints if (found := re.search(r"of (\d+) coordinates", hint))) == count
    assert 400 < len(hints) <= 1502


def test_the_card_of_a_table_stays_small_however_wide_it_is() -> None:
    """A prior gives every bin its share: neighbours share a box of the strips, the likeliest bins stand below."""
    import pandas as pd

    frame = pd.DataFrame({"gait": ["a", "b"], "distance": [0.2, 20.0], "angle": 0.0, "heading": 0.0})
    with pytest.warns(bh.DataWarning, match="makes 20,000 distance bins"):
        model = bh.ForwardModel.fit(frame, ["a", "b"], 0.1, axes=bh.EffectAxes.standard(0.01))
    table = model.table("Distance")
    assert table.probability.shape == (20_001, 2)
    html = table._repr_html_()
    page = check(html)
    assert len(html.encode()) < 200_000
    kept = [e["text"] for e in page.find("th") if e["attributes"]["scope"] == "row"]
    assert len(kept) == 50
    assert set(map(said, table.count.index[table.count.to_numpy().any(axis=1)])) <= set(kept)
    strips = html.split("Where each column has its weight")[1].split("</div>")[0]
    darkest = [max(re.findall(r'<rect x="(\d+)"[^>]*fill-opacity="1.00"', strip)) for strip in strips.split("<svg")[1:]]
    assert darkest == ["4", "487"]  # of 488 boxes of 41 bins each


def test_every_coordinate_is_drawn_where_there_are_few(shown) -> None:
    hints = [e["text"] for e in check(maps.inverse_map(shown.inverse)).find("title")]
    assert len(hints) == len(shown.inverse.table()) + 1


def test_text_and_html_of_a_thing_come_from_the_same_facts(thing) -> None:
    from bayeshunt.views.notebook import display

    made = display.sheet(thing)
    text, html = str(thing), check(thing._repr_html_())
    named = {e["text"] for e in html.find("dt")}
    for name, value in made.pairs:
        assert name in named
        assert units.true_minus(str(value)) in html.text
        assert any(line.startswith(f"{name}  ") for line in text.splitlines()), name


def test_text_draws_nothing_and_html_prints_nothing(shown, monkeypatch) -> None:
    """A robot that prints its plans pays for no picture."""

    def fails(*_):
        raise AssertionError("drawn")

    for place in (maps, network):
        for name in ("plan_map", "episode_map", "inverse_map", "network"):
            monkeypatch.setattr(place, name, fails, raising=False)
    for thing in (shown.plan, shown.episode, shown.inverse, shown.answer, shown.model):
        assert str(thing)


def test_bins_that_nothing_fell_into_take_no_room_and_every_column_is_seen_at_once(khepera_model):
    table = khepera_model.table("Distance")
    html = table._repr_html_()
    counts = table.count.to_numpy().sum(axis=1)
    assert html.count('class="bh-none"') == (counts == 0).sum() > 0
    assert "Where each column has its weight" in html
    strips = html.split("Where each column has its weight")[1].split("</div>")[0]
    assert strips.count("<span") == strips.count("<svg") == len(table.probability.columns)


def test_an_unsure_coordinate_is_pale_in_the_inverse_map(khepera_model):
    inverse = bh.InverseModel(khepera_model)
    html = inverse._repr_html_()
    shown = []
    for path in re.findall(r"<path.*?</path>", html):
        ends = re.search(r"interval ([\d.]+) to ([\d.]+)", path)
        if ends:
            shown.append((re.search(r'fill-opacity="([\d.]+)"', path).group(1), *ends.groups()))
    assert len(shown) >= 5
    for strength, low, high in shown:
        assert float(strength) == pytest.approx(0.15 + 0.85 * (1 - (float(high) - float(low))), abs=0.02)
