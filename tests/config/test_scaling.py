"""Another robot in an experiment: arenas and prey follow its length and its top speed, and the table says so."""

import json

import pytest

from bayeshunt.config.loading import load_experiment, load_robot
from bayeshunt.core.errors import ConfigError

PAPER = load_experiment("paper")


@pytest.mark.parametrize("robot", ["khepera", "car"])
def test_a_robot_of_the_same_length_and_top_speed_changes_nothing_else(robot):
    made = load_experiment("paper", {"robot": robot})
    assert (made.prey, made.arenas, made.protocol, made.scaled) == (PAPER.prey, PAPER.arenas, PAPER.protocol, "")


def test_lengths_and_speeds_follow_the_hunter():
    made = load_experiment("paper", {"robot": "hexapod", "protocol.hunter_x": 0.1})
    long, fast = 0.2 / 0.057, 0.258 / 0.0576
    assert made.arenas["walled"].width == pytest.approx(1.2 * long, rel=1e-5)
    assert made.prey.body.diameter == pytest.approx(0.2, rel=1e-5)
    assert made.prey.body.axle == pytest.approx(0.052 * long, rel=1e-5)
    assert made.prey.sensor_range == pytest.approx(0.05 * long, rel=1e-5)
    assert made.prey.speed == pytest.approx(0.048 * fast, rel=1e-5)
    assert made.prey.turn_rate == pytest.approx(0.8 * fast / long, rel=1e-5)
    assert made.prey.body.max_acceleration == pytest.approx(0.6 * fast**2 / long, rel=1e-5)
    assert made.prey.flee_distance == PAPER.prey.flee_distance  # in body lengths
    assert made.protocol.hunter_x == 0.1  # what is said stays
    assert made.robot == load_robot("hexapod")
    assert "200 mm long, top speed 258 mm/s" in made.scaled


def test_obstacles_follow_too():
    stones = [{"x": 0.2, "y": -0.1, "radius": 0.05}, {"x": 0.0, "y": 0.3, "width": 0.1, "height": 0.2, "angle": 0.5}]
    made = load_experiment(load_experiment("paper", {"arenas.walled.obstacles": stones}), {"robot": "hexapod"})
    disc, box = made.arenas["walled"].obstacles
    long = 0.2 / 0.057
    assert (disc.x, disc.y, disc.radius) == pytest.approx((0.2 * long, -0.1 * long, 0.05 * long), rel=1e-5)
    assert (box.y, box.width, box.height) == pytest.approx((0.3 * long, 0.1 * long, 0.2 * long), rel=1e-5)
    assert box.angle == 0.5


def test_what_is_overridden_besides_is_not_scaled_in_any_order():
    changes = {"prey.speed": 0.1, "robot": "hexapod", "arenas.walled.width": 2.0}
    for given in (changes, dict(reversed(changes.items()))):
        made = load_experiment(PAPER, given)
        assert (made.prey.speed, made.arenas["walled"].width) == (0.1, 2.0)
        assert made.arenas["walled"].height == pytest.approx(1.2 * 0.2 / 0.057, rel=1e-5)


def test_an_experiment_may_be_given_relative_to_its_hunter(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        """base = "paper"
        robot = "hexapod"
        [arenas.walled]
        in_bodies = true
        width = 21.0
        height = 20.0
        [prey]
        relative = true
        speed = 0.8
        sensor_range = 0.9
        [prey.body]
        diameter = 1.0
        axle = 0.9
        wheelbase = 0.8
        """
    )
    mine = load_experiment(path)
    assert (mine.arenas["walled"].width, mine.arenas["walled"].height) == (4.2, 4.0)
    assert mine.prey.speed == pytest.approx(0.8 * 0.258, rel=1e-5)
    assert (mine.prey.sensor_range, mine.prey.body.diameter, mine.prey.body.axle) == (0.18, 0.2, 0.18)
    small = load_experiment(path, {"robot": "khepera"})
    assert small.prey.speed == pytest.approx(0.8 * 0.0576, rel=1e-5)
    assert small.arenas["walled"].width == pytest.approx(21 * 0.057, rel=1e-5)
    assert load_experiment(mine, {"protocol.runs": 2}).prey == mine.prey  # not a second time


def test_evaluate_says_at_its_head_that_all_was_drawn_to_the_robot(bayeshunt):
    line = ["evaluate", "--set", "robot=hexapod", "--set", "model.babbling_steps=150", "--set", "protocol.thetas=[1.0]",
            "--set", "protocol.time_limit=3", "--arena", "open", "--planner", "reactive", "--runs", "1", "--jobs", "1",
            "--quiet"]  # fmt: skip
    out, _ = bayeshunt(*line)
    assert out.startswith("Arenas and prey are drawn to hexapod")
    assert "drawn to hexapod" in json.loads(bayeshunt(*line, "--json")[0])["scaled"]


@pytest.mark.parametrize(
    "wrong", ["prey = 3", "arenas = 3", "protocol = 3", "[prey]\nbody = 3", "[arenas]\nwalled = 3"]
)
def test_a_group_that_is_none_is_said_with_its_key(tmp_path, wrong):
    path = tmp_path / "mine.toml"
    path.write_text(f'name = "mine"\nrobot = "khepera"\n{wrong}\n')
    with pytest.raises(ConfigError, match=r"prey|arenas|protocol"):
        load_experiment(path, {"robot": "hexapod"})


def test_an_experiment_without_a_robot_takes_one(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('name = "mine"\n')
    assert load_experiment(path, {"robot": "hexapod"}).prey.speed == PAPER.prey.speed
