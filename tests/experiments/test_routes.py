"""Which way round is chosen: looks around by hand, sides by hand, and the study on few hunts."""

import json

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.schema import ArenaSettings, ObstacleSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Pose
from bayeshunt.experiments.studies.routes import _shortest, _side
from bayeshunt.models.arena.scanning import scan
from bayeshunt.worlds.maps import map_of

BODY = 0.06  # a cell is 0.03 m
BARRIER = ArenaSettings(walled=True, obstacles=(ObstacleSettings(x=0.2, y=0.0, width=0.04, height=0.4),))


def look(**given):
    standard = {"looks": 3, "reach": 0.5, "above": False, "error": 0.0, "rng": np.random.default_rng(0)}
    return scan(map_of(BARRIER), Pose(0.0, 0.0, 0.0), BODY, **{**standard, **given})


def test_a_look_sees_what_is_before_a_barrier_and_from_above_what_is_behind():
    ground, raised = look(), look(above=True)
    for space in (ground, raised):
        assert space.at(0.12, 0.0) == pytest.approx(3.05 / 3.5)  # the hunter's centre can be there
        assert space.at(0.18, 0.0) == pytest.approx(0.05 / 3.5)  # not there: the barrier's face
    assert ground.at(0.36, 0.0) == pytest.approx(1.05 / 1.5)  # hidden: nothing is known to stand there
    assert raised.at(0.36, 0.0) == pytest.approx(3.05 / 3.5)
    assert raised.at(0.51, 0.0) == pytest.approx(0.1)  # beyond its reach


def test_looks_err_and_more_of_them_err_less():
    wrong = [
        np.mean(look(above=True, error=0.2, looks=looks, rng=np.random.default_rng(1)).at(
            *np.meshgrid(np.linspace(-0.3, 0.1, 9), np.linspace(-0.3, 0.3, 9))
        ) < 0.5)
        for looks in (1, 9)
    ]  # fmt: skip
    assert wrong[0] == pytest.approx(0.2, abs=0.15)
    assert wrong[1] < 0.05


def test_a_look_is_in_the_frame_of_the_hunter():
    turned = scan(
        map_of(BARRIER), Pose(0.0, 0.3, -np.pi / 2), BODY, looks=1, reach=0.5, above=True, error=0.0,
        rng=np.random.default_rng(0),
    )  # fmt: skip
    assert turned.at(0.3, 0.2) < 0.5  # the barrier is at (0.2, 0): 0.3 m ahead and 0.2 m to the left
    assert turned.at(0.3, -0.2) > 0.5


@pytest.mark.parametrize(
    ("way", "side"),
    [([(0, 0), (0.1, 0.2), (0.1, 0.6), (0, -0.9)], 1), ([(0.5, -0.49), (0.5, -0.51)], -1), ([(0.2, 0.4)], 0)],
)
def test_the_side_is_where_the_way_first_leaves_the_straight_line(way, side):
    assert _side(Pose(0, 0, 0), Pose(1.0, 0, 0), np.array(way)) == side


def test_the_shortest_way_of_preset_portia():
    settings = bh.load_experiment("portia")
    sides = {name: _shortest(settings, name, *settings.starting_poses(0.0)) for name in settings.arenas}
    assert sides == {"left": 1, "right": -1}


def test_who_knows_the_arena_chooses_right(khepera_model):
    """Two hunts with raised looks, two from the ground, two of a hunter that knows nothing and stays at the barrier.

    From the ground both ways look alike: it leaves the barrier in both arenas, to a side that its looks cannot tell.
    """
    table = bh.routes(explored=(0,), looks=(5,), maps=1, runs=1, seed=700, model=khepera_model).set_index("map")
    assert table.loc["raised looks", ["chose", "right", "reached"]].tolist() == [2, 2, 2]
    assert table.loc["looks", "chose"] == 2
    assert table.loc["gaits", ["chose", "reached"]].tolist() == [0, 0]
    assert table.loc["gaits", "time_s"] == 60.0


def test_a_side_is_chosen_towards_a_prey_that_stays(khepera_model):
    with pytest.raises(InputError, match="routes: the prey of 'clutter' moves"):
        bh.routes("clutter", model=khepera_model)


def test_the_command(bayeshunt):
    line = ["routes", "--looks", "5", "--maps", "1", "--runs", "1", "--set", "model.babbling_steps=300", "--set",
            "protocol.time_limit=4", "-q"]  # fmt: skip
    rows = json.loads(bayeshunt(*line, "--json")[0])
    assert [row["map"] for row in rows] == ["looks", "raised looks"]
    out, _ = bayeshunt(*line)
    assert "5 raised looks" in out
    assert "right in 50 %" in out
