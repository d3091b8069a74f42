"""Intervals and summaries against numbers from elsewhere."""

import pandas as pd
import pytest

from bayeshunt.experiments.scores import summarise, wilson_interval
from bayeshunt.settings import load_experiment


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
