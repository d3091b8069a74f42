"""The checks that users run over their own things: what ships passes, what breaks a rule is told which."""

import numpy as np
import pytest
from own_things import OMNI_GAITS, Delaying, Kinematic, LastSeen, Omni, OmniSettings, wheels

import bayeshunt as bh
from bayeshunt.protocols import Moment, Observation, Run
from bayeshunt.worlds.prey.behaviours import prey_names


@pytest.mark.parametrize("arena", ["open", "walled"])
def test_the_world_that_ships_keeps_the_rules(arena):
    bh.check_world("box2d", arena=arena)


def test_things_of_ones_own_keep_the_rules():
    bh.register_world("kinematic", Kinematic)
    bh.check_world("kinematic")
    bh.register_prey_model("last", LastSeen)
    bh.check_prey_model("last")
    bh.register_body("omni", Omni, settings=OmniSettings)
    gaits = [{"name": n, "command": wheels(*t)} for n, t in OMNI_GAITS.items()]
    robot = {"name": "omni", "body": {"drive": "omni"}, "gait": gaits}
    bh.check_body(bh.load_experiment("paper", {"robot": robot}).robot)


@pytest.mark.parametrize("robot", ["khepera", "car"])
def test_the_bodies_that_ship_keep_the_rules(robot):
    bh.check_body(robot)


@pytest.mark.parametrize("behaviour", prey_names())
def test_the_prey_that_ship_keep_the_rules(behaviour):
    bh.check_prey(behaviour)


def test_perception_and_prey_model_that_ship_keep_the_rules():
    bh.check_sensor("exact")
    bh.check_tracker("exact")
    bh.check_prey_model("counts")


class Forgetful(Kinematic):
    """Never stops."""

    def reached(self, until):
        return False


class Clockless(Kinematic):
    """Tells only the end of a run."""

    def run(self, gaits, duration, until=None):
        run = super().run(gaits, duration, until)
        return Run(run.moments[-1:], run.stopped)


class Noisy(Kinematic):
    """Draws from numpy's global generator."""

    def reset(self, start, streams):
        np.random.random()  # noqa: NPY002
        return super().reset(start, streams)


class Elsewhere(Kinematic):
    """Puts bodies where it likes."""

    def reset(self, start, streams):
        return super().reset({name: bh.Pose(pose.x + 1.0, pose.y, pose.theta) for name, pose in start.items()}, streams)


class Deaf(Kinematic):
    """The same noise, whatever the seed."""

    def reset(self, start, streams):
        return super().reset(start, {name: np.random.default_rng(0) for name in streams})


@pytest.mark.parametrize(
    ("world", "fault"),
    [
        (Forgetful, "does not say that who is within reach is reached"),
        (Clockless, "lets .* s pass between two moments"),
        (Noisy, "used numpy's global generator"),
        (Elsewhere, "put the hunter at"),
        (Deaf, "does not use its generators"),
    ],
)
def test_a_world_that_breaks_a_rule_is_told_which(world, fault):
    bh.register_world("mine", world)
    with pytest.raises(bh.BayesHuntError, match=f"world 'mine' {fault}"):
        bh.check_world("mine")


class Doubling(LastSeen):
    def observe(self, transition):
        super().observe(transition)
        self.observations += 1


class Sharing(LastSeen):
    def copy(self):
        return self


@pytest.mark.parametrize(
    ("model", "fault"), [(Doubling, "has 2 observations after 1"), (Sharing, "learns what its copy observes")]
)
def test_a_prey_model_that_breaks_a_rule_is_told_which(model, fault):
    bh.register_prey_model("mine", model)
    with pytest.raises(bh.BayesHuntError, match=f"prey model 'mine' {fault}"):
        bh.check_prey_model("mine")


class Blind:
    """Gives no frame."""

    def __init__(self, context):
        pass

    def sense(self, run, map, *, rng):
        return Observation(run.moments[-1].time, run.moments[-1].poses["hunter"])


class Undrawn(Blind):
    def sense(self, run, map, rng=None):
        return super().sense(run, map, rng=rng)


@pytest.mark.parametrize(("sensor", "fault"), [(Blind, "tells no frame"), (Undrawn, "senses without rng")])
def test_a_sensor_that_breaks_a_rule_is_told_which(sensor, fault):
    bh.register_sensor("mine", sensor)
    with pytest.raises(bh.BayesHuntError, match=f"sensor 'mine' {fault}"):
        bh.check_sensor("mine")


class Impure(Delaying):
    """Keeps what it has seen itself."""

    count = 0

    def update(self, belief, gait, observation, *, rng):
        Impure.count += 1
        late = super().update(belief, gait, observation, rng=rng)
        return late._replace(mean=late.mean._replace(x=late.mean.x + Impure.count))


def test_a_tracker_that_breaks_a_rule_is_told_which():
    bh.register_tracker("mine", Delaying)
    with pytest.raises(AttributeError):  # it does not bear a prey that is not seen: its own error, as it comes
        bh.check_tracker("mine")


@pytest.mark.parametrize(
    ("door", "name"),
    [
        (bh.check_world, "box3d"), (bh.check_sensor, "eye"), (bh.check_tracker, "dog"), (bh.check_prey_model, "mind"),
        (bh.check_prey, "rabbit"),
    ],
)  # fmt: skip
def test_a_name_that_nobody_knows(door, name):
    with pytest.raises(bh.InputError, match=f"unknown .*'{name}'"):
        door(name)


@pytest.mark.parametrize(
    ("register", "arguments"),
    [
        (bh.register_body, ("differential", Omni)), (bh.register_body, ("", Omni)), (bh.register_body, ("x", 3)),
        (bh.register_world, ("box2d", Kinematic)), (bh.register_world, (3, Kinematic)), (bh.register_world, ("x", "y")),
        (bh.register_sensor, ("exact", Blind)), (bh.register_sensor, ("x", None)),
        (bh.register_tracker, ("exact", Delaying)),
        (bh.register_tracker, (" ", Delaying)), (bh.register_prey_model, ("counts", LastSeen)),
        (bh.register_prey_model, ("x", 1.0)),
    ],
)  # fmt: skip
def test_what_cannot_be_registered_is_refused(register, arguments):
    with pytest.raises(bh.InputError):
        register(*arguments)


def test_what_is_made_under_a_name_must_be_one(khepera_model):
    planner = bh.make_planner("reactive", khepera_model)
    for register, key in (
        (bh.register_world, "world"), (bh.register_sensor, "sensing.sensor"), (bh.register_tracker, "sensing.tracker"),
        (bh.register_prey_model, "prey.model"),
    ):  # fmt: skip
        register("mine", lambda context: Moment(0.0, {}))
        with pytest.raises(bh.InputError, match=r"'mine'.*is no bayeshunt\.protocols\."):
            bh.hunt(bh.load_experiment("paper", {key: "mine"}), planner)
