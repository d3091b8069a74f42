"""What a prey does at walls: counts beside what was believed before, by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from bayeshunt.core.errors import InputError
from bayeshunt.models.target.at_walls import AtWalls

BEFORE = AtWalls(rebound=0.5, clearance=0.02, keeps=0.2, prior=1.0, straight=2.0)


def test_before_anything_is_seen_the_belief_stands():
    assert (BEFORE.keeping, BEFORE.hazard, BEFORE.leaving, BEFORE.keeping_clear) == (0.2, 0.0, 0.5, 0.02)


def test_what_is_seen_overrules_the_belief():
    seen = replace(BEFORE, rebounds=(0.9, 1.1), clearances=(0.05, 0.03), kept=1, elsewhere=2, strays=1)
    assert seen.keeping == pytest.approx((1 + 0.2) / (3 + 1))
    assert seen.leaving == pytest.approx((0.5 + 0.9 + 1.1) / 3)
    assert seen.keeping_clear == pytest.approx((0.02 + 0.05 + 0.03) / 3)
    assert seen.hazard == pytest.approx(1 / (2 + 2))
    many = replace(BEFORE, rebounds=(1.2,) * 200, clearances=(0.0,) * 200)
    assert (many.leaving, many.keeping) == pytest.approx((1.2, 0.0), abs=0.01)


def test_the_table_shows_both():
    table = replace(BEFORE, rebounds=(0.9,), clearances=(0.05,), kept=1, elsewhere=1, strays=1).table()
    assert table["probability"].tolist() == pytest.approx([1.8 / 3, 1.2 / 3, 1 / 3])
    assert table["before"].tolist() == pytest.approx([0.8, 0.2, 0.0])
    assert table["seen"].tolist() == [1, 1, 1]
    assert table["of"].tolist() == [2, 2, 1]
    first = table.loc["turns at a wall"]
    assert (first["rebound"], first["rebound_before"], first["clearance_before"]) == pytest.approx((0.7, 0.5, 0.02))
    assert math.isnan(table.loc["turns elsewhere", "rebound"])


@pytest.mark.parametrize("wrong", [{"keeps": 1.5}, {"prior": 0.0}, {"straight": -1.0}])
def test_nonsense_is_named(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        AtWalls(0.5, 0.02, **wrong)
