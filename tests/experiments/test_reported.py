"""Reproduced beside reported: the tests against values of other programs, and what stands beside what."""

import json
import math

import numpy as np
import pandas as pd
import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import ConfigError, InputError
from bayeshunt.experiments.reported import compare, fisher, same_mean
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.scores import summarise
from bayeshunt.experiments.store.export import summary, to_markdown

OSES = load_experiment("oses2010", {"protocol.runs": 10})


def hunts(caught, planner="reactive", arena="walled", times=None):
    """Ten hunts from each of the seven bearings; ``caught`` of each."""
    rows = [
        (planner, arena, float(theta), run, run < count, 10.0 + run if run < count else 60.0)
        for theta, count in enumerate(caught)
        for run in range(10)
    ]
    frame = pd.DataFrame(rows, columns=["planner", "arena", "theta", "run", "caught", "time"])
    frame.attrs = {"seed": 0}
    return frame


def enumerated(a, n, b, m):
    """Fisher's test by full enumeration: the chance of every table that is no likelier than the one seen."""
    chance = [math.comb(n, k) * math.comb(m, a + b - k) for k in range(max(0, a + b - m), min(n, a + b) + 1)]
    seen = math.comb(n, a) * math.comb(m, b)
    return sum(c for c in chance if c <= seen) / math.comb(n + m, a + b)


@pytest.mark.parametrize(("a", "n", "b", "m"), [(3, 10, 9, 12), (0, 300, 2, 100), (0, 500, 2, 100), (7, 7, 0, 7)])
def test_fisher_is_full_enumeration(a, n, b, m):
    assert fisher(a, n, b, m) == pytest.approx(enumerated(a, n, b, m), rel=1e-9)


def test_fishers_own_tea():
    assert fisher(3, 4, 1, 4) == pytest.approx(34 / 70)


@pytest.mark.parametrize("given", [(3, 2, 1, 4), (1, 2, -1, 4), (0, 0, 1, 4)])
def test_counts_that_cannot_be(given):
    with pytest.raises(InputError, match="expected 0 <= caught <= runs"):
        fisher(*given)


def test_z_of_two_means():
    z, p = same_mean([10.0, 20.0, 30.0], 15.0, 6)  # s = 10, error = 10 sqrt(1/3 + 1/6) = 7.07
    assert z == pytest.approx(5 / math.sqrt(50))
    assert p == pytest.approx(math.erfc(z / math.sqrt(2)))
    assert all(math.isnan(value) for value in same_mean([5.0, 5.0], 5.0, 3))
    with pytest.raises(InputError, match="at least two"):
        same_mean([5.0], 5.0, 3)


def test_the_published_figures_in_full():
    reactive, prediction = OSES.reported("reactive", "walled"), OSES.reported("prediction", "walled")
    assert (reactive.by_theta, reactive.caught, reactive.runs) == ((0, 100, 2, 0, 0, 0, 0), 102, 700)
    assert reactive.share == pytest.approx(0.1457, abs=5e-5)
    assert prediction.share == pytest.approx(0.9357, abs=5e-5)
    assert (prediction.printed, prediction.mean_time) == (0.928, 15.287)
    assert OSES.reported("prediction", "open").share == pytest.approx(0.6757, abs=5e-5)
    assert OSES.reported("planning", "open").share == pytest.approx(0.8443, abs=5e-5)
    assert OSES.reported("planning", "walled") is None
    assert load_experiment("paper").reported("prediction", "walled").share == 0.928


def test_each_bearing_stands_beside_its_own():
    rows = compare(hunts([0, 10, 1, 0, 0, 0, 0]), OSES)
    assert [row["theta"] for row in rows] == [0, 1, 2, 3, 4, 5, 6, None]
    assert [row["paper_caught"] for row in rows] == [0, 100, 2, 0, 0, 0, 0, 102]
    assert rows[2]["p_success"] == pytest.approx(enumerated(1, 10, 2, 100))
    assert rows[-1]["p_success"] == pytest.approx(enumerated(11, 70, 102, 700))
    assert [row["paper_success"] for row in summarise(hunts([0] * 7), OSES)][:3] == [0.0, 1.0, 0.02]
    few = hunts([0, 10, 1, 0, 0, 0, 0])
    assert [row["theta"] for row in compare(few[few["theta"] == 2.0], OSES)] == [2.0, None]


def test_a_mean_time_with_its_misses():
    frame = hunts([10, 10, 10, 10, 10, 10, 5], "prediction")
    (row,) = compare(frame, OSES)
    assert (row["theta"], row["paper_mean_time_s"], row["paper_printed"]) == (None, 15.287, 0.928)
    spread = np.std(frame["time"], ddof=1) * math.sqrt(1 / 70 + 1 / 700)
    assert row["z_time"] == pytest.approx((frame["time"].mean() - 15.287) / spread)


def test_a_bare_share_is_shown_and_not_tested():
    (row,) = compare(hunts([1] * 7), load_experiment("paper"))
    assert row["paper_success"] == 0.1457
    assert row["p_success"] is row["paper_caught"] is row["p_time"] is None


def test_the_summary_tells_and_keeps_its_rows():
    facts = summary(hunts([0, 10, 1, 0, 0, 0, 0]), OSES, 0)
    assert set(facts["rows"][0]) == {
        "planner", "arena", "theta", "runs", "caught", "success", "ci_low", "ci_high", "mean_time_s", "paper_success",
    }  # fmt: skip
    assert len(facts["reported"]) == 8
    assert "| reactive | walled | 2 | 2/100 | 1/10 | 0.25" in to_markdown(facts)
    assert json.loads(json.dumps(facts)) == facts


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"caught": 3, "run": 4}, r"walled\.run: unknown key; did you mean 'runs'\?"),
        ({"caught": 3}, "caught and runs: give both or neither"),
        ({"caught": 5, "runs": 4}, "5 are more than the 4 runs"),
        ({"caught": 3, "runs": 70, "by_theta": [1, 2]}, "2 counts for the 7 bearings"),
        ({"caught": 3, "runs": 70, "by_theta": [1, 1, 0, 0, 0, 0, 0]}, "2 caught in all, which caught does not say"),
        ({"caught": 3, "runs": 71, "by_theta": [3, 0, 0, 0, 0, 0, 0]}, "7 bearings cannot share 71 runs"),
        ({"success": 92.8}, "less than or equal to 1"),
        ("x", "valid number"),
    ],
)
def test_figures_that_contradict_themselves(given, says):
    with pytest.raises(ConfigError, match=says) as caught:
        load_experiment("oses2010", {"published.reactive.walled": given})
    assert "\n" not in str(caught.value)
    assert "published.reactive.walled" in str(caught.value)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_all_that_the_paper_reports_comes_out(seed):
    """Each seed alone, 700 hunts a row: within 6.5 points, and the profile of reactive over the bearings."""
    results = evaluate("oses2010", seed=seed, jobs=-1)
    rows = {(row["planner"], row["arena"], row["theta"]): row for row in compare(results, load_experiment("oses2010"))}
    for theta in range(7):
        success = rows["reactive", "walled", float(theta)]["success"]
        assert success >= 0.99 if theta == 1 else success <= 0.02
    for name in (("reactive", "walled"), ("prediction", "walled"), ("prediction", "open"), ("planning", "open")):
        row = rows[(*name, None)]
        assert row["success"] == pytest.approx(row["paper_success"], abs=0.065)
    assert rows["prediction", "walled", None]["mean_time_s"] == pytest.approx(15.287, abs=1.5)
