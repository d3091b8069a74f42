"""The page of a table being learned: cells by keyboard, counts as the model's."""

from __future__ import annotations

import pytest

import bayeshunt as bh
from bayeshunt.core import units

pytestmark = pytest.mark.slow


def test_a_cell_is_read_by_keyboard_and_follows_the_slider(open_page, tmp_path):
    robot, frame = bh.load_robot("khepera"), bh.babble("khepera", 120, 5)
    bh.Learning(frame, robot.gaits).save(tmp_path / "learning.html")
    page, watch = open_page(tmp_path / "learning.html")
    page.locator(".heat").nth(1).focus()
    labels = list(bh.Learning(frame, robot.gaits).model(120).counts("Angle").index)
    for _ in range(labels.index("0 deg")):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowDown")
    gait = robot.gaits.names[1]

    def said(n):
        model = bh.Learning(frame, robot.gaits).model(n)
        column = model.counts("Angle")[gait]
        return f"Angle {units.label('0 deg')}, {gait}: {column['0 deg']} of {column.sum()} rows"

    words = page.locator("[data-part=cell]")
    assert words.inner_text() == said(120)
    slider = page.locator("[data-part=n]")
    slider.evaluate("(n) => { n.value = 40; n.dispatchEvent(new Event('input')); }")
    assert words.inner_text() == said(40)
    assert watch.errors == []
