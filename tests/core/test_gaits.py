"""Gaits: names, order, and what a repertoire can be made of."""

import math

import pytest

from bayeshunt.config.loading import load_robot
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire

GO, TURN = Gait("go", (0.1, 0.1)), Gait("turn", (0.1, 0.0))
BOTH = GaitRepertoire((GO, TURN), 0.05, 2.0)


def test_gaits_are_found_by_name_and_by_place():
    assert BOTH.names == ("go", "turn")
    assert [BOTH.index("turn"), BOTH.index(TURN)] == [1, 1]
    assert BOTH["turn"] is BOTH[1] is TURN
    assert list(BOTH) == [GO, TURN]
    for stranger in ("hop", 1, None, Gait("hop")):
        with pytest.raises(InputError, match="expected one of go, turn"):
            BOTH.index(stranger)


def test_a_gait_is_in_its_repertoire_by_name_too():
    assert "go" in BOTH
    assert TURN in BOTH
    assert "hop" not in BOTH
    assert Gait("go") not in BOTH  # another command


def test_what_a_repertoire_is_made_of():
    assert GaitRepertoire.of(BOTH) is BOTH
    assert GaitRepertoire.of(["go", TURN]).names == ("go", "turn")
    robot = load_robot("khepera")
    assert GaitRepertoire.of(robot) == robot.gaits


@pytest.mark.parametrize("wrong", ["go", None, 3])
def test_what_no_repertoire_is_made_of(wrong):
    with pytest.raises(InputError, match="gaits: expected a robot's gaits, or a list of names, got"):
        GaitRepertoire.of(wrong)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"gaits": ()}, "at least one gait"),
        ({"gaits": (GO, GO)}, "unique, repeated: go"),
        ({"body_length": 0.0}, "body_length > 0, got 0.0"),
        ({"body_length": math.inf}, "body_length > 0, got inf"),
        ({"duration": math.nan}, "duration > 0, got nan"),
        ({"duration": "3"}, "duration > 0, got '3'"),
    ],
)
def test_nonsense_is_refused(settings, message):
    with pytest.raises(InputError, match=message):
        GaitRepertoire(**{"gaits": (GO, TURN), **settings})
