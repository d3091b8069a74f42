"""Reproduced beside reported, as people see it."""

import re

import matplotlib.pyplot as plt
import pytest
from matplotlib.patches import Polygon

import bayeshunt as bh
from bayeshunt.experiments.store.export import summary
from bayeshunt.views.figures.experiments import setup, success
from bayeshunt.views.pages.report import write_report
from bayeshunt.views.reported import p_text
from bayeshunt.views.terminal import terminal

SMALL = {"protocol.runs": 2, "model.babbling_steps": 400}


@pytest.fixture(scope="module")
def results():
    """A few hunts of preset oses2010, held against its published figures though they babble less."""
    published = bh.load_experiment("oses2010").published
    settings = bh.load_experiment("oses2010", SMALL).model_copy(update={"published": published})
    return bh.evaluate(settings, planners=["reactive", "prediction"], arenas=["walled"]), settings


@pytest.mark.parametrize(
    ("p", "text"), [(None, ""), (1.0, "1.00"), (0.316, "0.32"), (0.0618, "0.062"), (0.0017, "0.0017"), (1e-5, "<0.001")]
)
def test_p_values_in_words(p, text):
    assert p_text(p) == text


@pytest.mark.parametrize("per_theta", [False, True])
def test_the_table_shows_both_and_p(results, capsys, per_theta):
    terminal.success_table(summary(*results, 0), per_theta=per_theta)
    shown = capsys.readouterr().out
    assert re.search(r"paper % +p ", shown)
    assert re.search(r"reactive +walled +(all +)?\d+/14 .* 14\.6 +\d", shown)
    assert bool(re.search(r"reactive +walled +2 .* 2\.0 +1\.00", shown)) == per_theta
    flat = " ".join(shown.split())
    assert re.search(r"prediction, walled: mean time [\d.]+ s, the paper's 15.287 s: z -?[\d.]+, p [\d.]+;", flat)
    assert "the paper prints its 655 of 700 as 92.8 % (it is 93.57 %)." in flat
    assert "Fisher's exact test of the counts, z test of the mean times" in flat


def test_a_table_of_bare_shares_has_no_p(capsys):
    settings = bh.load_experiment("paper", {"protocol.thetas": [3.0], "protocol.runs": 1})
    settings = settings.model_copy(update={"published": bh.load_experiment("paper").published})
    frame = bh.evaluate(settings, planners=["reactive"], arenas=["walled"])
    terminal.success_table(summary(frame, settings, 0))
    shown = capsys.readouterr().out
    assert re.search(r"paper % +diff ", shown)
    assert "Fisher" not in shown


def test_figure_3_has_the_published_points_in(results):
    axes = success(*results, "reactive", "walled").axes[0]
    points = next(line for line in axes.lines if line.get_label() == "published, by bearing")
    assert list(points.get_ydata()) == [0, 100, 2, 0, 0, 0, 0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert any(re.match(r"published: 102/700 = 14\.6 %, p [\d.]+$", label) for label in labels)


def test_figure_4_has_the_published_total_and_time_in(results):
    axes = success(*results, "prediction", "walled").axes[0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert any(re.match(r"published: 655/700 = 93\.6 %, p [\d.]+, mean 15\.3 s$", label) for label in labels)
    assert "published, by bearing" not in labels


def test_the_arena_is_drawn_as_the_hunter_sees_it():
    """A start off the centre, facing along y: the arena's right wall is 0.3 m to the right of it."""
    given = {"protocol.hunter_x": 0.3, "protocol.hunter_theta": 1.5707963267948966, "arenas.walled.width": 1.8}
    figure = setup(bh.load_experiment("paper", given), "walled")
    (walls,) = (patch for patch in figure.axes[0].patches if isinstance(patch, Polygon))
    outline = walls.get_xy()
    assert outline[:, 0].max() == pytest.approx(600.0)
    assert outline[:, 0].min() == pytest.approx(-1200.0)
    assert outline[:, 1].max() == pytest.approx(600.0)
    plt.close(figure)


def test_the_report_shows_both(results, tmp_path):
    frame, settings = results
    frame.attrs["settings"] = settings.model_dump(mode="json")
    write_report(frame, tmp_path / "report.html")
    html = (tmp_path / "report.html").read_text()
    assert "655 of 700 as 92.8 % (it is 93.57 %)" in html
    assert html.count('class="published"') == 7
    assert "reactive, theta 2, published: 2.0%" in html
    assert '<th scope="col">p</th>' in html
