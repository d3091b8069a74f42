"""The searching hunter: what it sees, what it pays for, what its trace says."""

import math

import numpy as np
import pytest
from one_room import room_futures

import bayeshunt as bh
from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import Pose
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.obstacles import TouchedObstacles
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.lookahead import PairPaths, look_ahead
from bayeshunt.planners.uncertainty.obstructed import Obstructed
from bayeshunt.planners.uncertainty.sampled import Start, sampled_futures
from bayeshunt.planners.uncertainty.sight import sight

ROOM = Walls(((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)), (0.5,) * 4, 0.5)
NARROW = {"sensing.preset": "camera_narrow"}


def start(*poses, speed=0.05, turn_at=math.inf, turn=0.0):
    x, y, theta = (np.array(part, dtype=float) for part in zip(*poses, strict=True))
    count = len(x)
    return Start(Pose(x, y, theta), *(np.broadcast_to(part, (count,)) for part in (speed, turn_at, turn)))


def test_in_a_room_sampled_futures_bounce_as_known_ones_do():
    own = Pose(0.1, -0.1, 0.7)
    prey = own.relative(Pose(0.2, 0.3, 0.9))
    known = room_futures(prey, own, ROOM, 0.05, 0.0, 3.0)
    sampled = sampled_futures(start((0.2, 0.3, 0.9)), own, ROOM)
    times = np.linspace(0.0, 25.0, 40)
    assert np.allclose(known.at(times)[0][0], sampled.at(times)[0][0], atol=1e-9)
    assert np.allclose(known.at(times)[1][0], sampled.at(times)[1][0], atol=1e-9)


def test_a_turn_by_chance_happens_when_it_is_due_in_the_open_and_in_a_room():
    for walls in (None, ROOM):
        futures = sampled_futures(start((0.0, 0.0, 0.0), turn_at=2.0, turn=0.5 * math.pi), Pose(0.0, 0.0, 0.0), walls)
        forward, right = futures.at(np.array([2.0, 4.0]))
        assert forward[0] == pytest.approx([0.1, 0.1], abs=1e-9)
        assert right[0] == pytest.approx([0.0, 0.1], abs=1e-9)  # clockwise


def test_a_gait_sees_what_its_way_leads_the_camera_past(khepera_model):
    pairs = PairPaths.mean(khepera_model)
    futures = sampled_futures(start((0.3, 0.0, 0.0), (-0.3, 0.0, 0.0), speed=0.0), Pose(0.0, 0.0, 0.0), None)
    camera = CameraSettings(fov_deg=60, pixels=160, detection=0.9)
    seen = sight(pairs, camera, 0.06, futures, 0.006)
    names = khepera_model.gaits.names
    ahead, behind = seen.first[names.index("straight")]
    assert ahead == pytest.approx(1 - 0.1**4)
    assert behind == 0.0
    assert seen.first[names.index("spin left")][1] > 0.5  # it turns round
    assert (sight(pairs, None, 0.06, futures, 0.006).second == 1.0).all()
    assert (
        sight(pairs, camera.model_copy(update={"range": 0.1}), 0.06, futures, 0.006).first == 0.0
    ).all()  # beyond its reach


def settings(**changes):
    return bh.load_experiment("paper", {**NARROW, "sensing.tracker_settings": {"particles": 300}, **changes})


def test_a_hunt_with_a_camera_explains_itself_and_is_the_same_again(khepera_model):
    planner = bh.make_planner("search", khepera_model)
    episodes = [bh.hunt(settings(), planner, arena="open", theta=2.0, seed=3) for _ in range(2)]
    one, two = (e.frame.drop(columns=[c for c in e.frame if "seconds" in c]) for e in episodes)
    assert one["gait"].tolist() == two["gait"].tolist()
    assert one["value"].tolist() == two["value"].tolist()
    trace = episodes[0].plans[0].trace
    assert {"capture_by_1", "capture_by_26", "in_view", "information", "value_s", "lost_s"} <= set(trace.columns)
    assert trace["in_view"].between(0.0, 1.0).all()
    assert (trace["information"] >= -1e-9).all()
    singles, pairs = trace[trace["T"] == 1], trace[trace["T"] == 2]
    assert singles["value_s"].idxmin() == singles.index[singles["chosen"]][0]
    # A second step sees no less than the first alone.
    assert (pairs["in_view"].to_numpy() >= singles["in_view"].to_numpy().repeat(len(singles)) - 1e-9).all()
    bh.check_planner(planner, khepera_model.gaits.names, episodes[0].situations, seed=0)


def test_all_planners_hunt_on_the_belief(khepera_model):
    for name in ("reactive", "planning", "intercept", "belief", "constant_velocity"):
        planner = bh.make_planner(name, khepera_model)
        episode = bh.hunt(settings(**{"protocol.time_limit": 12.0}), planner, arena="open", theta=1.0, seed=1)
        assert np.isfinite(episode.frame["seen_distance"]).all()


def test_with_exact_sensing_it_intercepts(khepera_model):
    paper = bh.load_experiment("paper")
    for theta in (0.0, 3.0):
        episode = bh.hunt(paper, bh.make_planner("search", khepera_model), arena="open", theta=theta, seed=2)
        assert episode.caught
        assert (episode.plans[0].trace["in_view"].iloc[1:] == 1.0).all()


def test_a_future_far_from_the_middle_costs_more_where_it_is_not_seen(khepera_model):
    planner = bh.make_planner("search", khepera_model, price=2.0, most_price=5.0)
    situation = bh.hunt(settings(), planner, arena="open", theta=3.0, seed=5).situations[0]
    weighing = planner.plan(situation, rng=np.random.default_rng(0)).make_trace.args[1]
    forward, right = (part[:, 0] for part in weighing.futures.at(weighing.pairs.times[-1:]))
    far = np.hypot(forward - forward.mean(), right - right.mean())
    assert weighing.lost() == pytest.approx(np.minimum(2.0 * far / planner.homing.top_speed, 5.0))


@pytest.mark.parametrize(("changes", "away"), [({}, True), ({"sensing.camera.heading_noise_deg": 20.0}, False)])
def test_a_prey_that_was_only_shown_is_planned_for_as_if_it_went_away(khepera_model, changes, away):
    planner = bh.make_planner("search", khepera_model, away=0.3)
    # It goes as the hunter does, and begins behind it to the right.
    shown = Pursuit(settings(**changes), "open", 2.0, 5).situation
    assert (shown.belief.resultant < 0.2) == away
    heading = planner.sampled(shown, np.random.default_rng(0)).heading[:, 0]
    mean = np.arctan2(np.sin(heading).mean(), np.cos(heading).mean())
    assert mean == pytest.approx(2.0 if away else 0.0, abs=0.5)
    assert np.hypot(np.sin(heading).mean(), np.cos(heading).mean()) > 0.8


def test_once_its_motion_was_seen_the_belief_is_planned_on(khepera_model):
    planner = bh.make_planner("search", khepera_model, away=0.3)
    pursuit = Pursuit(settings(), "open", 0.0, 5)
    pursuit.step("slow straight")
    belief = pursuit.situation.belief
    assert belief.motion.steps == 1.0
    heading = planner.sampled(pursuit.situation, np.random.default_rng(0)).heading[:, 0]
    assert np.cos(heading).mean() == pytest.approx(belief.cloud.weight @ np.cos(belief.seen().heading), abs=0.02)


def test_futures_that_look_alike_are_not_told_apart_by_looks(khepera_model):
    pairs = PairPaths.mean(khepera_model)
    # Alike until both turn after the first step; and one that goes elsewhere at once.
    poses = [(0.3, 0.0, 0.0), (0.3, 0.0, 0.0), (0.3, 0.05, 0.5 * math.pi)]
    begin = start(*poses, turn_at=np.array([1.5, 1.5, np.inf]) * pairs.times[-1], turn=np.array([1.0, -1.0, 0.0]))
    futures = sampled_futures(begin, Pose(0.0, 0.0, 0.0), None)
    straight = khepera_model.gaits.names.index("straight")
    for camera in (CameraSettings(), None):
        told = sight(pairs, camera, 0.057, futures, 0.006).told[straight]
        assert told.sum(axis=1) == pytest.approx(1.0)
        assert told[0, :2] == pytest.approx([0.5, 0.5], abs=1e-3)
        assert told[2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)


def test_one_look_at_a_prey_near_its_start_does_not_tell_its_heading(khepera_model):
    pairs = PairPaths.mean(khepera_model)
    futures = sampled_futures(start((0.6, 0.0, 1.0), (0.6, 0.0, -1.0), speed=0.01), Pose(0.0, 0.0, 0.0), None)
    straight = khepera_model.gaits.names.index("straight")
    often = sight(pairs, CameraSettings(frames=4), 0.057, futures, 0.006).told[straight]
    blurred = sight(pairs, CameraSettings(frames=4, pixel_noise=10.0), 0.057, futures, 0.006).told[straight]
    assert often[0, 0] > blurred[0, 0] > 0.5
    assert blurred[0, 0] < 0.7


def walled_off():
    """A room in which a wall of touched cells stands across the way, 0.15 m ahead, 0.3 m wide."""
    cell = 0.03
    x, y = np.meshgrid(np.arange(-0.5, 0.51, cell), np.arange(-0.5, 0.51, cell))
    touched = np.column_stack([np.full(11, 0.15), np.arange(-5, 6) * cell])
    free = np.column_stack([x.ravel(), y.ravel()])
    free = free[np.hypot(free[:, 0] - 0.15, np.maximum(np.abs(free[:, 1]) - 0.15, 0.0)) > cell]
    space = FreeSpace.of(cell, free, np.repeat(touched, 5, axis=0))
    return TouchedObstacles.of(space, np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]), np.full(4, 0.6))


def test_a_gait_into_an_obstacle_is_stopped_and_the_way_goes_round_it(khepera_model):
    pairs = PairPaths.mean(khepera_model)
    homing, here = Homing(0.057, 0.06, 0.5), Pose(0.0, 0.0, 0.0)
    futures = sampled_futures(start((0.3, 0.0, 0.0), (-0.3, 0.0, 0.0), speed=0.0), here, None)
    found = look_ahead(pairs, futures, homing, 0.006)
    among = Obstructed.by(walled_off(), 5.0).outlook(found, pairs, futures, here, homing)
    straight = khepera_model.gaits.names.index("straight")
    assert found.second[straight, straight, -1, 0] == 1.0  # were nothing in the way
    assert among.second[straight, straight, -1, 0] == 0.0
    assert among.time[straight, straight, 0] > found.time[straight, straight, 0] + 5.0
    first, second = np.unravel_index(among.time[..., 0].argmin(), among.time.shape[:2])
    x, y = (part[first, second, :, 0] for part in pairs.second[:2])
    assert not walled_off().inside(x, -y).any()  # right is clockwise
    # The one behind is out of its way.
    assert among.time[..., 1].min() == pytest.approx(found.time[..., 1].min())


@pytest.mark.slow
def test_it_goes_round_a_barrier():
    detour = bh.load_experiment("detour", {"protocol.runs": 1, "model.babbling_steps": 1000})
    frame = bh.evaluate(detour, planners="search", arenas="barrier", seed=1001, jobs=1)
    assert frame["caught"].all()
