"""The figures: their numbers are the models' and the results', nothing overlaps, nothing is cut off."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from html_checks import NASTY
from matplotlib.collections import LineCollection
from matplotlib.text import Text
from PIL import Image

import bayeshunt as bh
from bayeshunt.views import figures, theme
from bayeshunt.views.figures import plans

SETTINGS = bh.load_experiment("paper")


@pytest.fixture(scope="module")
def results() -> pd.DataFrame:
    """Hunts as evaluate returns them: made up, 20 per bearing, with 0 and 20 catches among them."""
    caught = {0.0: 0, 1.0: 20, 2.0: 13, 3.0: 7, 4.0: 1, 5.0: 19, 6.0: 10}
    rows = [
        (planner, arena, theta, run, run, run < count, 12.5 if run < count else 60.0, 5, 1, 0.4)
        for planner, arena in (("reactive", "walled"), ("planning", "open"))
        for theta, count in caught.items()
        for run in range(20)
    ]
    columns = ["planner", "arena", "theta", "run", "seed", "caught", "time", "decisions", "transitions", "distance"]
    return pd.DataFrame(rows, columns=columns)


@pytest.fixture(scope="module")
def drawn(shown, results) -> dict:
    """Every figure of the paper, and the single panels."""
    last = shown.long.situations[-1]
    single = {
        "setup": figures.setup(SETTINGS, "walled"),
        "success": figures.success(results, SETTINGS, "planning", "open"),
        "prey_transition": figures.prey_transition(last.transitions[0], 0.057),
        "prey_table": figures.prey_table(last.prey_model),
        "without_rows": figures.gait_outcomes(shown.imported),
        "tree_network": figures.network(shown.tree),
        "joint_network": figures.network(shown.joint),
    }
    return {**dict(figures.paper_figures(shown.model, shown.episode, shown.long, results, SETTINGS)), **single}


NAMES = (
    "fig1b_network", "fig1c_gait_outcomes", "fig2_prey", "fig3_reactive_walled", "fig6b_planning_open",
    "fig5_search_tree", "fig6a_planning_step", "setup", "success", "prey_transition", "prey_table", "without_rows",
    "tree_network", "joint_network",
)  # fmt: skip


def texts(figure) -> list[tuple[str, object]]:
    """Every visible text with its extent in pixels."""
    figure.canvas.draw()
    found = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
    # Ticks outside the limits are kept by matplotlib but not drawn.
    drawn_ticks = {
        id(tick.label1) for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for tick in axis._update_ticks()
    }
    all_ticks = {
        id(tick.label1)
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks())
    }
    kept = [t for t in found if id(t) not in all_ticks or id(t) in drawn_ticks]
    return [(t.get_text(), t.get_window_extent()) for t in kept]


def check_room(figure) -> None:
    """No text overlaps another or is cut off by the edge of the figure."""
    found = texts(figure)
    assert len(found) > 5
    page = figure.bbox
    for text, box in found:
        assert page.x0 - 1 <= box.x0 and box.x1 <= page.x1 + 1, f"{text!r} is cut off"  # noqa: PT018
        assert page.y0 - 1 <= box.y0 and box.y1 <= page.y1 + 1, f"{text!r} is cut off"  # noqa: PT018
    for (one, a), (two, b) in itertools.combinations(found, 2):
        wide, tall = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        assert min(wide, tall) <= 1.0, f"{one!r} and {two!r} overlap"


def test_all_of_them_are_there(drawn) -> None:
    assert set(drawn) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_no_text_overlaps_another_or_the_edge(drawn, name: str) -> None:
    check_room(drawn[name])


@pytest.mark.parametrize("count", [1, 25, 90])
def test_any_number_of_gaits_has_room(khepera_frame, count: int) -> None:
    names = [f"gait number {i}" for i in range(count)]
    frame = khepera_frame.assign(gait=[names[i % count] for i in range(len(khepera_frame))])
    model = bh.ForwardModel.fit(frame, names)
    for figure in (figures.network(model), figures.gait_outcomes(model)):
        check_room(figure)
        assert set(names) <= {text for text, _ in texts(figure)}


def test_names_are_not_commands(nasty, results) -> None:
    table = results.assign(planner="planning").drop_duplicates(["planner", "arena", "theta", "run"])
    for name, figure in figures.paper_figures(nasty.model, nasty.planned, nasty.aimed, table, nasty.settings):
        found = [text for text, _ in texts(figure)]
        assert found, name
        assert not any("\x1b" in text or "\n" in text.strip() for text in found)
    outcomes = {text for text, _ in texts(figures.gait_outcomes(nasty.model))}
    assert "$\\frac{1}{" in outcomes
    assert NASTY[0][:17] in {text[:17] for text in outcomes}


def test_success_is_that_of_the_results(results) -> None:
    axes = figures.success(results, SETTINGS, "planning", "open").axes[0]
    bars = [patch.get_height() for patch in axes.patches]
    np.testing.assert_allclose(bars, np.array([0, 20, 13, 7, 1, 19, 10]) * 5)
    whiskers = next(c for c in axes.collections if isinstance(c, LineCollection)).get_segments()
    for segment, count in zip(whiskers, [0, 20, 13, 7, 1, 19, 10], strict=True):
        low, high = bh.wilson_interval(count, 20)
        np.testing.assert_allclose([segment[0][1], segment[1][1]], [100 * low, 100 * high], atol=1e-9)
    lines = {line.get_label(): line.get_ydata()[0] for line in axes.lines if not line.get_label().startswith("_")}
    assert lines == pytest.approx({"all: 70/140 = 50.0 % (41.8 to 58.2), mean 36.2 s": 50.0, "published: 84.4 %": 84.4})


def test_gait_outcomes_are_the_rows_or_the_cells(shown) -> None:
    axes = figures.gait_outcomes(shown.model).axes[0]
    dots = axes.collections[0].get_offsets()
    rows = shown.model.rows("Gait", "straight")
    np.testing.assert_allclose(dots[:, 0], rows["distance"] * np.sin(rows["angle"]) * 1000)
    np.testing.assert_allclose(dots[:, 1], rows["distance"] * np.cos(rows["angle"]) * 1000)
    loaded = bh.ForwardModel(shown.model.joint)
    dots = figures.gait_outcomes(loaded).axes[0].collections[0].get_offsets()
    assert len(dots) == (shown.model.joint.cells[:, 0] == 0).sum()


def test_the_network_figure_shows_the_marginals(shown) -> None:
    gait, *effects = figures.network(shown.model).axes
    prior = shown.model.probabilities("Gait")
    np.testing.assert_allclose([patch.get_width() for patch in gait.patches], prior)
    for axes, effect in zip(effects, ("Distance", "Angle", "Heading"), strict=True):
        heights = [patch.get_height() for patch in axes.patches]
        np.testing.assert_allclose(heights, shown.model.probabilities(effect) @ prior)


def test_the_tree_figure_has_every_node(shown) -> None:
    trace = shown.plan.trace
    axes = figures.search_tree(shown.plan).axes[0]
    edges, generated, expanded = axes.collections
    assert len(edges.get_segments()) == len(trace) - 1
    assert len(generated.get_offsets()) == (~trace["expanded"]).sum()
    assert len(expanded.get_offsets()) == trace["expanded"].sum()
    chosen = trace[trace["chosen"]].sort_values("T")
    np.testing.assert_allclose(axes.lines[0].get_ydata(), chosen["value_bodies"])


def test_the_planning_figure_shows_the_chosen_path(shown) -> None:
    axes = figures.planning_step(shown.plan).axes[0]
    chosen = shown.plan.trace[shown.plan.trace["chosen"]].sort_values("T")
    path = axes.lines[0].get_xydata() / 1000
    np.testing.assert_allclose(path, chosen[["hunter_right", "hunter_forward"]].to_numpy())
    assert plans._body_length(shown.plan.trace) == pytest.approx(0.057)


def test_plans_without_a_search_are_refused(shown) -> None:
    for draw in (figures.search_tree, figures.planning_step):
        with pytest.raises(bh.InputError, match="not made by a search"):
            draw(shown.aim)
    with pytest.raises(bh.InputError, match="holds no plans"):
        figures.instructive_plan(shown.loaded)


def test_wrong_names_are_refused(results) -> None:
    with pytest.raises(bh.InputError, match="no hunt of planner 'prediction' in arena 'open'"):
        figures.experiment(results, SETTINGS, "prediction", "open")
    with pytest.raises(bh.InputError, match="unknown arena 'moon'"):
        figures.setup(SETTINGS, "moon")


def test_files_are_readable_repeatable_and_large(drawn, tmp_path: Path) -> None:
    figure = drawn["fig6a_planning_step"]
    for folder in (tmp_path / "one", tmp_path / "two"):
        folder.mkdir()
        assert [path.name for path in figures.save(figure, folder, "plan")] == ["plan.png", "plan.svg"]
    with Image.open(tmp_path / "one" / "plan.png") as picture:
        assert min(picture.size) > 800
    assert ElementTree.parse(tmp_path / "one" / "plan.svg").getroot().tag.endswith("svg")
    for name in ("plan.png", "plan.svg"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_drawing_leaves_matplotlib_as_it_was(shown) -> None:
    before = dict(mpl.rcParams)
    figures.network(shown.model)
    assert dict(mpl.rcParams) == before


def test_gait_colours_differ_for_colour_blind_readers() -> None:
    """Ten colours stay apart (CIE 1976 distance over 20) as deuteranopes and protanopes see them."""
    for shade, matrix in itertools.product((0, 1), (np.eye(3), PROTAN, DEUTAN)):
        rgb = np.array([mpl.colors.to_rgb(pair[shade]) for side in theme.GAITS.values() for pair in side])
        lab = _lab(np.clip(_linear(rgb) @ matrix.T, 0, 1))
        gaps = [np.linalg.norm(a - b) for a, b in itertools.combinations(lab, 2)]
        assert min(gaps) > 20


# G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE TVCG 15 (2009): complete dichromacy.
PROTAN = np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]])
DEUTAN = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])


def _linear(srgb: np.ndarray) -> np.ndarray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _lab(linear: np.ndarray) -> np.ndarray:
    """CIE L*a*b* of linear sRGB, white point D65."""
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    xyz = linear @ to_xyz.T / (to_xyz.sum(axis=1))
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.column_stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])])


def test_outcomes_of_many_rows_stay_a_small_vector_file(khepera_frame, khepera_model, tmp_path) -> None:
    import pandas as pd

    many = bh.ForwardModel.fit(pd.concat([khepera_frame] * 5, ignore_index=True), khepera_model.gaits)
    _, path = figures.save(figures.gait_outcomes(many), tmp_path, "outcomes")
    assert path.suffix == ".svg"
    assert path.stat().st_size < 400_000


def test_a_long_prey_table_says_how_many_cells_it_shows() -> None:
    prey = bh.PreyModel()
    for i in range(60):
        prey.observe(bh.Polar(0.01 + 0.006 * (i % 40), 0.0, 0.0))
    figure = figures.prey_table(prey)
    assert figure.axes[0].get_title("left") == f"60 transitions, 24 of {len(prey.counts)} cells"
    check_room(figure)
