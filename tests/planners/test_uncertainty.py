"""The searching hunter: what it sees, what it pays for, what its trace says."""

import math

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import Pose
from bayeshunt.planners.interception.bouncing import Walls, room_futures
from bayeshunt.planners.interception.lookahead import PairPaths
from bayeshunt.planners.uncertainty.sampled import Start, sampled_futures
from bayeshunt.planners.uncertainty.sight import sight

ROOM = Walls(((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)), (0.5,) * 4, 0.5)
NARROW = {"sensing.preset": "camera_narrow"}


def start(*poses, speed=0.05, turn_at=math.inf, turn=0.0):
    x, y, theta = (np.array(part, dtype=float) for part in zip(*poses, strict=True))
    count = len(x)
    return Start(Pose(x, y, theta), np.full(count, speed), np.full(count, turn_at), np.full(count, turn))


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
    seen = sight(pairs, camera, 2.0, futures)
    names = khepera_model.gaits.names
    ahead, behind = seen.first[names.index("straight")]
    assert ahead == pytest.approx(1 - 0.1**4)
    assert behind == 0.0
    assert seen.first[names.index("spin left")][1] > 0.5  # it turns round
    assert (sight(pairs, None, math.inf, futures).second == 1.0).all()
    assert (sight(pairs, camera, 0.1, futures).first == 0.0).all()  # beyond its reach


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
