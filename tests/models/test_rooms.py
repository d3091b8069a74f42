"""Rooms: walls from a made-up track, from the real one, and the room file."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from bayeshunt.core.errors import DataError, ModelFileError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Pose
from bayeshunt.models.arena.rooms import RoomModel, _held_up, _hull, _merge
from bayeshunt.models.body.forward import ForwardModel

#: Walls ahead, to the left and to the right; nothing behind.
THREE_SIDES = [(1, 0, 0.3), (0, 1, 0.25), (0, -1, 0.35)]


@pytest.fixture(scope="module")
def model():
    """One gait: 0.2 m straight ahead."""
    rows = pd.DataFrame({"gait": ["go"] * 3, "distance": [0.2] * 3, "angle": [0.0] * 3, "heading": [0.0] * 3})
    return ForwardModel.fit(rows, GaitRepertoire((Gait("go"),), 0.05, 3.0))


def made_up_track(walls, steps=800, seed=0):
    """A robot that turns at will before it goes 0.2 m, and slides along half-planes (nx, ny, offset)."""
    rng = np.random.default_rng(seed)
    rows, place = [], np.zeros(2)
    for step in range(steps):
        theta = rng.uniform(-np.pi, np.pi)
        # The turn before the step is a row of the step before.
        if rows:
            rows[-1]["theta"] = theta
        else:
            theta = 0.0
        for interval in range(1, 5):
            place = place + 0.05 * np.array([np.cos(theta), np.sin(theta)])
            for nx, ny, offset in walls:
                place = place - max(0.0, place @ np.array([nx, ny]) - offset) * np.array([nx, ny])
            rows.append(
                {"step": step, "gait": "go", "interval": interval, "x": place[0], "y": place[1], "theta": theta}
            )
    return pd.DataFrame(rows)


def test_hull_by_hand():
    square = np.array([[0, 0], [2, 0], [2, 1], [0, 1]], dtype=float)
    inside = np.array([[1, 0.5], [1, 0.0], [0.3, 0.9]])
    assert _hull(np.concatenate([inside, square, square])).tolist() == square.tolist()


def test_steps_that_end_elsewhere_than_their_gait_leads_were_held_up():
    gaits = GaitRepertoire((Gait("go"), Gait("veer")), 0.05, 3.0)
    rows = {"gait": ["go", "veer"], "distance": [0.2, 0.15], "angle": [0.0, 0.6], "heading": [0.0, 0.9]}
    model = ForwardModel.fit(pd.DataFrame(rows), gaits)
    here, track, expected = Pose(0.0, 0.0, 0.0), [], []
    for step, (name, off) in enumerate([("veer", 0.0), ("go", 0.049), ("veer", 0.051), ("go", 0.0), ("veer", 0.04)]):
        led = here.compose(model.predict(name))
        here = led._replace(x=led.x + 0.6 * off, y=led.y - 0.8 * off)  # a body length is 0.05 m
        for interval in (1, 2):
            track.append((step, name, interval, *(here if interval == 2 else Pose(9.0, 9.0, 9.0))))
            expected.append(off > 0.05)
    table = pd.DataFrame(track, columns=["step", "gait", "interval", "x", "y", "theta"])
    assert _held_up(table, model).tolist() == expected


def test_a_short_step_is_held_up_by_a_share_of_its_length():
    """A robot that decides often is stopped by far less than its own length: three tenths of its longest step."""
    rows = pd.DataFrame({"gait": ["go"], "distance": [0.01], "angle": [0.0], "heading": [0.0]})
    model = ForwardModel.fit(rows, GaitRepertoire((Gait("go"),), 0.05, 0.1))
    columns = ["step", "gait", "interval", "x", "y", "theta"]
    track = pd.DataFrame([(0, "go", 1, 0.0072, 0.0, 0.0), (1, "go", 1, 0.0140, 0.0, 0.0)], columns=columns)
    assert _held_up(track, model).tolist() == [False, True]


def test_walls_of_a_rectangle(model):
    room = RoomModel.fit(made_up_track([(1, 0, 0.4), (-1, 0, 0.3), (0, 1, 0.5), (0, -1, 0.35)]), model)
    table = room.walls()
    table = table.assign(bearing_deg=(table["bearing_deg"] + 45) % 360).sort_values("bearing_deg")
    assert np.allclose(table["bearing_deg"], [45, 135, 225, 315], atol=0.5)  # ahead, right, behind, left
    assert np.allclose(table["offset_m"], [0.4, 0.35, 0.3, 0.5], atol=1e-3)
    assert (table["blocked"] > 50).all()


def test_a_slanting_wall(model):
    corner = np.sqrt(0.5)
    walls = [(corner, corner, 0.3), (-corner, corner, 0.3), (corner, -corner, 0.4), (-corner, -corner, 0.4)]
    room = RoomModel.fit(made_up_track(walls), model)
    assert sorted(room.offsets.round(3).tolist()) == [0.3, 0.3, 0.4, 0.4]
    assert np.allclose(np.abs(room.normals), corner, atol=0.01)


def test_no_wall_where_nothing_was_ever_in_the_way(model):
    assert len(RoomModel.fit(made_up_track([], steps=300), model).offsets) == 0
    three = RoomModel.fit(made_up_track(THREE_SIDES), model)
    found = sorted(zip(*three.normals.T, three.offsets, strict=True))
    assert np.allclose(found, sorted(THREE_SIDES), atol=0.01)


BODY = 0.05


def edge(degrees, offset, length):
    """One row of the edges of a hull."""
    return [np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), offset, length]


def touching(degrees, offset, count, gap=0.0):
    """So many poses ``gap`` metres before the wall at ``offset`` in this direction, side by side."""
    normal = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    aside = np.array([-normal[1], normal[0]])
    return (offset - gap) * normal + np.linspace(-0.1, 0.1, count)[:, None] * aside


@pytest.mark.parametrize(("apart", "walls"), [(9.9, 1), (10.1, 2), (-9.9, 1), (-10.1, 2)])
def test_edges_within_ten_degrees_are_one_wall(apart, walls):
    """The longest says where the wall is and all of them how long it is."""
    edges = np.array([edge(30.0, 0.4, 0.5), edge(30.0 + apart, 0.38, 0.2)])
    held = np.concatenate([touching(30.0, 0.4, 20), touching(30.0 + apart, 0.38, 20)])
    found = _merge(edges, held, BODY)
    assert len(found) == walls
    assert found[0][:3] == pytest.approx(edge(30.0, 0.4, 0.5)[:3])
    assert [wall[3] for wall in found] == pytest.approx([0.7] if walls == 1 else [0.5, 0.2])


@pytest.mark.parametrize(("length", "walls"), [(0.074, 0), (0.076, 1)])
def test_a_wall_is_at_least_one_and_a_half_bodies_long(length, walls):
    held = touching(0.0, 0.4, 20)
    assert len(_merge(np.array([edge(0.0, 0.4, length)]), held, BODY)) == walls
    parts = np.array([edge(0.0, 0.4, length / 2), edge(5.0, 0.4, length / 2)])  # together as long
    assert len(_merge(parts, held, BODY)) == walls


@pytest.mark.parametrize(("count", "gap", "walls"), [(9, 0.0, 0), (10, 0.0, 1), (10, 0.0049, 1), (40, 0.0051, 0)])
def test_a_wall_is_touched_by_ten_blocked_poses_within_a_tenth_of_a_body(count, gap, walls):
    far = touching(0.0, 0.2, 30)  # held up elsewhere
    found = _merge(np.array([edge(0.0, 0.4, 0.5)]), np.concatenate([far, touching(0.0, 0.4, count, gap)]), BODY)
    assert len(found) == walls
    assert [wall[4] for wall in found] == [count] * walls


@pytest.mark.parametrize(
    ("spoil", "message"),
    [(lambda t: t.drop(columns="gait"), "'gait' is missing"), (lambda t: t.assign(x=np.nan), "finite"),
     (lambda t: t.assign(theta=t["theta"].where(t["step"] != 2)), "finite x, y and theta"),
     (lambda t: t.head(2), "three"), (lambda t: t.assign(x=0.0, y=0.0), "at least three places")],
)  # fmt: skip
def test_wrong_tracks_are_refused(model, spoil, message):
    with pytest.raises(DataError, match=message):
        RoomModel.fit(spoil(made_up_track([], steps=5)), model)


def test_the_file_comes_back_and_notices_damage(model, tmp_path):
    room = RoomModel.fit(made_up_track(THREE_SIDES), model)
    path = tmp_path / "room.json"
    room.save(path)
    again = RoomModel.load(path)
    assert again.normals.tolist() == room.normals.tolist()
    assert again.walls().equals(room.walls())
    with pytest.raises(ValueError, match="read-only"):
        again.offsets[0] = 0.0
    record = json.loads(path.read_text())
    record["content"]["offsets"][0] += 0.01
    path.write_text(json.dumps(record))
    with pytest.raises(ModelFileError, match="checksum"):
        RoomModel.load(path)
    for text in ("{", "[]", '{"content": {}}', json.dumps({**record, "kind": "soup"})):
        path.write_text(text)
        with pytest.raises(ModelFileError, match=str(path)):
            RoomModel.load(path)
    with pytest.raises(ModelFileError, match=r"no such file; make one with: bayeshunt explore --out .*none\.json"):
        RoomModel.load(tmp_path / "none.json")
    with pytest.raises(ModelFileError, match="is a folder; give a file made by: bayeshunt explore"):
        RoomModel.load(tmp_path)
    with pytest.raises(ModelFileError, match="expected the name of a file made by: bayeshunt explore; got 3"):
        RoomModel.load(3)
