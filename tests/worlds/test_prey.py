"""One conformance check over every prey behaviour, and what each of them is for."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from trial_cases import Trial

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ArenaSettings, BodySettings, NoiseSettings, PreySettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Pose
from bayeshunt.worlds.prey.behaviours import Context, behaviours, build_prey, prey_names, register_prey
from bayeshunt.worlds.prey.proximity import proximity

ORIGIN, AHEAD = Pose(0.0, 0.0, 0.0), Pose(0.3, 0.0, 0.0)
QUIET = NoiseSettings(slip=0.0, drift_sd=0.0)


def arena_with(prey, *, walled=False, seed=0, hunter=ORIGIN, at=AHEAD):
    paper = load_experiment("paper")
    return Trial(
        paper.robot, prey, ArenaSettings(walled=walled), paper.physics, seeds=[(seed, k) for k in range(3)],
        hunter_pose=hunter, prey_pose=at, catch_distance=0.01,
    )  # fmt: skip


def track(prey, seconds=12.0, **where):
    arena, moments = arena_with(prey, **where), []
    arena.run((0.0, 0.0), seconds, moments)
    return np.array([m.poses["prey"] for m in moments])


@pytest.mark.parametrize("walled", [False, True])
@pytest.mark.parametrize("behaviour", prey_names())
def test_conformance(behaviour, walled):
    prey = PreySettings(behaviour=behaviour)
    first, again = track(prey, walled=walled, seed=3), track(prey, walled=walled, seed=3)
    np.testing.assert_array_equal(first, again)  # same seed, same track
    assert not np.array_equal(first, track(prey, walled=walled, seed=4))
    assert np.isfinite(first).all()
    steps = np.hypot(*np.diff(first[:, :2], axis=0).T) / 0.064
    assert steps.max() < 0.048 * 2.5  # never much beyond its speed
    if walled:
        assert np.abs(first[:, :2]).max() < 0.6 - 0.0285 + 0.002  # never in a wall


def test_braitenberg_in_free_space_goes_straight_at_its_free_speed():
    path = track(PreySettings(behaviour="braitenberg", noise=QUIET), seconds=10.0)
    assert path[-1][1] == pytest.approx(0.0, abs=1e-6)
    assert path[-1][0] == pytest.approx(0.3 + 0.48, abs=0.005)


@pytest.mark.parametrize("pose", [(0.55, 0.1, 0.4), (0.53, 0.55, 0.7), (0.2, -0.56, -1.2)])
def test_braitenberg_wheels_by_hand(pose):
    weights = [(-2, 4), (-3, 5), (-7, 7), (7, -6), (5, -4), (4, -2), (-0.5, -0.5), (-0.5, -0.5)]  # Webots' Khepera
    settings = PreySettings(sensor_noise=0.0, speed=0.06)
    prey = build_prey(Context(settings, ArenaSettings(walled=True), 0.057, 0.064, np.random.default_rng(0)))
    values = proximity(*pose, 0.05, (0.6, 0.6), None)
    assert any(0 < value < 1023 for value in values)
    units = [sum(w[i] * (1 - value / 512) for w, value in zip(weights, values, strict=True)) for i in (0, 1)]
    expected = [0.06 / 3 * max(-10.0, min(10.0, unit)) for unit in units]
    assert prey.act(*pose, 0.0, 0.0) == pytest.approx(expected, rel=1e-12)


def test_braitenberg_turns_away_from_a_wall_before_it_touches():
    path = track(PreySettings(behaviour="braitenberg", noise=QUIET, sensor_noise=0.0), seconds=20.0, walled=True)
    assert path[:, 0].max() < 0.6 - 0.0285 + 0.001
    assert abs(path[-1][2]) > 0.3


@pytest.mark.parametrize("times", [0.5, 2.0, 3.5])
def test_the_sensors_of_another_body_sit_where_a_kheperas_do(times):
    """A world drawn to scale, in which everything is ``times`` as large, looks the same."""
    pose, hunter = (0.55, 0.1, 0.4), (0.5, 0.14)
    wheels = []
    for scale in (1.0, times):
        body = BodySettings(diameter=0.057 * scale)
        settings = PreySettings(sensor_noise=0.0, senses_hunter=True, sensor_range=0.05 * scale, body=body)
        arena = ArenaSettings(walled=True, width=1.2 * scale, height=1.2 * scale)
        prey = build_prey(Context(settings, arena, 0.057 * scale, 0.064, np.random.default_rng(0)))
        x, y, theta = pose
        wheels.append(prey.act(x * scale, y * scale, theta, hunter[0] * scale, hunter[1] * scale))
    assert wheels[0] != pytest.approx((0.048, 0.048), rel=0.1)  # it sees something
    assert wheels[1] == pytest.approx(wheels[0], rel=1e-9)


@pytest.mark.parametrize("diameter", [0.057, 0.2])
def test_a_body_of_any_size_leaves_the_wall(diameter):
    """Sensors that end inside a body see the wall when it is touched, too late: it pushes along it for ever."""
    body = BodySettings(diameter=diameter, axle=0.9 * diameter)
    prey = PreySettings(noise=QUIET, sensor_noise=0.0, speed=0.06, body=body)
    paper = load_experiment("paper")
    arena = Trial(
        paper.robot, prey, ArenaSettings(walled=True, width=3.0, height=3.0), paper.physics,
        hunter_pose=Pose(-1.0, -1.0, 0.0), prey_pose=Pose(1.0, 0.0, 0.3), catch_distance=0.01,
    )  # fmt: skip
    moments = []
    arena.run((0.0, 0.0), 30.0, moments)
    path = np.array([m.poses["prey"] for m in moments])
    assert path[:, 0].max() > 1.35 - 0.5 * (diameter - 0.057)  # it came to the wall ...
    assert path[:, 0].max() < 1.5 - 0.5 * diameter + 0.001
    assert path[-1][0] < 1.3  # ... and went


def test_braitenberg_sees_the_hunter_only_if_told_to():
    near = {"hunter": ORIGIN, "at": Pose(-0.08, 0.02, 0.0), "seconds": 3.0}
    blind = track(PreySettings(senses_hunter=False, noise=QUIET), **near)
    seeing = track(PreySettings(senses_hunter=True, noise=QUIET), **near)
    assert abs(blind[5][2]) < 1e-6
    assert abs(seeing[5][2]) > 0.01


def test_evader_turns_away_only_when_near():
    far = track(PreySettings(behaviour="evader", noise=QUIET, flee_distance=1.0), at=Pose(0.3, 0.0, 1.0))
    assert np.ptp(far[:, 2]) < 1e-6
    fleeing = track(PreySettings(behaviour="evader", noise=QUIET, flee_distance=8.0), at=Pose(0.2, 0.0, math.pi - 0.5))
    x, y, theta = fleeing[-1]
    assert np.hypot(x, y) > 0.3  # it came towards the hunter and now leaves
    assert math.cos(theta - math.atan2(y, x)) > 0.99


def test_random_walk_wanders():
    path = track(PreySettings(behaviour="random_walk", noise=QUIET), seconds=20.0)
    assert np.ptp(np.unwrap(path[:, 2])) > 1.0


def test_unknown_behaviour_names_the_known_ones():
    context = Context(PreySettings(behaviour="rabbit"), ArenaSettings(), 0.057, 0.064, np.random.default_rng(0))
    with pytest.raises(InputError, match=r"rabbit.*braitenberg"):
        build_prey(context)


def test_a_behaviour_of_ones_own():
    class Still:
        def __init__(self, context):
            pass

        def act(self, x, y, theta, hunter_x, hunter_y):
            return 0.0, 0.0

    register_prey("still", Still)
    path = track(PreySettings(behaviour="still", noise=QUIET), seconds=2.0)
    np.testing.assert_allclose(path[-1], (0.3, 0.0, 0.0), atol=1e-7)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (None, "gave None; expected (left, right), two finite wheel speeds [m/s]"),
        ((0.1, math.nan), "gave (0.1, nan); expected"),
        ((0.1, 0.1, 0.1), "gave a value of type tuple; expected"),
        (("fast", 0.1), "gave a value of type tuple; expected"),
    ],
)
def test_a_wrong_answer_of_a_prey_of_ones_own_is_said_with_its_name(monkeypatch, answer, said):
    monkeypatch.setattr("bayeshunt.worlds.prey.behaviours._BEHAVIOURS", dict(behaviours()))
    register_prey("odd", lambda context: SimpleNamespace(act=lambda *where: answer))
    with pytest.raises(InputError) as caught:
        track(PreySettings(behaviour="odd"))
    assert f"prey 'odd': act() {said}" in str(caught.value)


def test_a_prey_of_ones_own_that_cannot_act_is_said_and_any_two_numbers_will_do(monkeypatch):
    monkeypatch.setattr("bayeshunt.worlds.prey.behaviours._BEHAVIOURS", dict(behaviours()))
    register_prey("idle", lambda context: object())
    with pytest.raises(
        InputError, match=r"^prey 'idle' has no method act\(x, y, theta, hunter_x, hunter_y\) -> \(left"
    ):
        track(PreySettings(behaviour="idle"))
    register_prey("own", lambda context: SimpleNamespace(act=lambda *where: np.array([0.048, 0.048])))
    as_shipped = [track(PreySettings(behaviour=name)) for name in ("own", "straight")]
    assert np.array_equal(*as_shipped)
