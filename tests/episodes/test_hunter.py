"""The step API: a loop of one's own hunts as ours does, in any frame, at irregular times, with gaps."""

import math
import subprocess
import sys
import warnings

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.protocols import Detection, Frame, Observation

STEP = 3.328


class Toy:
    """A world of somebody's own: a unicycle that executes gaits with some slip, a prey that goes round."""

    def __init__(self, seed, start=(0.0, 0.0, 0.0)):
        self.rng = np.random.default_rng(seed)
        self.own, self.prey = bh.Pose(0.0, 0.0, 0.0), bh.Pose(0.25, 0.1, 0.6)
        self.start = bh.Pose(*start)

    def execute(self, gait, seconds=STEP):
        slip = 1 + 0.05 * self.rng.uniform(-1, 1, 2)
        left, right = gait.command * slip
        self.own = moved(self.own, 0.5 * (left + right), (right - left) / 0.052, seconds)
        self.prey = moved(self.prey, 0.02, 0.1, seconds)

    @property
    def caught(self):
        return math.hypot(self.own.x - self.prey.x, self.own.y - self.prey.y) < 0.058

    def told(self, pose):
        """A pose in the frame that its owner uses."""
        c, s = math.cos(self.start.theta), math.sin(self.start.theta)
        x, y = c * pose.x - s * pose.y + self.start.x, s * pose.x + c * pose.y + self.start.y
        return bh.Pose(x, y, pose.theta + self.start.theta)


def moved(pose, speed, turn, seconds):
    x, y, theta = pose
    for _ in range(26):
        x += speed * seconds / 26 * math.cos(theta)
        y += speed * seconds / 26 * math.sin(theta)
        theta += turn * seconds / 26
    return bh.Pose(x, y, theta)


def chase(planner, seed, *, start=(0.0, 0.0, 0.0), missing=0.0, jitter=0.0, heading=True, steps=25, **given):
    """Run the loop; return the gaits chosen, whether the prey was caught, and the hunter."""
    toy, hunter, chance = Toy(seed, start), bh.Hunter(planner, seed=seed, **given), np.random.default_rng(seed)
    gaits, time = [], 0.0
    gait = None
    while not toy.caught and len(gaits) < steps:
        seen = toy.told(toy.prey)
        if not heading:
            seen = seen._replace(theta=math.nan)
        seen = None if chance.random() < missing else seen
        plan = hunter.step(toy.told(toy.own), seen, time if jitter else None)
        gaits.append(plan.gait)
        seconds = STEP * (1 + jitter * chance.uniform(-1, 1))
        gait = hunter.gaits[plan.gait]
        toy.execute(gait, seconds)
        time += seconds
    return gaits, toy.caught, hunter


@pytest.fixture(scope="module")
def planner(khepera_model):
    return bh.make_planner("intercept", khepera_model)


@pytest.mark.parametrize("name", ["intercept", "prediction", "planning"])
def test_a_loop_of_ones_own_catches_the_prey(khepera_model, name):
    caught = [chase(name, seed, model=khepera_model)[1] for seed in range(4)]
    assert sum(caught) >= 3


@pytest.mark.parametrize("start", [(1.5, -2.0, 0.0), (0.0, 0.0, 2.2), (-30.0, 4.0, -1.3), (0.1, 0.2, 9.0)])
def test_a_frame_that_is_turned_and_shifted_changes_no_plan(planner, start):
    for seed in range(3):
        one, other = chase(planner, seed)[0], chase(planner, seed, start=start)[0]
        assert one == other


def test_gaps_and_irregular_times_do_not_stop_it(planner):
    results = [chase(planner, seed, missing=0.1, jitter=0.05, start=(1.0, 2.0, 0.7)) for seed in range(8)]
    assert sum(caught for _, caught, _ in results) >= 6
    for _, _, hunter in results:
        assert hunter.prey_model.observations + hunter.skipped == hunter.steps - 1


def test_a_sighting_without_a_heading_will_do(planner):
    caught = [chase(planner, seed, heading=False)[1] for seed in range(4)]
    assert sum(caught) >= 3


def test_our_own_hunts_run_through_the_same_steps(planner):
    episode = bh.hunt("paper", planner, arena="open", theta=1.0, seed=4)
    hunter = bh.Hunter(planner, seed=4)
    rows = episode.frame
    for k in range(len(rows)):
        own, prey = (bh.Pose(*rows.loc[k, [f"{who}_{p}" for p in ("x", "y", "theta")]]) for who in ("hunter", "prey"))
        plan = hunter.step(own, prey)
        assert plan.gait == rows.loc[k, "gait"]
        assert plan.value == rows.loc[k, "value"]
    assert hunter.prey_model == episode.situations[-1].prey_model
    assert hunter.skipped == 0


def test_a_transition_over_another_time_is_not_learned_and_that_is_said(planner):
    hunter = bh.Hunter(planner)
    places = [bh.Pose(0.3 + 0.05 * k, 0.0, 0.0) for k in range(6)]
    own = bh.Pose(0.0, 0.0, 0.0)
    for place, time in zip(places, (0.0, 3.328, 10.0, 13.3, 16.0, 19.4), strict=True):
        hunter.step(own, place, time)
        if time in (10.0, 16.0):
            assert "not learned" in hunter.explain()
            assert "a gait lasts 3.328 s" in hunter.explain()
    assert (hunter.prey_model.observations, hunter.skipped) == (3, 2)
    assert "2 of 5 transitions were not learned" in hunter.explain()


def test_a_missing_sighting_costs_two_transitions_and_is_said(planner):
    hunter = bh.Hunter(planner)
    own = bh.Pose(0.0, 0.0, 0.0)
    for k, seen in enumerate((True, True, False, True, True)):
        hunter.step(own, bh.Pose(0.3 + 0.05 * k, 0.0, 0.0) if seen else None)
        if not seen:
            assert "last seen 3.33 s ago" in hunter.explain()
            assert hunter.belief.mean.x == pytest.approx(0.3 + 0.05 * k)  # it goes on as it went
            assert hunter.belief.covariance[0, 0] > 0
    assert (hunter.prey_model.observations, hunter.skipped) == (2, 2)
    assert hunter.belief.last_seen == 0.0


def test_a_prey_that_was_never_seen_is_a_guess(planner):
    hunter = bh.Hunter(planner)
    plan = hunter.step(bh.Pose(0.0, 0.0, 0.0), None)
    assert plan.gait in hunter.gaits.names
    assert "never seen" in hunter.explain()
    assert (hunter.belief.last_seen, hunter.belief.resultant) == (math.inf, 0.0)


def test_an_observation_of_detections_will_do(planner):
    one, other = bh.Hunter(planner), bh.Hunter(planner)
    for k in range(5):
        own, prey = bh.Pose(1.0 + 0.1 * k, 2.0, 0.4 + 0.05 * k), bh.Pose(1.4 + 0.1 * k, 2.2, 0.1)
        looks = Observation(0.0, own, (Frame(0.0, own, (Detection(own.relative(prey)),)),))
        assert one.step(own, prey).gait == other.step(own, looks).gait
    empty = Observation(0.0, own, (Frame(0.0, own),))
    assert one.step(own, None).gait == other.step(own, empty).gait


def test_what_is_known_of_the_prey_beforehand_is_copied(planner):
    known = bh.PreyModel()
    known.observe(bh.Polar(0.1, 0.0, 0.0))
    hunter = bh.Hunter(planner, prey_model=known)
    for k in range(3):
        hunter.step(bh.Pose(0.0, 0.0, 0.0), bh.Pose(0.3 + 0.1 * k, 0.0, 0.0))
    assert (known.observations, hunter.prey_model.observations) == (1, 3)


def test_the_same_seed_the_same_plans(khepera_model):
    planner = bh.make_planner("planning", khepera_model)
    assert chase(planner, 5)[0] == chase(planner, 5)[0]


ORIGIN = bh.Pose(0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("left", ORIGIN), "own_pose: expected a Pose"),
        ((bh.Pose(0.0, 0.0, math.nan), ORIGIN), "own_pose: expected finite numbers"),
        ((ORIGIN, 3), "seen: expected a Pose"),
        ((ORIGIN, bh.Pose(math.nan, 0.0, 0.0)), "seen: expected finite numbers, or a heading of NaN"),
        ((ORIGIN, ORIGIN, "now"), "time: expected seconds"),
        ((ORIGIN, ORIGIN, math.nan), "time: expected seconds"),
    ],
)
def test_a_wrong_argument_is_named(planner, arguments, message):
    with pytest.raises(bh.InputError, match=message) as refused:
        bh.Hunter(planner).step(*arguments)
    assert "\n" not in str(refused.value)


def test_time_goes_on(planner):
    hunter = bh.Hunter(planner)
    hunter.step(ORIGIN, bh.Pose(0.3, 0.0, 0.0), 5.0)
    with pytest.raises(bh.InputError, match="time: expected seconds after the 5 of the call before"):
        hunter.step(ORIGIN, bh.Pose(0.3, 0.0, 0.0), 5.0)


def test_what_cannot_hunt_is_refused(khepera_model, planner):
    with pytest.raises(bh.InputError, match="model: a planner given by name, 'intercept', needs"):
        bh.Hunter("intercept")
    with pytest.raises(bh.InputError, match="seed: expected a whole number"):
        bh.Hunter(planner, seed=-1)
    with pytest.raises(bh.InputError, match="sensing"):
        bh.Hunter(planner, sensing=3)
    with pytest.raises(bh.InputError, match="unknown tracker 'exakt'"):
        bh.Hunter(planner, sensing="exakt")
    with pytest.raises(bh.InputError, match="prey_model: expected a PreyModel"):
        bh.Hunter(planner, prey_model=3)
    car = bh.load_robot("car")
    other = bh.ForwardModel.fit(bh.babble(car, 90, 0), car.gaits)
    with pytest.raises(bh.InputError, match="gaits"):
        bh.Hunter(planner, other)


class Own:
    """A planner of somebody's own."""

    name = "own"

    def __init__(self, answer):
        self.answer = answer

    def plan(self, situation, *, rng):
        return self.answer() if callable(self.answer) else self.answer


def test_a_planner_of_ones_own_needs_the_model_and_its_mistakes_carry_its_name(khepera_model):
    with pytest.raises(bh.InputError, match="planner 'own' does not say which gaits the robot has; give model= too"):
        bh.Hunter(Own(bh.Plan("straight")))
    seen = bh.Pose(0.3, 0.0, 0.0)
    assert bh.Hunter(Own(bh.Plan("straight")), khepera_model).step(ORIGIN, seen).gait == "straight"
    for answer, fault in (("straight", "returned"), (bh.Plan("fly"), "'fly'"), (lambda: 1 / 0, "ZeroDivisionError")):
        with pytest.raises(bh.InputError, match=f"planner 'own'.*{fault}"):
            bh.Hunter(Own(answer), khepera_model).step(ORIGIN, seen)


def test_pandas_is_not_needed_to_import_it():
    code = "import sys, bayeshunt.episodes.hunter; assert 'pandas' not in sys.modules, 'pandas'"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_first_heading_of_many_turns_is_taken_for_degrees(planner):
    with pytest.warns(bh.DataWarning, match=r"own_pose: theta is 90 rad at the start.*math\.radians"):
        bh.Hunter(planner).step(bh.Pose(0.0, 0.0, 90.0), bh.Pose(0.2, 0.0, 0.0))
    hunter = bh.Hunter(planner)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for turns in (0.0, 3.0, 6.0, 9.0):  # a robot that goes on turning, its heading never wrapped
            hunter.step(bh.Pose(0.0, 0.0, turns), bh.Pose(0.2, 0.0, 0.0))
