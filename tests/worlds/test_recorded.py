"""Recorded prey in the world: it goes where it went, whatever the hunter does."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.cli import main
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.geometry import Pose
from bayeshunt.data import tracks as tracks_file
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.worlds.foresight import foresee
from bayeshunt.worlds.recorded.path import path_of, read_path


def circle(name: str, radius: float = 5.0, speed: float = 1.2, seconds: float = 14.0, scene: str = "a") -> pd.DataFrame:
    """A walker on a circle, anticlockwise, starting at (radius, 0) and so facing up."""
    time = np.arange(0.0, seconds, 0.4)
    turn = speed / radius * time
    return pd.DataFrame({"id": name, "time": time, "x": radius * np.cos(turn), "y": radius * np.sin(turn),
                         "heading": np.nan, "confidence": np.nan, "scene": scene})  # fmt: skip


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "tracks.parquet"
    tracks_file.save(pd.concat([circle("17"), circle("18", scene="b"), circle("18")], ignore_index=True), path)
    return path


def following(file, individual="17", **changes):
    return {"prey.behaviour": f"recorded:{file}#{individual}", **changes}


def settings_of(file, individual="17", **changes):
    from bayeshunt.config.loading import load_experiment

    return load_experiment("follow", following(file, individual, **changes))


def test_the_way_starts_at_the_start_and_faces_ahead(file) -> None:
    way = path_of(f"recorded:{file}#17")
    assert way.duration == pytest.approx(13.6)
    assert way.at(0.0) == Pose(0.0, 0.0, 0.0)
    half = way.at(13.6 / 2)
    angle = 1.2 / 5 * 13.6 / 2  # on a circle to its left
    assert (half.x, half.y) == pytest.approx((5 * math.sin(angle), 5 * (1 - math.cos(angle))), abs=0.3)
    assert way.at(99.0) == pytest.approx(way.at(13.6))


def test_the_prey_is_where_it_was_whatever_the_hunter_does(file) -> None:
    way, running = path_of(f"recorded:{file}#17"), Pursuit(settings_of(file), "open", theta=1.0, seed=0)
    start = running.moment.poses["prey"]
    times, future = foresee(running.trial.world, 4.0)
    assert running.moment.poses["hunter"].relative(start).distance == pytest.approx(2.5)
    while not running.done:
        running.step("straight")
        for moment in running.moments:
            gone, want = start.relative(moment.poses["prey"]), way.at(moment.time)
            assert (gone.forward, -gone.right) == pytest.approx((want.x, want.y), abs=1e-4)
            assert math.cos(gone.heading + want.theta) == pytest.approx(1.0, abs=1e-7)
    at_four = way.at(4.0)
    there = start.relative(Pose(future.x[-1], future.y[-1], future.theta[-1]))
    assert times[-1] == pytest.approx(4.0)
    assert (there.forward, -there.right) == pytest.approx((at_four.x, at_four.y), abs=1e-3)


@pytest.mark.parametrize(
    ("behaviour", "says"),
    [
        ("recorded:{file}", 'expected "recorded:tracks.parquet#id"'),
        ("recorded:{file}#19", "no individual '19'; "),
        ("recorded:{file}#18", "2 scenes, several with an individual '18'; say which: #18@a"),
        ("recorded:{file}#18@c", "no scene 'c'"),
        ("recorded:nowhere.parquet#17", "nowhere.parquet: no such file"),
    ],
)
def test_what_cannot_be_followed_is_said(file, behaviour, says) -> None:
    with pytest.raises(BayesHuntError) as told:
        path_of(behaviour.format(file=file))
    assert says in str(told.value)
    assert "\n" not in str(told.value)


def test_walls_pixels_and_single_places_are_refused(file) -> None:
    with pytest.raises(BayesHuntError, match="goes through walls"):
        Pursuit(
            settings_of(file, **{"arenas.open.walled": True, "arenas.open.width": 9.0, "arenas.open.height": 9.0}),
            "open",
        )
    with pytest.raises(BayesHuntError, match="lengths are in px"):
        read_path(circle("1").assign(unit="px"), "1")
    with pytest.raises(BayesHuntError, match="no two places"):
        read_path(circle("1").head(1), "1")
    assert path_of(f"recorded:{file}#18@b").duration == pytest.approx(13.6)


def test_hunt_from_the_command_line(monkeypatch, capfd, file, tmp_path) -> None:
    def run(*words) -> int:
        monkeypatch.setattr("sys.argv", ["bayeshunt", *map(str, words)])
        with pytest.raises(SystemExit) as left:
            main()
        return left.value.code

    rows = bh.transitions(tracks_file.load(file), 0.8)
    bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity").save(tmp_path / "prey.json")
    line = ["hunt", "--preset", "follow", "--planner", "prediction", "--set", "model.babbling_steps=400", "--json"]
    line += ["--prey", f"recorded:{file}#17"]
    assert run(*line, "--prey-model", tmp_path / "prey.json") == 0
    assert '"caught": true' in capfd.readouterr().out
    assert run(*line, "--prey-model", tmp_path / "none.json") == 2
    assert "no such file" in capfd.readouterr().err
    bh.PreyModel.fit(bh.transitions(tracks_file.load(file), 0.4), given="speed").save(tmp_path / "short.json")
    assert run(*line, "--prey-model", tmp_path / "short.json") == 2
    assert "transitions of 0.4 s, a gait lasts 0.8 s" in capfd.readouterr().err
