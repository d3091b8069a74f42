"""The road is open: a body, a world, a prey model and a tracker of one's own hunt, and no module was touched."""

import math

import numpy as np
import pytest
from own_things import OMNI_GAITS, Delaying, Kinematic, LastSeen, Omni, OmniSettings, wheels

import bayeshunt as bh

KEYS = ("front", "left", "right")


def omni_robot():
    bh.register_body("omni", Omni, commands=KEYS, settings=OmniSettings)
    gaits = [{"name": n, **dict(zip(KEYS, wheels(*t), strict=True))} for n, t in OMNI_GAITS.items()]
    body = {"drive": "omni", "diameter": 0.06, "arm": 0.025, "top_speed": 0.06}
    robot = {"name": "omni", "body": body, "gait": gaits, "gait_duration": 2.0}
    return bh.load_experiment("paper", {"robot": robot}).robot


def settings_with(**changes):
    return bh.load_experiment("paper", changes)


def test_a_body_with_three_actuators_hunts():
    robot = omni_robot()
    settings = settings_with(robot=robot.model_dump(), **{"prey.speed": 0.03})
    frame = bh.babble(settings.robot, 210, 0)
    sideways = frame[frame["gait"] == "left"]
    assert sideways["angle"].mean() == pytest.approx(-math.pi / 2, abs=0.15)  # it moves to its left without turning
    assert sideways["heading"].abs().mean() < 0.2
    assert sideways["distance"].mean() == pytest.approx(0.12, rel=0.1)
    model = bh.ForwardModel.fit(frame, settings.robot.gaits)
    results = bh.evaluate(settings, runs=1, planners=["prediction", "kinematic_limit"], arenas="open", model=model)
    assert results[results["planner"] == "prediction"]["caught"].mean() > 0.7


def test_a_body_with_three_actuators_draws_its_own_noise_for_each():
    frame = bh.babble(omni_robot(), 70, 0)
    assert frame.equals(bh.babble(omni_robot(), 70, 0))
    assert not frame.equals(bh.babble(omni_robot(), 70, 1))


def toml_robot(folder, drive, gait, body=""):
    path = folder / "mine.toml"
    path.write_text(f'name = "mine"\n[body]\ndrive = "{drive}"\n{body}\n[[gait]]\nname = "go"\n{gait}\n')
    return path


@pytest.mark.parametrize(
    ("drive", "gait", "body", "message"),
    [
        ("omni", "front = 0.1\nleft = 0.1", "", "gait 'go' of a omni drive needs front, left and right"),
        ("omni", "front = 0.1\nleft = 0.1\nright = 'x'", "", r"gait 1 \('go'\)\.right"),
        ("omni", "front = 0.1\nleft = 0.1\nright = inf", "", r"gait 1 \('go'\)\.right"),
        ("omni", "front = 0.1\nleft = 0.1\nright = 0.1\nspeed = 1.0", "", "needs front, left and right"),
        ("omni", "front = 0.1\nleft = 0.1\nright = 0.1", "axle = 0.05", r"body\.axle: unknown key"),
        ("omni", "front = 0.1\nleft = 0.1\nright = 0.1", "arm = 'x'", r"body\.arm: "),
        ("omnii", "front = 0.1", "", "body: unknown drive 'omnii'; did you mean 'omni'"),
        ("bare", "front = 0.1", "", "gait 'go' of a bare drive needs command"),
    ],
)
def test_a_robot_with_a_wrong_key_is_refused_by_the_body_s_own_settings(tmp_path, drive, gait, body, message):
    bh.register_body("omni", Omni, commands=KEYS, settings=OmniSettings)
    bh.register_body("bare", Omni, settings=OmniSettings)
    with pytest.raises(bh.ConfigError, match=message) as refused:
        bh.load_robot(toml_robot(tmp_path, drive, gait, body))
    assert "\n" not in str(refused.value)


def test_a_gait_may_give_its_command_as_a_list_and_the_top_speed_may_be_unknown(tmp_path):
    bh.register_body("bare", Omni, settings=OmniSettings)
    bare = bh.load_robot(toml_robot(tmp_path, "bare", "command = [0.1, 0.2, 0.3]"))
    assert bare.gaits["go"].command == (0.1, 0.2, 0.3)
    with pytest.raises(bh.InputError, match=r"needs robot\.body\.top_speed"):
        bare.top_speed  # noqa: B018
    short = bh.load_robot(toml_robot(tmp_path, "bare", "command = [0.1]"))
    with pytest.raises(bh.InputError, match="gait 'go' commands 1 actuators, not 3"):
        bh.babble(short, 2, 0)


def test_a_world_that_is_not_box2d_hunts():
    bh.register_world("kinematic", Kinematic)
    settings = settings_with(world="kinematic", **{"prey.speed": 0.02, "model.babbling_steps": 100})
    results = bh.evaluate(settings, runs=1, planners=["prediction", "omniscient"], arenas="open")
    assert results["caught"].mean() > 0.8
    assert results["time"].le(60.0).all()
    frame = bh.babble("khepera", 40, 0, world="kinematic")
    (record,) = frame.attrs.values()
    assert record["versions"]["kinematic"] == "1"
    assert np.isfinite(frame["distance"]).all()


def test_a_prey_model_that_is_not_ours_hunts(khepera_model):
    bh.register_prey_model("last", LastSeen)
    settings = settings_with(**{"prey.model": "last"})
    episode = bh.hunt(settings, bh.make_planner("planning", khepera_model), arena="open", theta=1.0, seed=0)
    assert [s.prey_model.observations for s in episode.situations] == list(range(len(episode.frame)))
    assert isinstance(episode.situations[-1].prey_model, LastSeen)
    results = bh.evaluate(settings, runs=1, planners="prediction", arenas="walled", model=khepera_model)
    assert results["caught"].mean() > 0.5
    given = bh.hunt("paper", bh.make_planner("prediction", khepera_model), seed=1, prey_model=LastSeen())
    assert isinstance(given.situations[0].prey_model, LastSeen)


def test_a_tracker_that_delays_hunts_worse(khepera_model):
    bh.register_tracker("delaying", Delaying)
    rates = []
    for sensing in ({}, {"sensing.tracker": "delaying", "sensing.tracker_settings": {"delay": 2}}):
        settings = settings_with(**sensing)
        results = bh.evaluate(settings, runs=2, planners="prediction", arenas="walled", model=khepera_model)
        rates.append(results["time"].mean())
    assert rates[1] > rates[0] + 1.0


def test_a_tracker_that_does_not_delay_hunts_as_the_exact_one(khepera_model):
    bh.register_tracker("delaying", Delaying)
    planner = bh.make_planner("intercept", khepera_model)
    prompt = settings_with(**{"sensing.tracker": "delaying", "sensing.tracker_settings": {"delay": 0}})
    one, other = (bh.hunt(s, planner, theta=2.0, seed=3) for s in (settings_with(), prompt))
    assert one.frame.equals(other.frame)
    assert one.trail.equals(other.trail)


def test_a_sensor_of_ones_own_sees_the_run(khepera_model):
    from bayeshunt.protocols import Detection, Frame, Observation

    class Everywhere:
        """Sees the prey in every frame of a run, the last one now; notes how many there were."""

        looks = ()

        def __init__(self, context, noise=0.0):
            self.noise = noise

        def sense(self, run, map, *, rng):
            frames = tuple(
                Frame(m.time, m.poses["hunter"], (Detection(m.poses["hunter"].relative(m.poses["prey"])),))
                for m in run.moments
            )
            Everywhere.looks = (*Everywhere.looks, len(frames))
            return Observation(frames[-1].time, frames[-1].pose, frames)

    bh.register_sensor("everywhere", Everywhere)
    settings = settings_with(**{"sensing.sensor": "everywhere"})
    planner = bh.make_planner("prediction", khepera_model)
    seen, told = (bh.hunt(s, planner, arena="open", theta=1.0, seed=0) for s in (settings, settings_with()))
    assert seen.frame["gait"].tolist() == told.frame["gait"].tolist()
    assert Everywhere.looks[:2] == (1, 52)
    with pytest.raises(bh.InputError, match=r"sensing\.sensor_settings of sensor 'everywhere': .*'nose'"):
        bh.hunt(settings_with(**{"sensing.sensor": "everywhere", "sensing.sensor_settings": {"nose": 1}}), planner)


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("world", "unknown world 'box2dd'; did you mean 'box2d'"),
        ("sensing.sensor", "sensing.sensor: unknown sensor 'exakt'; did you mean 'exact'"),
        ("sensing.tracker", "sensing.tracker: unknown tracker 'exakt'; did you mean 'exact'"),
        ("prey.model", "prey.model: unknown prey model 'count'; did you mean 'counts'"),
    ],
)
def test_an_unknown_name_is_refused_before_any_work(khepera_model, key, message):
    wrong = {"world": "box2dd", "prey.model": "count"}.get(key, "exakt")
    settings = settings_with(**{key: wrong})
    with pytest.raises(bh.InputError, match=message):
        bh.evaluate(settings, runs=1, model=khepera_model)
    with pytest.raises(bh.InputError, match=message):
        bh.hunt(settings, bh.make_planner("reactive", khepera_model))
