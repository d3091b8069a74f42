"""The prey model: counting online, expected and sampled futures, and saying that it knows nothing."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import InputError, NothingObservedError
from bayeshunt.core.geometry import Polar, wrap
from bayeshunt.models.target.prey import PreyModel

transitions = st.lists(
    st.builds(Polar, st.floats(0.0, 0.5), st.floats(-3.2, 3.2), st.floats(-3.2, 3.2)), min_size=1, max_size=20
)


def seen(*poses: Polar) -> PreyModel:
    model = PreyModel()
    for pose in poses:
        model.observe(pose)
    return model


def centre(pose: Polar) -> Polar:
    axes = EffectAxes.standard(0.057)
    distance = (axes.distance.index(pose.distance) + 0.5) * axes.distance.width
    return Polar(
        distance,
        axes.angle.centres[axes.angle.index(pose.angle)],
        axes.heading.centres[axes.heading.index(pose.heading)],
    )


def test_nothing_observed_is_a_state_it_can_say() -> None:
    model = PreyModel()
    assert model.is_empty
    assert model.observations == 0
    assert model.counts.empty
    assert model.cpt().empty
    for ask in (
        lambda: model.predict(1),
        lambda: model.predict(0),
        lambda: model.predict_path(3),
        lambda: model.sample_paths(3, 2, rng=np.random.default_rng(0)),
    ):
        with pytest.raises(NothingObservedError):
            ask()


def test_counts_and_table_by_hand() -> None:
    model = seen(Polar(0.16, 0.01, 0.0), Polar(0.161, -0.02, 0.05), Polar(0.14, 0.2, 0.5), Polar(0.16, 0.0, 0.0))
    assert model.counts["count"].to_dict() == {
        ("136.8-142.5 mm", "10 deg", "30 deg"): 1,
        ("159.6-165.3 mm", "0 deg", "0 deg"): 3,
    }
    table = model.cpt()
    assert table["probability"].tolist() == [0.25, 0.75]
    assert table["count"].tolist() == [1, 3]
    assert np.all((table["low"] < table["probability"]) & (table["probability"] < table["high"]))
    assert list(table.index.names) == ["Distance", "Angle", "Heading"]
    assert (model.observations, model.is_empty) == (4, False)


def test_one_transition_is_iterated() -> None:
    step = centre(Polar(0.16, 0.1, 0.4))
    model = seen(Polar(0.16, 0.1, 0.4))
    expected = Polar(0.0, 0.0, 0.0)
    path = model.predict_path(6)
    for i in range(7):
        for part, value in zip(expected, (p[i] for p in path), strict=True):
            assert value == pytest.approx(part, abs=1e-12)
        expected = expected.compose(step)


def test_prediction_is_the_mean_transition_not_the_mode() -> None:
    poses = [Polar(0.16, 0.0, 0.0)] * 3 + [Polar(0.05, math.pi / 2, math.pi / 2)]
    model = seen(*poses)
    centres = [centre(p) for p in poses]
    mean = model.predict(1)
    assert mean.forward == pytest.approx(np.mean([c.forward for c in centres]), abs=1e-12)
    assert mean.right == pytest.approx(np.mean([c.right for c in centres]), abs=1e-12)
    assert mean.heading == pytest.approx(math.atan2(1, 3), abs=1e-12)


def test_headings_average_across_the_seam() -> None:
    model = seen(Polar(0.1, 0.0, math.radians(170)), Polar(0.1, 0.0, math.radians(-170)))
    assert abs(model.predict(1).heading) == pytest.approx(math.pi, abs=1e-12)


@settings(max_examples=60)
@given(poses=transitions, seed=st.integers(0, 1000), steps=st.integers(0, 12))
def test_order_of_observations_changes_no_bit(poses: list[Polar], seed: int, steps: int) -> None:
    order = np.random.default_rng(seed).permutation(len(poses))
    one, two = seen(*poses), seen(*(poses[i] for i in order))
    half = seen(*poses[: len(poses) // 2]).merge(seen(*poses[len(poses) // 2 :]))
    for other in (two, half, PreyModel.from_dict(json.loads(json.dumps(one.to_dict())))):
        assert other == one
        assert other.predict(steps) == one.predict(steps)
        assert other.counts.equals(one.counts)
        drawn = other.sample_paths(3, 4, rng=np.random.default_rng(1))
        assert np.array_equal(drawn.angle, one.sample_paths(3, 4, rng=np.random.default_rng(1)).angle)


@settings(max_examples=60)
@given(poses=transitions, first=st.integers(0, 6), then=st.integers(0, 6))
def test_prediction_composes(poses: list[Polar], first: int, then: int) -> None:
    model = seen(*poses)
    both = model.predict(first).compose(model.predict(then))
    whole = model.predict(first + then)
    assert whole.forward == pytest.approx(both.forward, abs=1e-9)
    assert whole.right == pytest.approx(both.right, abs=1e-9)
    assert wrap(whole.heading - both.heading) == pytest.approx(0.0, abs=1e-9)
    path = model.predict_path(first + then)
    assert path.distance.shape == (first + then + 1,)
    assert path.distance[-1] == whole.distance
    assert (path.distance[0], path.angle[0], path.heading[0]) == (0.0, 0.0, 0.0)


@given(transitions)
def test_when_somebody_looks_changes_no_bit(poses: list[Polar]) -> None:
    """What is observed is counted when it is asked for: after each transition, or after all of them."""
    looked = PreyModel()
    for number, pose in enumerate(poses, 1):
        looked.observe(pose)
        assert looked.observations == number
        assert sum(row[-1] for row in looked.cells()) == number
    model = seen(*poses)
    twin = model.copy()
    assert model.predict(3) == looked.predict(3) == twin.predict(3)
    assert model == looked == twin


def test_sampled_paths_follow_the_counts() -> None:
    straight, turn = Polar(0.16, 0.0, 0.0), Polar(0.05, 0.3, 1.0)
    model = seen(straight, straight, straight, turn)
    paths = model.sample_paths(5, 8000, rng=np.random.default_rng(3))
    assert paths.distance.shape == (8000, 6)
    assert np.all(paths.distance[:, 0] == 0.0)
    turned = np.abs(paths.heading[:, 1]) > 0.5
    assert np.mean(turned) == pytest.approx(0.25, abs=0.02)
    for step in range(5):
        here, there = (Polar(*(part[:, i] for part in paths)) for i in (step, step + 1))
        seen_step = there.seen_from(here)
        gaps = [np.abs(seen_step.distance - centre(p).distance) for p in (straight, turn)]
        assert np.all(np.minimum(*gaps) < 1e-9)


def test_sampling_uses_only_the_generator_given() -> None:
    model = seen(Polar(0.16, 0.0, 0.0), Polar(0.1, 0.2, 0.4))
    one = model.sample_paths(4, 6, rng=np.random.default_rng(7))
    np.random.default_rng(0).random(3)
    two = model.sample_paths(4, 6, rng=np.random.default_rng(7))
    assert np.array_equal(one.distance, two.distance)


def test_copy_is_independent() -> None:
    model = seen(Polar(0.16, 0.0, 0.0))
    twin = model.copy()
    twin.observe(Polar(0.1, 0.0, 0.0))
    assert (model.observations, twin.observations) == (1, 2)
    assert model != twin
    assert model.predict(1) != twin.predict(1)


@pytest.mark.parametrize("pose", [(math.nan, 0, 0), (-0.1, 0, 0), (0.1, math.inf, 0), (0.1, 0, math.nan), (1e9, 0, 0)])
def test_bad_transitions_are_refused_and_not_counted(pose: tuple[float, float, float]) -> None:
    model = PreyModel()
    with pytest.raises(InputError, match="prey transition"):
        model.observe(Polar(*pose))
    assert model.is_empty


@pytest.mark.parametrize("steps", [-1, 1.5, True, "2"])
def test_bad_steps(steps: object) -> None:
    model = seen(Polar(0.1, 0.0, 0.0))
    with pytest.raises(InputError, match="steps"):
        model.predict(steps)
    with pytest.raises(InputError, match="steps"):
        model.sample_paths(steps, 2, rng=np.random.default_rng(0))


def test_other_bins_do_not_merge_and_bad_records_are_refused() -> None:
    model = seen(Polar(0.1, 0.0, 0.0))
    with pytest.raises(InputError, match="different bins"):
        model.merge(PreyModel(EffectAxes.standard(0.1)))
    record = model.to_dict()
    for change in ({"counts": [[0, 99, 0, 1]]}, {"counts": [[0, 0, 0, 0]]}, {"counts": 3}, {"angle_bins": 0}):
        with pytest.raises(InputError, match="not a stored prey model"):
            PreyModel.from_dict({**record, **change})
