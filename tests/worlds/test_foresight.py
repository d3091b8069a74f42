"""The prey's future is what the prey then does, where nothing disturbs it."""

from __future__ import annotations

import numpy as np
import pytest
from trial_cases import Trial

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.geometry import Pose
from bayeshunt.worlds.foresight import foresee

QUIET = {"prey.noise.slip": 0.0, "prey.noise.drift_sd": 0.0, "prey.sensor_noise": 0.0}


def trial(arena: str, **changes) -> Trial:
    settings = load_experiment("paper", {**QUIET, **changes})
    return Trial(
        settings.robot, settings.prey, settings.arenas[arena], settings.physics,
        hunter_pose=Pose(-0.4, -0.4, 0.0), prey_pose=Pose(0.1, 0.0, 0.7), catch_distance=1e-3,
    )  # fmt: skip


@pytest.mark.parametrize("arena", ["open", "walled"])
@pytest.mark.parametrize("begun", [0.0, 3.328, 9.984])
def test_what_is_foreseen_happens(arena, begun):
    """Without noise the prey then goes exactly there, whenever one looks; in walls it turns twice meanwhile."""
    world = trial(arena)
    if begun:
        world.run((0.0, 0.0), begun)
    times, poses = foresee(world.simulation, 20.0)
    for index in range(0, len(times) - 52, 52):
        here = world.prey.pose
        expected = (poses.x[index], poses.y[index])
        assert (here.x, here.y) == pytest.approx(expected, abs=2e-3)
        world.run((0.0, 0.0), 52 * world.physics.control_interval)
    assert times[-1] >= 20.0
    if arena == "walled":
        assert np.ptp(np.unwrap(poses.theta)) > 1.0


@pytest.mark.parametrize("begun", [0.0, 9.984])
@pytest.mark.parametrize(("width", "height"), [(0.9, 3.0), (3.0, 0.9)])
def test_a_prey_that_runs_into_a_wall_is_foreseen_along_it(width, height, begun):
    walls = {"arenas.walled.width": width, "arenas.walled.height": height, "prey.behaviour": "straight"}
    world = trial("walled", **walls)
    if begun:
        world.run((0.0, 0.0), begun)
    _, poses = foresee(world.simulation, 16.0)
    world.run((0.0, 0.0), 16.0)
    end = (poses.x[-1], poses.y[-1])
    assert end == pytest.approx(world.prey.pose[:2], abs=1e-3)
    assert end[0 if width < height else 1] == pytest.approx(0.45 - 0.0285, abs=2e-3)


def test_foreseeing_changes_nothing():
    one, other = trial("walled", **{"prey.noise.slip": 0.1}), trial("walled", **{"prey.noise.slip": 0.1})
    foresee(one.simulation, 10.0)
    for world in (one, other):
        world.run((0.03, 0.02), 10.0)
    assert one.prey.pose == other.prey.pose
    assert one.hunter.pose == other.hunter.pose


def test_noise_is_left_out():
    calm, noisy = trial("open"), trial("open", **{"prey.noise.slip": 0.5})
    (_, a), (_, b) = foresee(calm.simulation, 5.0), foresee(noisy.simulation, 5.0)
    assert np.array_equal(a.x, b.x)


def test_the_hunter_is_left_out():
    """A prey that senses the hunter is foreseen as if it were alone."""
    settings = load_experiment("paper", {**QUIET, "prey.senses_hunter": True})
    near = Trial(
        settings.robot, settings.prey, settings.arenas["open"], settings.physics,
        hunter_pose=Pose(0.12, 0.01, 0.0), prey_pose=Pose(0.0, 0.0, 0.0), catch_distance=1e-3,
    )  # fmt: skip
    _, poses = foresee(near.simulation, 5.0)
    assert np.abs(poses.y).max() < 1e-6
    assert poses.x[-1] > 0.15
