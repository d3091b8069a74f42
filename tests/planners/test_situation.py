"""What a planner is asked: nothing in it is guessed, the catch distance is one, wrong arguments are named."""

import math
from dataclasses import replace

import numpy as np
import pytest
from planner_cases import BODY, STEP, WHEELS, babble, seen_prey, situations

import bayeshunt as bh
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.core.task import CATCH_BODIES, Task
from bayeshunt.planners.api import Situation
from bayeshunt.planners.catalogue import describe_planner
from bayeshunt.planners.registry import make_planner, planner_names

HUNTERS = planner_names(standalone=True)
CATCHING = [n for n in HUNTERS if any(s.name == "catch_distance" for s in describe_planner(n).settings)]
PREY = Polar(0.3, 0.4, 1.0)


def decide(planner, situation):
    return planner.plan(situation, rng=np.random.default_rng(0))


@pytest.fixture(scope="module")
def big_model():
    """The same hunter six times as large and as fast."""
    size = 6.0
    frame = babble(list(WHEELS), 1500, seed=5).assign(distance=lambda f: size * f["distance"])
    gaits = tuple(Gait(n, tuple(size * w for w in WHEELS[n])) for n in WHEELS)
    return bh.ForwardModel.fit(frame, GaitRepertoire(gaits, size * BODY, STEP))


@pytest.mark.parametrize("name", HUNTERS)
def test_what_is_not_said_of_the_hunter_is_its_models_own(name, big_model):
    prey = Polar(1.1, 0.4, 1.0)
    said = Situation(prey, seen_prey(), body_length=6 * BODY, time_step=STEP, transitions=(PREY,))
    planner = make_planner(name, big_model)
    one, other = decide(planner, said), decide(planner, Situation(prey, seen_prey(), transitions=(PREY,)))
    assert (one.gaits, one.value) == (other.gaits, other.value)
    assert one.trace.equals(other.trace)


def test_a_situation_guesses_nothing():
    bare = Situation(PREY, seen_prey())
    assert (bare.body_length, bare.time_step, bare.pose, bare.future) == (None, None, None, None)
    assert bare.task == Task(None, None)


@pytest.mark.parametrize("name", HUNTERS)
def test_a_situation_of_another_robot_is_refused(name, model):
    planner = make_planner(name, model)
    with pytest.raises(bh.InputError, match=r"body_length is 0\.35 m, but .* 0\.057 m; fit a model"):
        decide(planner, Situation(PREY, seen_prey(), body_length=0.35))
    with pytest.raises(bh.InputError, match=r"time_step is 1 s, but .* 3\.328 s"):
        decide(planner, Situation(PREY, seen_prey(), time_step=1.0))


@pytest.mark.parametrize("name", CATCHING)
def test_a_planner_plans_for_the_catch_distance_of_the_hunt(name, model):
    """By default the task's, whatever it is; a setting comes before it; with neither it is the paper's."""
    usual, chosen = make_planner(name, model), make_planner(name, model, catch_distance=2.0)
    paper = make_planner(name, model, catch_distance=CATCH_BODIES)
    values = []
    for case in situations(4):
        wide = replace(case, task=Task(2.0 * BODY, 60.0))
        assert decide(usual, wide).value == decide(chosen, wide).value == decide(chosen, case).value
        assert decide(usual, wide).trace.equals(decide(chosen, case).trace)
        assert decide(usual, case).value == decide(paper, wide).value == decide(paper, case).value
        values.append(decide(usual, wide).value < decide(usual, case).value)
    assert any(values)


def test_the_catch_distance_of_the_world_reaches_the_planner(khepera_model):
    settings = bh.load_experiment("paper", {"protocol.catch_distance": 2.0, "protocol.time_limit": 40.0})
    episode = bh.hunt(settings, make_planner("intercept", khepera_model), arena="open", theta=1.0, seed=0)
    assert {s.task for s in episode.situations} == {Task(2.0 * 0.057, 40.0)}
    told = make_planner("intercept", khepera_model, catch_distance=2.0)
    assert bh.hunt(settings, told, arena="open", theta=1.0, seed=0).frame.equals(episode.frame)


def test_the_planners_that_plan_a_capture():
    assert {"intercept", "belief", "intercept_room", "frugal"} <= set(CATCHING)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"prey_model": None}, "^prey_model: expected a prey model, .*got None$"),
        ({"prey_model": PREY}, "^prey_model: expected a prey model"),
        ({"prey": None}, "^prey: expected its pose as a Polar, got None$"),
        ({"prey": (0.1, 0.0, 0.0)}, "^prey: expected its pose as a Polar"),
        ({"prey": Polar("far", 0.0, 0.0)}, "^prey pose must be finite numbers"),
        ({"prey": Polar(np.ones(3), np.ones(3), np.ones(3))}, "^prey pose must be finite numbers"),
        ({"prey": Polar(2.0, 90, 0.1)}, "^prey angle: expected radians .*degrees, give 1.571"),
        ({"prey": Polar(2.0, 0.1, -90.0)}, "^prey heading: expected radians"),
        ({"body_length": "57 mm"}, "^body_length must be positive metres, got '57 mm'$"),
        ({"body_length": True}, "^body_length must be"),
        ({"time_step": 0.0}, "^time_step must be positive seconds, got 0.0$"),
        ({"time": math.nan}, "^time: expected seconds"),
        ({"step": -1}, "^step: expected a whole number"),
        ({"previous_gait": 3}, "^previous_gait: expected the name of a gait, or None, got 3$"),
        ({"pose": (0, 0, 0)}, "^pose: expected a Pose, or None"),
        ({"future": 1.0}, "^future: expected a Future, or None"),
        ({"transitions": PREY}, "^transitions: expected a list of Polar"),
        ({"transitions": [0.1]}, "^transitions: expected a list of Polar, got 0.1$"),
        ({"transitions": 3}, "^transitions: expected a list of Polar, got 3$"),
        ({"task": 0.058}, "^task: expected a Task"),
    ],
)
def test_a_wrong_argument_is_named(wrong, says):
    with pytest.raises(bh.InputError, match=says):
        Situation(**{"prey": PREY, "prey_model": seen_prey(), **wrong})


@pytest.mark.parametrize("name", ["catch_distance", "time_limit"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan, "1", True])
def test_an_impossible_task_is_refused(name, value):
    with pytest.raises(bh.InputError, match=f"^{name} must be positive"):
        Task(**{name: value})


def test_a_situation_takes_what_it_took(model):
    """Positions and names of the arguments, and lists for transitions."""
    case = Situation(PREY, seen_prey(), BODY, 3.328, 1, "straight", STEP, [PREY], Pose(0.0, 0.0, 0.0), None)
    assert case.transitions == (PREY,)
    assert decide(make_planner("intercept", model), case).gait in model.gaits.names
