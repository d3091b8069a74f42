"""The table of free space: counts by hand, probabilities with intervals, its file; and what a touch shows."""

import json

import numpy as np
import pandas as pd
import pytest
from scipy.stats import beta

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError, ModelFileError
from bayeshunt.models.arena.contacts import Contacts, expected_motion, find_walls
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.worlds.exploring import explore

CELL = 0.03


@pytest.fixture
def space():
    """Five visits ahead of the start, one of them two cells away; two hits beyond that."""
    visited = np.array([(0.0, 0.0), (0.01, 0.01), (0.03, 0.0), (0.03, 0.01), (0.06, -0.03)])
    return FreeSpace.of(CELL, visited, np.array([(0.09, -0.03), (0.092, -0.031)]))


def test_counts_by_hand(space):
    assert space.origin == (0, -1)
    assert space.visits.tolist() == [[0, 2], [0, 2], [1, 0], [0, 0]]
    assert space.hits.tolist() == [[0, 0], [0, 0], [0, 0], [2, 0]]
    assert space.at([0.0, 0.06, 0.09, 5.0], [0.0, -0.03, -0.03, 0.0]) == pytest.approx(
        [2.05 / 2.5, 1.05 / 1.5, 0.05 / 2.5, 0.1]
    )
    assert space.visited(np.array([0.0, 0.09, -9.0]), np.array([0.0, -0.03, 0.0])).tolist() == [True, False, False]


def test_the_table_says_how_sure_each_cell_is(space):
    table = space.table()
    assert table[["x", "y", "visits", "hits"]].to_numpy().tolist() == [
        [0.0, 0.0, 2, 0], [0.03, 0.0, 2, 0], [0.06, -0.03, 1, 0], [0.09, -0.03, 0, 2]
    ]  # fmt: skip
    first = table.iloc[0]
    assert first["p_free"] == pytest.approx(2.05 / 2.5)
    assert (first["low"], first["high"]) == pytest.approx(tuple(beta.ppf([0.025, 0.975], 2.05, 0.45)))
    assert ((table["low"] <= table["p_free"]) & (table["p_free"] <= table["high"])).all()
    narrow = space.table(level=0.5)
    assert (narrow["high"] - narrow["low"] < table["high"] - table["low"]).all()


def test_more_of_the_same_narrows_the_interval():
    widths = []
    for times in (1, 10, 100):
        row = FreeSpace.of(CELL, np.zeros((9 * times, 2)), np.zeros((times, 2))).table().iloc[0]
        widths.append(row["high"] - row["low"])
    assert widths[0] > 2 * widths[1] > 4 * widths[2]


@pytest.mark.parametrize(
    ("visits", "hits"), [([[1]], [[1, 2]]), ([[-1]], [[0]]), ([1], [1])], ids=["shapes", "negative", "flat"]
)
def test_wrong_counts_are_refused(visits, hits):
    with pytest.raises(DataError, match="free space"):
        FreeSpace(CELL, (0, 0), visits, hits)


def test_it_travels_with_the_room_and_damage_is_noticed(space, tmp_path):
    path = tmp_path / "room.json"
    RoomModel(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0), {}, space).save(path)
    again = RoomModel.load(path).space
    assert (again.cell, again.origin) == (space.cell, space.origin)
    assert again.visits.tolist() == space.visits.tolist()
    assert again.hits.tolist() == space.hits.tolist()
    text = path.read_text()
    path.write_text(text.replace('"cell": 0.03', '"cell": 0.04'))
    with pytest.raises(ModelFileError, match="checksum"):
        RoomModel.load(path)


def test_a_room_without_the_table_is_read_as_before(tmp_path):
    path = tmp_path / "room.json"
    RoomModel.empty().save(path)
    assert "space" not in json.loads(path.read_text())["content"]
    assert RoomModel.load(path).space is None


def test_it_shows_itself(space, tmp_path):
    assert "5 visits" in str(space)
    html = space._repr_html_()
    assert html.count("<title>") == 5  # four cells and the start
    assert "P(free) 0.82" in html
    for name, head in (("map.html", b"<!doctype html>"), ("map.png", b"\x89PNG"), ("map.svg", b"<?xml")):
        bh.write_map(space, tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(head)
    with pytest.raises(InputError, match=r"expected a file name that ends in \.html, \.png or \.svg"):
        bh.write_map(space, tmp_path / "map.pdf")
    with pytest.raises(InputError, match="expected a RoomModel or a FreeSpace"):
        bh.write_map(3, tmp_path / "map.html")


# --- touches --------------------------------------------------------------------------------------

BODY = 0.057


def touches(degrees, offset, along, *, slid=True):
    """So many touches at a wall in this direction, ``along`` metres apart from its foot."""
    a = np.radians(degrees)
    normal = np.array([np.cos(a), np.sin(a)])
    places = offset * normal + np.outer(along, [-normal[1], normal[0]])
    return places, np.repeat(normal[None], len(along), axis=0), np.full(len(along), slid)


def contacts(*parts):
    return Contacts(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def directions(walls):
    return sorted(round(float(np.degrees(np.arctan2(wall[1], wall[0])))) for wall in walls)


def test_a_wall_shows_itself_in_three_touches_of_one_place():
    few = contacts(touches(30.0, 0.4, [0.0, 0.001, 0.002]))
    (wall,) = find_walls(few, [], np.zeros((1, 2)), BODY)
    assert wall[:3] == pytest.approx([np.cos(np.pi / 6), 0.5, 0.4], abs=1e-6)
    assert find_walls(few.where(np.array([True, True, False])), [], np.zeros((1, 2)), BODY) == []


def test_a_line_that_joins_two_walls_is_none():
    """The hull of a room of which two walls were touched at one place each has a long edge between the two."""
    ahead, left = touches(0.0, 0.5, [-0.2, -0.19, -0.18]), touches(90.0, 0.5, [0.3, 0.31, 0.32])
    chord = np.array([0.62, 0.78])
    edge = (*chord / np.hypot(*chord), 0.2, 0.9, 20.0)
    assert directions(find_walls(contacts(ahead, left), [edge], np.zeros((1, 2)), BODY)) == [0, 90]
    wall = (1.0, 0.0, 0.501, 0.7, 20.0)  # an edge that the touches confirm stands as it is
    assert find_walls(contacts(ahead, left), [wall], np.zeros((1, 2)), BODY)[0] == wall


def test_what_was_passed_is_no_wall():
    """An obstacle's side is touched, but the robot was beyond it."""
    side = contacts(touches(0.0, 0.2, [0.0, 0.01, 0.02]))
    assert find_walls(side, [], np.array([[0.0, 0.0], [0.4, 0.3]]), BODY) == []


def test_a_corner_shows_its_second_wall():
    """A robot in the corner of a known wall is held from moving along it: there is another one."""
    known = touches(0.0, 0.5, np.linspace(-0.3, 0.3, 9))
    places = np.repeat([[0.5, 0.5]], 4, axis=0)
    askew = np.array([[np.cos(a), np.sin(a)] for a in (0.6, 0.8, 1.0, 1.1)])
    walls = find_walls(contacts(known, (places, askew, np.zeros(4, dtype=bool))), [], np.zeros((1, 2)), BODY)
    assert directions(walls) == [0, 90]
    assert walls[1][2] == pytest.approx(0.5, abs=1e-6)


def test_expected_motion_follows_the_gaits_path(khepera_model):
    """On a track that is every gait's own mean path, nothing is missing."""
    rows, here = [], np.zeros(3)
    for step, gait in enumerate(khepera_model.gaits.names):
        for interval, (ahead, right, turn) in enumerate(khepera_model.mean_paths[step], 1):
            c, s = np.cos(here[2]), np.sin(here[2])
            pose = (here[0] + c * ahead + s * right, here[1] + s * ahead - c * right, here[2] - turn)
            rows.append((step, gait, interval, *pose))
        here = np.array(pose)
    track = pd.DataFrame(rows, columns=["step", "gait", "interval", "x", "y", "theta"])
    before, expected = expected_motion(track, khepera_model)
    assert before + expected == pytest.approx(track[["x", "y"]].to_numpy(), abs=1e-9)
    assert np.isnan(expected_motion(track[track["interval"] < 5], khepera_model)[1]).all()


@pytest.mark.parametrize(("seed", "steps"), [(1005, 20), (1010, 50), (1001, 200)])
def test_walls_of_the_papers_room_are_found_early_and_no_others(khepera_model, seed, steps):
    settings = bh.load_experiment("paper")
    room = bh.learn_room(settings, steps=steps, seed=seed, model=khepera_model)
    assert len(room.offsets) >= 1
    assert set(np.abs(room.normals).round(1).ravel().tolist()) <= {0.0, 1.0}
    assert np.abs(room.offsets - 0.5715).max() < 0.02


def test_obstacles_are_in_the_table_of_free_space(khepera_model):
    settings = bh.load_experiment("detour")
    room = bh.learn_room(settings, arena="barrier", steps=400, seed=3, model=khepera_model)
    inside = room.space.at(np.full(5, 0.171), np.linspace(-0.15, 0.15, 5))  # the barrier's cells
    assert (inside < 0.5).all()
    assert room.space.hits[room.space.indices(0.171, 0.0)] > 0
    assert len(room.offsets) <= 4


def test_a_robot_whose_touches_cannot_be_told_has_the_walls_of_the_hull(khepera_model, monkeypatch):
    paper = bh.load_experiment("paper")
    start = paper.protocol.hunter_pose
    track = explore(paper.robot, paper.arenas["walled"], 150, 1003, physics=paper.physics, start=start)
    none = Contacts(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, dtype=bool))
    monkeypatch.setattr("bayeshunt.models.arena.rooms.find_contacts", lambda *given: none)
    room = RoomModel.fit(track, khepera_model)
    assert 2 <= len(room.offsets) <= 8  # the sides that it has met, and lines that join them
    assert room.offsets.max() == pytest.approx(0.57, abs=0.02)
    assert (room.blocked * 0.057 >= 2.0 * room.lengths).all()  # as dense as no hull in the open
    stumble = Contacts(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.ones(1, dtype=bool))
    monkeypatch.setattr("bayeshunt.models.arena.rooms.find_contacts", lambda *given: stumble)
    again = RoomModel.fit(track, khepera_model)  # what it touched is of no wall
    assert again.offsets.tolist() == room.offsets.tolist()
