"""The gait before as a second cause: learned as pgmpy learns it, exact in every answer, kept with its counts."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from previous_cases import AXES, GAITS, enumerate_joint, fit, momentum

import bayeshunt as bh
from bayeshunt.core.bins import EFFECTS
from bayeshunt.data import babbling_table
from bayeshunt.experiments.studies.babbling import babble_to_file
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts, previous_codes
from bayeshunt.models.counting.streaming import count_tables, open_tables
from bayeshunt.models.formats.model_file import dumps
from bayeshunt.models.tables.structures import PREVIOUS_GAIT

FRAME = momentum(300, 0)
#: Random networks: rows, prior, P(Gait).
SETTINGS = [(0, 0.0, "uniform"), (1, 0.0, "empirical"), (2, 0.3, "uniform"), (3, 0.3, "empirical")]
each_network = pytest.mark.parametrize(("seed", "prior", "gait_prior"), SETTINGS)


def network(seed: int, prior: float, gait_prior: str) -> bh.ForwardModel:
    return fit(momentum(250 if prior == 0 else 40, seed, starts=3), prior, gait_prior)


# --- learning --------------------------------------------------------------------------------------


@pytest.mark.parametrize("prior", [0.0, 0.5])
def test_tables_are_what_pgmpy_fits_to_the_rows(prior: float) -> None:
    from pgmpy.models import DiscreteBayesianNetwork
    from pgmpy.parameter_estimator import DiscreteBayesianEstimator, DiscreteMLE

    model = fit(FRAME, prior, "empirical")
    rows = FRAME[FRAME["previous_gait"].notna()]
    codes = babbling_table.discretise(rows, model.gaits, model.axes)
    columns = {"PreviousGait": rows["previous_gait"].to_list()}
    for i, name in enumerate(("Gait", *EFFECTS)):
        columns[name] = [model.states[name][code] for code in codes[:, i]]
    if prior:
        estimator = DiscreteBayesianEstimator(
            prior_type="dirichlet", pseudo_counts=prior, state_names=dict(model.states)
        )
    else:
        estimator = DiscreteMLE(state_names=dict(model.states))
    theirs = DiscreteBayesianNetwork(list(PREVIOUS_GAIT.edges)).fit(pd.DataFrame(columns), estimator=estimator)
    for name, table in model.local_tables.items():
        found = theirs.get_cpds(name)
        assert tuple(found.variables[1:]) == (() if name in ("Gait", "PreviousGait") else ("Gait", "PreviousGait"))
        np.testing.assert_allclose(found.values, table, rtol=0, atol=1e-12)


def test_a_column_is_the_share_of_the_rows_after_that_gait() -> None:
    model = fit(FRAME)
    mine = FRAME[(FRAME["previous_gait"] == "b") & (FRAME["gait"] == "c")]
    bins = model.axes.angle.index(mine["angle"].to_numpy())
    shares = np.bincount(bins, minlength=5) / len(mine)
    np.testing.assert_allclose(model.local_tables["Angle"][:, 2, 1], shares, rtol=0, atol=1e-15)
    np.testing.assert_allclose(model.after("b").probabilities("Angle")[:, 2], shares, rtol=0, atol=1e-15)
    assert model.after("b").counts("Angle")["c"].tolist() == np.bincount(bins, minlength=5).tolist()


def test_rows_that_no_gait_went_before_are_not_counted() -> None:
    frame = momentum(100, 1, starts=4)
    model = fit(frame, 0.1)
    assert model.joint.total == model.by_previous.total == 96
    known = frame[frame["previous_gait"].notna()]
    assert model.joint == JointCounts.of(known, model.gaits, AXES)
    pairs = pd.crosstab(known["previous_gait"], known["gait"]).to_numpy()
    assert np.array_equal(model.by_previous.pairs, pairs)


@pytest.mark.parametrize("size", [1, 7, 50])
def test_any_split_counts_alike(size: int) -> None:
    """The gait before stands in the row itself, so that no border between parts loses it."""
    frame = momentum(150, 2, starts=2)
    whole = fit(frame, 0.1)
    parts = bh.ForwardModel.empty(GAITS, 0.1, axes=AXES, structure="previous_gait", backoff=None)
    for start in reversed(range(0, len(frame), size)):
        parts = parts.update(frame[start : start + size])
    assert parts == whole
    assert dumps(parts) == dumps(whole)
    for effect in EFFECTS:
        assert np.array_equal(parts.local_tables[effect], whole.local_tables[effect])


def test_shards_and_their_borders(tmp_path: Path) -> None:
    """Three shards, each from a robot at rest: three rows without a gait before, no pair across a border."""
    robot = bh.load_robot("khepera")
    babble_to_file("khepera", 130, 3, tmp_path / "t.parquet", shard_rows=50)
    frame = bh.load_dataset(tmp_path / "t.parquet")
    assert frame.index[frame["previous_gait"].isna()].tolist() == [0, 50, 100]
    streamed, _ = count_tables(open_tables([tmp_path / "t.parquet"]), robot.gaits, structure="previous_gait")
    assert streamed == PreviousCounts.of(frame, robot.gaits, bh.EffectAxes.standard(robot.gaits.body_length))
    assert streamed.total == 127
    gait = frame["gait"].tolist()
    for row in (i for i in range(130) if i not in (0, 50, 100)):
        assert frame["previous_gait"][row] == gait[row - 1]


def test_streamed_counts_fit_the_same_model(tmp_path: Path) -> None:
    halves = [FRAME[:170], FRAME[170:]]
    for i, half in enumerate(halves):
        babbling_table.save(half, tmp_path / f"{i}.parquet", {})
    gaits = bh.GaitRepertoire.of(GAITS)
    tables = open_tables([tmp_path / "1.parquet", tmp_path / "0.parquet"])
    counts, _ = count_tables(tables, gaits, axes=AXES, structure="previous_gait")
    assert ForwardModel.from_counts(counts, structure="previous_gait", backoff=None) == fit(FRAME)


# --- answers ---------------------------------------------------------------------------------------


@each_network
def test_every_answer_equals_enumeration(seed: int, prior: float, gait_prior: str) -> None:
    model = network(seed, prior, gait_prior)
    whole = enumerate_joint(model)
    assert whole.sum() == pytest.approx(1, abs=1e-12)
    inverse = bh.InverseModel(model)
    for before, name in [*enumerate(GAITS), (None, None)]:
        part = model.after(name)
        joint = whole.sum(axis=0) if before is None else whole[before] / whole[before].sum()
        gait = joint.sum(axis=(1, 2, 3))
        np.testing.assert_allclose(part.probabilities("Gait"), gait, rtol=0, atol=1e-12)
        for i, effect in enumerate(EFFECTS):
            others = tuple(1 + k for k in range(3) if k != i)
            np.testing.assert_allclose(part.probabilities(effect), joint.sum(axis=others).T / gait, rtol=0, atol=1e-12)
        asked = inverse.after(name)
        for cell in asked.table().itertuples():
            answer = asked.posterior(cell.distance, cell.angle)
            assert not answer.snapped
            d, a = answer.cell.distance_bin, answer.cell.angle_bin
            expected = joint[:, d, a].sum(axis=1)
            np.testing.assert_allclose(answer.values, expected / expected.sum(), rtol=0, atol=1e-12)
            assert answer.evidence_probability == pytest.approx(expected.sum(), abs=1e-12)
            for h in np.flatnonzero(joint[:, d, a].sum(axis=0)).tolist():
                with_heading = asked.posterior(cell.distance, cell.angle, model.axes.heading.centres[h], snap=False)
                expected = joint[:, d, a, h]
                np.testing.assert_allclose(with_heading.values, expected / expected.sum(), rtol=0, atol=1e-12)


@each_network
def test_a_second_engine_agrees(seed: int, prior: float, gait_prior: str) -> None:
    from pgmpy.inference import VariableElimination

    model = network(seed, prior, gait_prior)
    engine, inverse = VariableElimination(model.network), bh.InverseModel(model)
    for name in (*GAITS, None):
        asked = inverse.after(name)
        for cell in list(asked.table().itertuples())[::2]:
            answer = asked.posterior(cell.distance, cell.angle)
            assert answer.evidence.get("PreviousGait") == name
            theirs = engine.query(["Gait"], evidence=answer.evidence, show_progress=False)
            values = [theirs.get_value(Gait=gait) for gait in GAITS]
            np.testing.assert_allclose(answer.values, values, rtol=0, atol=1e-12)


def test_targets_snap_to_what_was_reached_after_that_gait() -> None:
    model = fit(momentum(60, 5), 0.1)
    inverse = bh.InverseModel(model)
    rng = np.random.default_rng(0)
    differs = False
    for name in GAITS:
        asked, joint = inverse.after(name), model.after(name).joint
        cells = np.argwhere(joint.support > 0)
        assert np.array_equal(model.after(name).learned_cells, cells)
        centres = AXES.extended(model.axes.distance.bins)
        reach, turn = centres.distance.centres[cells[:, 0]], centres.angle.centres[cells[:, 1]]
        places = np.column_stack([reach * np.cos(turn), reach * np.sin(turn)])
        for distance, angle in zip(rng.uniform(0, 0.3, 60), rng.uniform(-math.pi, math.pi, 60), strict=True):
            own = [model.axes.distance.index(distance), model.axes.angle.index(angle)]
            gaps = np.hypot(*(places - [distance * math.cos(angle), distance * math.sin(angle)]).T)
            reached = (cells == own).all(axis=1)
            expected = cells[reached][0] if reached.any() else cells[gaps.argmin()]
            answer = asked.posterior(distance, angle)
            assert [answer.cell.distance_bin, answer.cell.angle_bin] == expected.tolist()
            assert answer.support == joint.support[tuple(expected)]
            differs |= answer.cell != inverse.posterior(distance, angle).cell
    assert differs


@each_network
def test_explanations_add_up(seed: int, prior: float, gait_prior: str) -> None:
    inverse = bh.InverseModel(network(seed, prior, gait_prior))
    for name in (*GAITS, None):
        for cell in inverse.after(name).table().itertuples():
            for heading in (None, 0.0):
                parts = inverse.after(name).posterior(cell.distance, cell.angle, heading).explain()
                total = parts[["prior", *EFFECTS]].sum(axis=1)
                np.testing.assert_allclose(total, parts["log_odds"], rtol=0, atol=1e-9)


def test_rows_behind_every_cell() -> None:
    model = fit(FRAME)
    for name in (*GAITS, None):
        part = model.after(name)
        for variable in EFFECTS:
            counts = part.counts(variable)
            for label in counts.index:
                for gait in GAITS:
                    rows = part.rows(variable, label, gait)
                    assert len(rows) == counts.loc[label, gait]
                    assert (rows["gait"] == gait).all()
                    assert (
                        rows["previous_gait"].notna().all() if name is None else (rows["previous_gait"] == name).all()
                    )


def test_intervals_are_those_of_the_rows_after_that_gait() -> None:
    from bayeshunt.core import statistics as tables

    model = fit(FRAME, 0.5)
    shown = model.after("b").table("Heading")
    assert shown.name == "P(Heading | Gait, PreviousGait = b)"
    counts = np.column_stack([model.counted_cells.tabulate(("Heading", "Gait", "PreviousGait"))[:, :, 1]])
    low, high = tables.credible_interval(counts, 0.5)
    assert np.array_equal(shown.low, low)
    assert np.array_equal(shown.high, high)
    assert np.array_equal(shown.count, counts)


@pytest.mark.parametrize("name", [*GAITS, None])
def test_samples_follow_the_joint_table(name: str | None) -> None:
    model = fit(FRAME)
    whole = enumerate_joint(model)
    joint = whole.sum(axis=0) if name is None else whole[GAITS.index(name)]
    joint, n = joint / joint.sum(axis=(1, 2, 3), keepdims=True), 40_000
    for gait, named in enumerate(GAITS):
        drawn = model.after(name).sample(named, n, rng=np.random.default_rng(gait))
        seen = np.zeros(joint.shape[1:])
        np.add.at(seen, tuple(axis.index(v) for axis, v in zip(model.axes, drawn, strict=True)), 1)
        assert not seen[joint[gait] == 0].any()
        spread = np.sqrt(joint[gait] * (1 - joint[gait]) / n)
        assert (np.abs(seen / n - joint[gait]) <= 5.5 * spread + 1e-12).all()


def test_log_likelihood_is_the_sum_over_the_rows() -> None:
    frame = momentum(120, 4, starts=3)
    model = fit(frame, 0.2)
    whole, known = enumerate_joint(model), frame[frame["previous_gait"].notna()]
    codes = np.column_stack(
        [previous_codes(known, model.gaits), babbling_table.discretise(known, model.gaits, model.axes)]
    )
    expected = np.log(whole[tuple(codes.T)] * len(GAITS)).sum()  # P(row | PreviousGait): all gaits before alike
    assert model.log_likelihood(frame) == pytest.approx(expected, rel=1e-12)
    assert model.log_likelihood(model.by_previous) == pytest.approx(expected, rel=1e-12)


def test_mean_poses_are_those_of_the_rows() -> None:
    model = fit(FRAME)
    mine = FRAME[(FRAME["previous_gait"] == "a") & (FRAME["gait"] == "b")]
    pose = model.after("a").predict("b")
    assert float(pose.forward) == pytest.approx((mine["distance"] * np.cos(mine["angle"])).mean(), abs=1e-7)
    assert float(pose.right) == pytest.approx((mine["distance"] * np.sin(mine["angle"])).mean(), abs=1e-7)


def test_a_pair_never_babbled_falls_back_to_all_rows_where_a_prior_allows_it() -> None:
    frame = FRAME[(FRAME["previous_gait"] != "a") & ~((FRAME["previous_gait"] == "b") & (FRAME["gait"] == "c"))]
    model = fit(frame, 0.1)
    assert model.after("b").joint.marginal("Gait").tolist()[2] == 0
    assert model.after("b").predict("c") == model.predict("c")
    assert model.after("b").predict("a") != model.predict("a")
    assert np.array_equal(model.after("a").learned_cells, model.learned_cells)
    answer = bh.InverseModel(model).after("a").posterior(0.07, 0.0)
    assert answer.support == 0
    np.testing.assert_allclose(answer.values, 1 / 3, atol=1e-12)


def test_a_context_is_what_after_means() -> None:
    model, naive = fit(FRAME, 0.1), bh.ForwardModel.fit(FRAME, GAITS, axes=AXES)
    part = model.given({"PreviousGait": "b"})
    assert part is model.after("b")
    assert part.given({}) is model
    assert part.given({"PreviousGait": None}) is model
    assert part.after("c") is model.given({"PreviousGait": "c"})
    assert (part.known, model.known) == ({"PreviousGait": "b"}, {})
    assert naive.given({"PreviousGait": "b"}) is naive
    for one in (model, naive, part):
        with pytest.raises(bh.InputError, match=r"^unknown context 'Angle': expected PreviousGait$"):
            one.given({"Angle": "b"})
        with pytest.raises(bh.InputError, match=r"^unknown gait 'd'"):
            one.given({"PreviousGait": "d"})


def test_whether_counts_are_known_is_the_support() -> None:
    model = fit(FRAME, 0.1)
    imported = bh.ForwardModel.of_tables(model.gaits, model.axes, model.structure, model.local_tables)
    assert imported.support is None
    assert imported.after("b").support is None
    assert not imported.has_counts
    for one in (model, model.after("b")):
        assert one.has_counts
        assert int(one.support.sum()) == one.joint.total
