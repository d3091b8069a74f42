"""Babbling inside an arena."""

from __future__ import annotations

import numpy as np
import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import InputError
from bayeshunt.data.babbling_table import PROVENANCE_KEY
from bayeshunt.experiments.preparation import learn_room
from bayeshunt.worlds.exploring import explore


@pytest.fixture(scope="module")
def settings():
    return load_experiment("paper")


def test_track_starts_in_the_centre_and_stays_inside(settings):
    track = explore(settings.robot, settings.arenas["walled"], 60, 3)
    assert len(track) == 60 * 13
    assert track["interval"].tolist()[:14] == [*range(1, 14), 1]
    radius = 0.5 * settings.robot.body.diameter
    assert track[["x", "y"]].abs().to_numpy().max() <= 0.6 - radius + 1e-3
    assert np.hypot(*track.loc[0, ["x", "y"]].astype(float)) < 0.0576 * 3.328 / 13 * 1.1
    counts = track.groupby("gait")["step"].nunique()
    assert counts.tolist() == [6] * 10
    record = track.attrs[PROVENANCE_KEY]
    assert (record["kind"], record["seed"], record["arena"]["walled"]) == ("exploration", 3, True)


def test_same_seed_same_track_another_seed_another(settings):
    one, same, other = (explore(settings.robot, settings.arenas["walled"], 10, seed) for seed in (1, 1, 2))
    assert one.equals(same)
    assert not one["x"].equals(other["x"])


@pytest.mark.parametrize("physics_steps", [4, 10])
def test_a_time_step_shorter_than_its_intervals(settings, physics_steps):
    short = settings.robot.model_copy(update={"gait_duration": physics_steps * 0.032})
    track = explore(short, settings.arenas["walled"], 5, 0)
    assert track["interval"].tolist() == [*range(1, 14)] * 5
    ends = track.groupby("step")[["x", "y"]].nth(-1)
    assert len(ends.drop_duplicates()) == 5


@pytest.mark.parametrize(("steps", "seed", "message"), [(0, 1, "steps"), (5, -1, "seed")])
def test_wrong_numbers_are_refused(settings, steps, seed, message):
    with pytest.raises(InputError, match=message):
        explore(settings.robot, settings.arenas["open"], steps, seed)


def test_the_room_of_the_paper_is_found_and_the_open_has_no_walls():
    small = {"model.babbling_steps": 200}
    settings = load_experiment("paper", small)
    room = learn_room(settings, arena="walled", steps=600, seed=4)
    assert sorted((room.walls()["bearing_deg"].round() % 360).tolist()) == [0.0, 90.0, 180.0, 270.0]
    assert np.allclose(room.offsets, 0.6 - 0.0285, atol=2e-3)
    assert len(learn_room(settings, arena="open", steps=300, seed=4).offsets) == 0
    with pytest.raises(InputError, match="moon"):
        learn_room(settings, arena="moon")
