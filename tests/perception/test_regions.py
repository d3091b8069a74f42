"""How sure the particles are, and how right: their regions, and the expected counts that are learned from them."""

import pytest

from benchmarks.sensing import calibration, expected_counts


@pytest.mark.slow
@pytest.mark.parametrize("row", ["walled, wide", "walled, narrow", "open, wide", "open, narrow"])
def test_the_regions_hold_the_prey_about_as_often_as_they_say(row):
    """56 hunts: some 300 decisions that depend on each other, so the bounds are wider than those of so many coins."""
    held = calibration(row, 8, 1001)
    assert 0.40 < held["in_50"] < 0.68
    assert 0.82 < held["in_90"] < 0.97


@pytest.mark.slow
@pytest.mark.parametrize(("row", "most"), [("open, wide", 0.10), ("open, narrow", 0.14)])
def test_expected_counts_come_near_to_what_the_prey_did(row, most):
    learned = expected_counts(row, 8, 1001)
    assert learned["total_variation"] <= most
    assert learned["turns"] <= 0.04
