"""A table being learned, shown: as a widget with a slider over its rows."""

import pytest

import bayeshunt as bh


def test_a_table_being_learned_shows_itself_with_a_slider():
    pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
    robot = bh.load_robot("khepera")
    learning = bh.Learning(bh.babble(robot, steps=60, seed=0), robot.gaits)
    data, _ = learning._repr_mimebundle_()
    assert {"text/plain", "text/html", "application/vnd.jupyter.widget-view+json"} <= set(data)
    slider = learning.widget
    assert slider is learning.widget
    assert slider.n == 60
    slider.n = 25
    assert slider.n == 25
    with pytest.raises(bh.InputError, match="n is 61, but there are 60 rows"):
        slider.n = 61
    with pytest.raises(bh.InputError, match="at least 1, got 0"):
        slider.n = 0
