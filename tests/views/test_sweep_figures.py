"""Figures of sweeps and trade-offs: every planner and every point is in them."""

from __future__ import annotations

from itertools import pairwise

import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from bayeshunt.core.errors import InputError
from bayeshunt.views.figures.style import save
from bayeshunt.views.figures.sweep import sweep_figure
from bayeshunt.views.figures.tradeoff import tradeoff_figure


def a_sweep(values, planners=("planning", "kinematic_limit"), arenas=("open",), **others) -> pd.DataFrame:
    rows = [
        {"speed_ratio": value, **others, "planner": planner, "arena": arena, "runs": 7, "caught": 4,
         "success": 0.5, "ci_low": 0.3, "ci_high": 0.7, "mean_time_s": 30.0 + value}
        for arena in arenas for value in values for planner in planners
    ]  # fmt: skip
    return pd.DataFrame(rows)


def test_every_planner_is_drawn_and_named():
    figure = sweep_figure(a_sweep([0.5, 0.9, 1.2], arenas=("open", "walled")))
    assert len(figure.axes) == 4
    assert [axes.get_title() or axes.get_title("left") for axes in figure.axes[:2]] == ["open", "walled"]
    top, bottom = figure.axes[0], figure.axes[2]
    assert [line.get_label() for line in top.lines] == ["planning", "kinematic limit"]
    assert top.lines[0].get_xdata().tolist() == [0.5, 0.9, 1.2]
    assert bottom.lines[0].get_ydata().tolist() == [30.5, 30.9, 31.2]
    assert bottom.get_xlabel() == "prey speed / hunter's top speed"
    assert len(top.collections) == 1  # an interval for the planner, none for the limit


def test_other_axes_make_panels_and_too_many_are_refused():
    frame = pd.concat([a_sweep([0.5], noise=noise) for noise in (0.0, 1.0)])
    frame = frame[["speed_ratio", "noise", *[c for c in frame if c not in ("speed_ratio", "noise")]]]
    figure = sweep_figure(frame)
    assert [axes.get_title("left") for axes in figure.axes[:2]] == ["open, noise = 0.0", "open, noise = 1.0"]
    with pytest.raises(InputError, match="7 panels are too many"):
        sweep_figure(a_sweep([1.0], arenas=tuple("abcdefg")))


def test_values_may_be_lists():
    frame = pd.concat([a_sweep([0.5, 0.9]).assign(thetas=[[theta]] * 4) for theta in (1.0, 2.0)])
    figure = sweep_figure(frame)
    assert [axes.get_title("left") for axes in figure.axes[:2]] == ["open, thetas = [1.0]", "open, thetas = [2.0]"]
    figure = sweep_figure(frame.drop(columns="thetas").assign(speed_ratio=[[1], [1], [2], [2]] * 2))
    assert [label.get_text() for label in figure.axes[1].get_xticklabels()] == ["[1]", "[2]"]


def test_values_that_are_no_numbers_keep_their_order():
    frame = a_sweep([0.5, 0.9], planners=("planning",))
    frame["speed_ratio"] = ["straight", "evader"]
    figure = sweep_figure(frame)
    assert [label.get_text() for label in figure.axes[1].get_xticklabels()] == ["straight", "evader"]


def test_the_files_are_the_same_twice(tmp_path):
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        paths = save(sweep_figure(a_sweep([0.5, 0.9])), tmp_path / folder, "sweep")
    assert [path.suffix for path in paths] == [".png", ".svg"]
    for path in paths:
        assert path.read_bytes() == (tmp_path / "one" / path.name).read_bytes()


def test_a_tradeoff_joins_the_values_of_a_weight():
    rows = [
        ("planning", "", float("nan"), 5.0),
        ("frugal", "transitions", 0.0, 2.0),
        ("frugal", "transitions", 9.0, 1.0),
    ]
    frame = pd.DataFrame(
        [{"planner": p, "weight": w, "value": v, "mean_transitions": m, "mean_distance_m": m / 2, "mean_time_s": 20 + m}
         for p, w, v, m in rows]
    )  # fmt: skip
    frame.attrs["arena"] = "open"
    left, right = tradeoff_figure(frame).axes
    assert [line.get_label() for line in left.lines] == ["planning", "frugal, price of transitions"]
    assert left.lines[1].get_xdata().tolist() == [2.0, 1.0]
    assert right.lines[1].get_xdata().tolist() == [1.0, 0.5]
    assert [text.get_text() for text in left.texts] == ["0", "9"]


def test_a_tradeoff_labels_both_ends_of_every_curve():
    frame = pd.DataFrame(
        [{"planner": "frugal", "weight": w, "value": v, "mean_transitions": m, "mean_distance_m": m, "mean_time_s": 2.0}
         for w, v, m in [("transitions", 0.0, 5.0), ("transitions", 1.0, 4.9), ("transitions", 7.0, 4.8),
                         ("distance", 0.0, 5.0), ("distance", 100.0, 5.0)]]
    )  # fmt: skip
    texts = tradeoff_figure(frame).axes[0].texts
    assert [text.get_text() for text in texts] == ["0", "7", "0", "100"]
    assert len({(text.xy, text.xyann) for text in texts}) == 4


@pytest.mark.parametrize("values", [[0.8, 0.9], [0.5, 1.3], [4, 16], [0.0125, 0.025]])
def test_the_labels_of_neighbouring_values_do_not_touch(values):
    figure = sweep_figure(a_sweep(values))
    FigureCanvasAgg(figure).draw()
    axes = figure.axes[1]
    low, high = axes.get_xlim()
    shown = [label for label in axes.get_xticklabels() if low <= label.get_position()[0] <= high]
    boxes = [label.get_window_extent() for label in shown]
    assert len(boxes) > 1
    assert all(one.x1 + 4 < two.x0 for one, two in pairwise(boxes))


def test_mean_times_have_their_interval_and_labels_say_which():
    frame = a_sweep([0.5, 0.9, 1.2]).assign(mean_time_s_low=25.0, mean_time_s_high=35.0)
    top, bottom = sweep_figure(frame).axes
    assert len(bottom.collections) == 1  # the planner's band; the limit has none
    heights = bottom.collections[0].get_paths()[0].vertices[:, 1]
    assert (heights.min(), heights.max()) == (25.0, 35.0)
    assert "95 % Wilson" in top.get_ylabel()
    assert "95 % interval" in bottom.get_ylabel()


def test_a_tradeoff_has_whiskers_on_both_means():
    means = dict.fromkeys(("mean_transitions", "mean_distance_m", "mean_time_s"), 10.0)
    limits = {f"{name}_{end}": value for name in means for end, value in (("low", 8.0), ("high", 13.0))}
    frame = pd.DataFrame([{"planner": "frugal", "weight": "", "value": 0.0, **means, **limits}])
    for axes in tradeoff_figure(frame).axes[:2]:
        across, up = (c.get_segments()[0] for c in axes.collections)
        assert (across[0][0], across[1][0], up[0][1], up[1][1]) == (8.0, 13.0, 8.0, 13.0)
        assert "95 %" in tradeoff_figure(frame).axes[0].get_ylabel()
