"""The forward model: tables by hand, laws of learning, predictions and samples."""

from __future__ import annotations

import itertools
import math
import subprocess
import sys

import joblib
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_cases import babbled, frame_of, full_joint, random_model, repertoire, small_axes

from bayeshunt.core.errors import BayesHuntError, DataError, InputError, ZeroCountError
from bayeshunt.data import babbling_table
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables import network

EFFECTS = ("Distance", "Angle", "Heading")
AXES = small_axes(1, 3, 2)
CELLS = [("a", 0, 0, 0), ("a", 0, 1, 0), ("a", 1, 1, 0), ("a", 1, 1, 1), ("b", 2, 2, 1), ("b", 2, 0, 1)]


def test_maximum_likelihood_by_hand() -> None:
    model = ForwardModel.fit(frame_of(CELLS, AXES), ["a", "b"], axes=AXES)
    assert model.probabilities("Distance").tolist() == [[2 / 4, 0], [2 / 4, 0], [0, 2 / 2]]
    assert model.probabilities("Angle").tolist() == [[1 / 4, 1 / 2], [3 / 4, 0], [0, 1 / 2]]
    assert model.probabilities("Heading").tolist() == [[3 / 4, 0], [1 / 4, 1]]
    assert model.probabilities("Gait").tolist() == [1 / 2, 1 / 2]
    assert model.counts("Angle").to_numpy().tolist() == [[1, 1], [3, 0], [0, 1]]
    assert model.counts("Gait")["count"].tolist() == [4, 2]


def test_dirichlet_by_hand() -> None:
    model = ForwardModel.fit(frame_of(CELLS, AXES), ["a", "b"], prior=0.5, axes=AXES, gait_prior="empirical")
    expected = [[2.5 / 5.5, 0.5 / 3.5], [2.5 / 5.5, 0.5 / 3.5], [0.5 / 5.5, 2.5 / 3.5]]
    np.testing.assert_allclose(model.probabilities("Distance"), expected, rtol=0, atol=1e-15)
    np.testing.assert_allclose(model.probabilities("Heading"), [[3.5 / 5, 0.5 / 3], [1.5 / 5, 2.5 / 3]], atol=1e-15)
    np.testing.assert_allclose(model.probabilities("Gait"), [4.5 / 7, 2.5 / 7], atol=1e-15)


def test_tables_are_labelled_as_they_are_computed(model: ForwardModel) -> None:
    for effect in EFFECTS:
        cpt = model.cpt(effect)
        assert cpt.index.name == effect
        assert tuple(cpt.index) == model.axes[effect].labels
        assert tuple(cpt.columns) == model.gaits.names
        assert np.array_equal(cpt.to_numpy(), model.probabilities(effect))
        assert model.counts(effect).shape == cpt.shape
        assert model.counts(effect).to_numpy().sum() == model.joint.total
    assert model.cpt("Gait")["probability"].tolist() == [0.2] * 5
    assert model.axes.distance.bins == np.flatnonzero(model.counts("Distance").sum(axis=1))[-1] + 1
    with pytest.raises(ValueError, match="read-only"):
        model.probabilities("Angle")[0, 0] = 1.0


def test_pgmpy_learns_the_same_tables_from_the_raw_rows(frame: pd.DataFrame, model: ForwardModel) -> None:
    from pgmpy.models import DiscreteBayesianNetwork
    from pgmpy.parameter_estimator import DiscreteMLE

    edges = [("Gait", effect) for effect in EFFECTS]
    indices = babbling_table.discretise(frame, model.gaits, model.axes)
    states = network.state_names(model.gaits, model.axes)
    raw = pd.DataFrame({v: np.array(states[v])[indices[:, i]] for i, v in enumerate(network.VARIABLES)})
    fitted = DiscreteBayesianNetwork(edges).fit(raw, estimator=DiscreteMLE(state_names=states))
    for effect in EFFECTS:
        cpd = fitted.get_cpds(effect)
        assert cpd.state_names == model.network.get_cpds(effect).state_names
        np.testing.assert_allclose(cpd.get_values(), model.probabilities(effect), rtol=0, atol=1e-12)
        np.testing.assert_array_equal(model.network.get_cpds(effect).get_values(), model.probabilities(effect))
    assert sorted(model.network.edges()) == [("Gait", e) for e in sorted(EFFECTS)]


def test_a_disagreement_with_pgmpy_is_an_error(model: ForwardModel) -> None:
    tables = {v: model.probabilities(v).copy() for v in network.VARIABLES}
    tables["Angle"][:, 0] = np.roll(tables["Angle"][:, 0], 1)
    with pytest.raises(BayesHuntError, match="table of Angle"):
        network.check_equal(model.network, tables)


def test_gait_without_rows_needs_a_prior() -> None:
    frame = frame_of(CELLS, AXES)
    with pytest.raises(DataError, match=r"gait 'c' has no rows; babble it, or fit with a prior"):
        ForwardModel.fit(frame, ["a", "b", "c"], axes=AXES)
    model = ForwardModel.fit(frame, ["a", "b", "c"], prior=1.0, axes=AXES)
    assert model.probabilities("Angle")[:, 2].tolist() == [1 / 3] * 3
    with pytest.raises(ZeroCountError, match="'c' has no rows"):
        model.predict("c")


@pytest.mark.parametrize("prior", [-0.1, math.nan, math.inf, "1", True])
def test_bad_priors(prior: object) -> None:
    with pytest.raises(InputError, match="prior is"):
        ForwardModel.fit(frame_of(CELLS, AXES), ["a", "b"], prior=prior, axes=AXES)


def test_bad_rows_and_names() -> None:
    frame = frame_of(CELLS, AXES)
    with pytest.raises(DataError, match="'b' is not in the repertoire"):
        ForwardModel.fit(frame, ["a", "c"], axes=AXES)
    with pytest.raises(DataError, match="column 'heading' is missing"):
        ForwardModel.fit(frame.drop(columns="heading"), ["a", "b"], axes=AXES)
    model = ForwardModel.fit(frame, ["a", "b"], axes=AXES)
    with pytest.raises(DataError, match="row 1: angle is nan"):
        model.update(frame.assign(angle=[0.0, math.nan, 0, 0, 0, 0]))
    with pytest.raises(InputError, match="unknown variable 'Speed'"):
        model.cpt("Speed")
    with pytest.raises(InputError, match="gait_prior"):
        ForwardModel.fit(frame, ["a", "b"], axes=AXES, gait_prior="flat")


def test_empty_model_says_so() -> None:
    empty = ForwardModel.empty(["a", "b"], axes=AXES)
    assert empty.joint.total == 0
    with pytest.raises(ZeroCountError):
        empty.cpt("Distance")
    assert ForwardModel.empty(["a", "b"], 1.0, axes=AXES).probabilities("Angle")[0, 0] == 1 / 3


def test_one_row_updates_equal_one_batch(frame: pd.DataFrame) -> None:
    rows = frame.iloc[:60]
    model = ForwardModel.empty(repertoire())
    for i in range(len(rows)):
        model = model.update(rows.iloc[i : i + 1])
    batch = ForwardModel.fit(rows, repertoire())
    assert model == batch
    for variable in ("Gait", *EFFECTS):
        assert np.array_equal(model.probabilities(variable), batch.probabilities(variable))
    assert np.array_equal(model.mean_paths, batch.mean_paths)


def test_update_leaves_the_old_model_as_it_was(frame: pd.DataFrame) -> None:
    model = ForwardModel.fit(frame.iloc[:100], repertoire())
    before = model.counts("Distance")
    assert model.update(frame.iloc[100:200]) != model
    pd.testing.assert_frame_equal(model.counts("Distance"), before)


@settings(max_examples=40)
@given(seed=st.integers(0, 10**6))
def test_columns_sum_to_one(seed: int) -> None:
    model = random_model(seed)
    for variable in ("Gait", *EFFECTS):
        np.testing.assert_allclose(model.probabilities(variable).sum(axis=0), 1.0, atol=1e-12)
    assert full_joint(model).sum() == pytest.approx(1.0, abs=1e-12)


@settings(max_examples=30)
@given(order=st.permutations(["a", "b", "c"]))
def test_order_and_names_of_gaits_are_only_labels(order: list[str]) -> None:
    cells = [*CELLS, ("c", 1, 2, 0)]
    frame = frame_of(cells, AXES)
    model = ForwardModel.empty(["a", "b", "c"], axes=AXES).update(frame)
    permuted = ForwardModel.empty(order, axes=AXES).update(frame)
    renamed = ForwardModel.empty(["x", "y", "z"], axes=AXES).update(
        frame.assign(gait=frame["gait"].map({"a": "x", "b": "y", "c": "z"}))
    )
    for effect in EFFECTS:
        pd.testing.assert_frame_equal(permuted.cpt(effect)[["a", "b", "c"]], model.cpt(effect))
        assert np.array_equal(renamed.probabilities(effect), model.probabilities(effect))


def test_predict_is_the_mean_of_the_rows(frame: pd.DataFrame, model: ForwardModel) -> None:
    rows = frame[frame["gait"] == "soft right"]
    pose = model.predict("soft right")
    assert pose.forward == pytest.approx((rows["distance"] * np.cos(rows["angle"])).mean(), abs=1e-9)
    assert pose.right == pytest.approx((rows["distance"] * np.sin(rows["angle"])).mean(), abs=1e-9)
    assert pose.heading == pytest.approx(np.angle(np.exp(1j * rows["heading"]).mean()), abs=1e-8)
    assert model.predict("soft right").right == pytest.approx(-model.predict("soft left").right, abs=0.02)
    with pytest.raises(InputError, match="unknown gait"):
        model.predict("gallop")


def test_mean_paths(model: ForwardModel) -> None:
    assert model.mean_paths.shape == (5, 4, 3)
    straight = model.mean_paths[0]
    assert np.all(np.diff(straight[:, 0]) > 0.04)
    assert straight[-1, 0] == pytest.approx(model.predict("straight").forward)
    assert ForwardModel.fit(babbled(50, seed=1), repertoire()).mean_paths is None
    with pytest.raises(ValueError, match="read-only"):
        model.mean_paths[0, 0, 0] = 1.0


def test_samples_follow_the_tables(model: ForwardModel) -> None:
    rng = np.random.default_rng(0)
    n = 40_000
    for gait, name in enumerate(model.gaits.names):
        poses = model.sample(name, n, rng=rng)
        for axis, values in zip(model.axes, poses, strict=True):
            p = model.probabilities(axis.name)[:, gait]
            seen = np.bincount(axis.index(values), minlength=axis.bins) / n
            assert np.all(seen[p == 0] == 0)
            assert np.all(np.abs(seen - p) < 5 * np.sqrt(p * (1 - p) / n) + 1e-12)
        assert np.all(poses.distance >= 0)
        assert np.all(np.abs(poses.angle) <= math.pi)


def test_samples_are_uniform_within_a_bin() -> None:
    model = ForwardModel.fit(frame_of([("a", 1, 0, 1)], AXES), ["a"], axes=AXES)
    poses = model.sample("a", 20_000, rng=np.random.default_rng(1))
    place = poses.distance / AXES.distance.width
    assert place.min() >= 1.0
    assert place.max() < 2.0
    assert np.mean(place) == pytest.approx(1.5, abs=0.01)
    assert np.var(place) == pytest.approx(1 / 12, abs=0.002)


def test_outcomes_give_every_gait_the_same_numbers(model: ForwardModel) -> None:
    uniforms = np.random.default_rng(2).random((3, 7, 6))
    poses = model.outcomes(uniforms)
    assert poses.distance.shape == (5, 3, 7)
    for gait, name in enumerate(model.gaits.names):
        drawn = model.sample(name, 21, rng=_Given(uniforms.reshape(21, 6)))
        assert np.array_equal(poses.distance[gait].ravel(), drawn.distance)
        assert np.array_equal(poses.heading[gait].ravel(), drawn.heading)


def test_extreme_uniforms_stay_on_bins_with_mass(model: ForwardModel) -> None:
    last = np.nextafter(1.0, 0.0)
    corners = np.array(list(itertools.product([0.0, last], repeat=3)))
    poses = model.outcomes(np.column_stack([corners, np.full((8, 3), 0.5)]))
    for axis, values in zip(model.axes, poses, strict=True):
        for gait in range(5):
            assert np.all(model.probabilities(axis.name)[axis.index(values[gait]), gait] > 0)
    for bad in (np.full((2, 6), 1.0), np.full((2, 6), math.nan), np.zeros((2, 5))):
        with pytest.raises(InputError, match="uniforms"):
            model.outcomes(bad)


def test_log_likelihood_by_enumeration() -> None:
    model = ForwardModel.fit(frame_of(CELLS, AXES), ["a", "b"], prior=0.25, axes=AXES)
    joint = full_joint(model)
    rows = [("a", 0, 0, 0), ("a", 0, 0, 0), ("b", 2, 1, 1)]
    expected = 2 * math.log(joint[0, 0, 0, 0]) + math.log(joint[1, 2, 1, 1])
    assert model.log_likelihood(frame_of(rows, AXES)) == pytest.approx(expected, rel=1e-12)
    assert model.log_likelihood(frame_of([("a", 3, 0, 0)], AXES)) == -math.inf
    plain = ForwardModel.fit(frame_of(CELLS, AXES), ["a", "b"], axes=AXES)
    assert plain.log_likelihood(frame_of([("a", 2, 0, 0)], AXES)) == -math.inf


def test_maximum_likelihood_is_the_maximum(frame: pd.DataFrame, model: ForwardModel) -> None:
    smoothed = ForwardModel.fit(frame, repertoire(), prior=0.5)
    assert model.log_likelihood(frame) > smoothed.log_likelihood(frame) > -math.inf


def test_only_a_gait_prior_that_was_estimated_has_an_interval(frame: pd.DataFrame) -> None:
    chosen, estimated = (ForwardModel.fit(frame, repertoire(), gait_prior=kind) for kind in ("uniform", "empirical"))
    assert (chosen.table("Gait").low, chosen.table("Gait").high) == (None, None)
    assert chosen.table("Gait").count.equals(estimated.table("Gait").count)
    with pytest.raises(InputError, match=r"set to uniform, not estimated, so it has no interval; fit with gait_prior="):
        chosen.credible_interval("Gait")
    low, high = (bound.to_numpy()[:, 0] for bound in estimated.credible_interval("Gait"))
    assert ((low < estimated.probabilities("Gait")) & (estimated.probabilities("Gait") < high)).all()


def test_credible_intervals_hold_the_probability(model: ForwardModel) -> None:
    low, high = model.credible_interval("Angle")
    p, n = model.probabilities("Angle"), model.counts("Angle").to_numpy()
    assert np.all((low.to_numpy() <= p) & (p <= high.to_numpy()))
    assert np.all(low.to_numpy()[n > 0] < p[n > 0])
    assert np.all(high.to_numpy()[n < n.sum(axis=0)] > p[n < n.sum(axis=0)])
    narrow = model.credible_interval("Angle", level=0.5)
    assert np.all(narrow[1].to_numpy() - narrow[0].to_numpy() < high.to_numpy() - low.to_numpy())
    with pytest.raises(InputError, match="level"):
        model.credible_interval("Angle", level=1.0)


def test_provenance_travels_and_is_kept_once(frame: pd.DataFrame) -> None:
    marked = frame.copy()
    marked.attrs[babbling_table.PROVENANCE_KEY] = {"seed": 1}
    model = ForwardModel.fit(marked, repertoire()).update(marked)
    assert model.provenance == {"sources": [{"seed": 1}]}
    other = frame.copy()
    other.attrs[babbling_table.PROVENANCE_KEY] = {"seed": 2}
    assert model.update(other).provenance["sources"] == [{"seed": 1}, {"seed": 2}]


def test_using_a_model_never_imports_pgmpy(model: ForwardModel, tmp_path, worker) -> None:
    path = tmp_path / "model.json"
    model.save(path)
    code = (
        "import sys, numpy as np; from bayeshunt.models.body.forward import ForwardModel;"
        "from bayeshunt.models.body.inverse import InverseModel;"
        f"m = ForwardModel.load({str(path)!r}); InverseModel(m).posterior(0.1, 0.2);"
        "m.sample('straight', 3, rng=np.random.default_rng(0)); "
        "sys.exit('pgmpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], timeout=60, check=False).returncode == 0
    assert model.network is not None
    joblib.dump(model, tmp_path / "sent")
    assert b"pgmpy" not in (tmp_path / "sent").read_bytes()
    assert worker(model) == model


class _Given(np.random.Generator):
    """A stand-in generator that hands out given numbers."""

    def __init__(self, numbers: np.ndarray) -> None:
        super().__init__(np.random.PCG64(0))
        self.numbers = numbers

    def random(self, size: tuple[int, int]) -> np.ndarray:  # type: ignore[override]
        assert size == self.numbers.shape
        return self.numbers
