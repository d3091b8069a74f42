"""explore, and an evaluation that uses what it found, as a user types them."""

import json

import pytest

SMALL = ["--set", "protocol.thetas=[1.0]", "--set", "model.babbling_steps=200"]


def test_explore_to_evaluation(bayeshunt):
    paper = ["--preset", "paper", *SMALL]  # its walls are 0.6 m from the centre
    out, _ = bayeshunt("explore", "--out", "room.json", "--steps", "300", *paper, "--json")
    walls = json.loads(out)["walls"]
    assert len(walls) == 4
    assert all(abs(wall["offset_m"] - 0.5715) < 0.005 for wall in walls)
    out, _ = bayeshunt("evaluate", "--planner", "intercept_walls", "--arena", "walled", "--runs", "2", "--jobs", "1",
                       "--set", "planner.intercept_walls.room=room.json", *paper, "--json")  # fmt: skip
    facts = json.loads(out)
    assert facts["rows"][-1]["runs"] == 2
    assert facts["not_ab_initio"] == ["intercept_walls"]


def test_an_arena_without_walls_is_said_in_words(bayeshunt):
    out, _ = bayeshunt("explore", "--out", "room.json", "--arena", "open", "--steps", "50", *SMALL)
    said, following = out.splitlines()
    assert said == "room.json: no walls found; 50 gaits met none"
    assert following.startswith("next: bayeshunt evaluate --planner intercept_walls --arena open ")


def test_walls_are_counted_and_listed(bayeshunt):
    out, _ = bayeshunt("explore", "--out", "room.json", "--steps", "300", *SMALL)
    counted, _, *walls, following = out.splitlines()
    assert counted == "room.json: 4 walls"
    assert len(walls) == 4
    assert following.startswith("next: ")


def test_an_evaluation_explores_by_itself(bayeshunt):
    """Without a file the hunter babbles in each arena first: ab initio, and the same as with that room in a file."""
    line = ["evaluate", "--planner", "intercept_walls", "--runs", "2", "--seed", "3", "--jobs", "1", *SMALL, "--json"]
    facts = json.loads(bayeshunt(*line)[0])
    assert facts["not_ab_initio"] == []
    bayeshunt("explore", "--out", "room.json", "--seed", "3", *SMALL)
    given = json.loads(bayeshunt(*line, "--set", "planner.intercept_walls.room=room.json", "--arena", "walled")[0])
    alone = [row for row in facts["rows"] if row["arena"] == "walled"]
    assert [row["mean_time_s"] for row in alone] == [row["mean_time_s"] for row in given["rows"]]


def test_a_hunt_explores_by_itself(bayeshunt):
    out, _ = bayeshunt("hunt", "--planner", "intercept_walls", "--arena", "walled", *SMALL, "--json")
    assert json.loads(out)["caught"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["explore", "--out", "r.json", "--arena", "moon"], "unknown arena 'moon'"),
        (["explore", "--out", "r.json", "--steps", "0"], "steps: expected a whole number"),
        (["explore", "--out", "no/r.json"], "does not exist"),
    ],
)
def test_wrong_input_is_one_line(bayeshunt, tmp_path, arguments, message):
    _, err = bayeshunt(*arguments, *SMALL, status=2)
    assert len(err.strip().splitlines()) == 1
    assert message in err
    assert not list(tmp_path.iterdir())
