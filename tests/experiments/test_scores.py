"""Intervals and summaries against numbers from elsewhere."""

import math

import pandas as pd
import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import InputError
from bayeshunt.experiments.scores import as_evaluated, mean_interval, paired_differences, summarise, wilson_interval


@pytest.mark.parametrize(
    ("caught", "runs", "low", "high"),
    [
        # scipy.stats.binomtest(k, n).proportion_ci(method="wilson")
        (102, 700, 0.12151, 0.17379),
        (0, 10, 0.0, 0.27753),
        (10, 10, 0.72247, 1.0),
        (1, 2, 0.09453, 0.90547),
    ],
)
def test_wilson_by_another_program(caught, runs, low, high):
    assert wilson_interval(caught, runs) == pytest.approx((low, high), abs=1e-4)


def test_wilson_equals_scipy():
    from scipy.stats import binomtest

    for caught, runs in ((3, 7), (591, 700), (699, 700)):
        theirs = binomtest(caught, runs).proportion_ci(method="wilson")
        assert wilson_interval(caught, runs) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_no_runs_say_nothing():
    assert wilson_interval(0, 0) == (0.0, 1.0)


def test_summary_by_hand():
    hunts = pd.DataFrame(
        {
            "planner": ["reactive"] * 4,
            "arena": ["walled"] * 4,
            "theta": [0.0, 0.0, 1.0, 1.0],
            "caught": [True, False, True, True],
            "time": [10.0, 60.0, 20.0, 30.0],
        }
    )
    rows = summarise(hunts, load_experiment("paper"))
    assert [row["theta"] for row in rows] == [0.0, 1.0, None]
    total = rows[-1]
    assert (total["runs"], total["caught"], total["success"], total["mean_time_s"]) == (4, 3, 0.75, 30.0)
    assert total["paper_success"] == 0.1457
    assert rows[0]["paper_success"] is None


def test_another_structure_has_no_published_counterpart():
    hunts = pd.DataFrame(
        {"planner": ["reactive"], "arena": ["walled"], "theta": [0.0], "caught": [True], "time": [10.0]}
    )
    paper = load_experiment("paper")
    changed = load_experiment("paper", {"prey.speed": 0.04})
    assert as_evaluated(hunts, paper) is paper
    hunts.attrs["structure"] = "naive"
    assert as_evaluated(hunts, paper) is paper
    hunts.attrs["structure"] = "tan"
    assert summarise(hunts, paper)[-1]["paper_success"] is None
    note = as_evaluated(hunts, paper).note
    assert note.startswith("Hunted with a given model of structure tan; 'paper' itself learns naive.")
    assert note.endswith("these figures have no published counterpart.")
    assert as_evaluated(hunts, changed).note.startswith(changed.note)
    assert "structure tan" in as_evaluated(hunts, changed).note


@pytest.mark.parametrize(
    ("successes", "runs", "said"),
    [
        (3, 2, "successes: 3 are more than the 2 runs"),
        (-1, 2, "successes: expected a whole number of at least 0, got -1"),
        (1, 2.5, "runs: expected a whole number of at least 0, got 2.5"),
        (1, None, "runs: expected a whole number of at least 0, got None"),
    ],
)
def test_impossible_counts_are_refused(successes, runs, said):
    with pytest.raises(InputError, match=said):
        wilson_interval(successes, runs)


def test_the_interval_of_a_mean_is_students():
    low, high = mean_interval([10.0, 20.0, 60.0])  # t(0.975, 2) = 4.302653 times 26.457513 / sqrt(3), by hand
    assert (low, high) == (pytest.approx(30 - 65.7241, abs=1e-3), pytest.approx(30 + 65.7241, abs=1e-3))
    assert mean_interval([7.5]) == (7.5, 7.5)


def test_planners_are_compared_on_the_same_hunts():
    """A table by hand: 4 hunts caught by both, 5 by the first alone, 1 by the second alone, 10 by none."""
    rows = []
    for k in range(20):
        caught = {"a": k < 9, "b": k < 4 or k == 9}
        rows += [{"planner": p, "arena": "open", "theta": k % 4, "seed": k, "caught": c} for p, c in caught.items()]
    rows += [{"planner": "a", "arena": "open", "theta": 9, "seed": 99, "caught": True}]  # hunted by one alone
    (found,) = paired_differences(pd.DataFrame(rows))
    assert (found["first"], found["second"], found["hunts"]) == ("a", "b", 20)
    assert (found["only_first"], found["only_second"]) == (5, 1)
    assert found["difference"] == pytest.approx(0.2)
    middle, spread = 4 / 22, 1.959963984540054 * math.sqrt(7 - 16 / 22) / 22
    assert (found["low"], found["high"]) == (pytest.approx(middle - spread), pytest.approx(middle + spread))
    assert found["p"] == pytest.approx(2 * (1 + 6) / 64)  # two-sided binomial, 1 of 6
