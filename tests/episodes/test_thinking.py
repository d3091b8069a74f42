"""Thinking that takes time: the world goes on, and the hunter holds the gait before for so much of the step."""

import math

import pytest

import bayeshunt as bh
from bayeshunt.episodes.pursuit import Pursuit

SLOW = {"protocol.thinking": "nodes", "protocol.seconds_per_node": 0.01, "prey.senses_hunter": False}


def moved(pursuit):
    return [tuple(moment.poses["hunter"]) for moment in pursuit.moments]


def test_nobody_waits_by_default():
    free, said = Pursuit("paper", "open", seed=1), Pursuit("paper", "open", seed=1)
    free.step("straight")
    said.step("straight", nodes=100)
    assert moved(free) == moved(said)


def test_the_gait_before_is_held_while_it_thinks():
    """One second of thought: the first second of the step is that of the gait before, the rest of the new one."""
    settings = bh.load_experiment("paper", SLOW)
    late, without, before = (Pursuit(settings, "open", seed=1) for _ in range(3))
    for pursuit in (late, without, before):
        pursuit.step("straight")
    late.step("spin left", nodes=100)
    without.step("spin left", nodes=0)
    before.step("straight", nodes=0)
    assert late.moment.time == without.moment.time  # the time-step is as long as ever
    held = [m for m in late.moments if m.time <= before.moments[0].time + 0.9]
    assert [m.poses["hunter"] for m in held] == [m.poses["hunter"] for m in before.moments[: len(held)]]
    turned = [pursuit.moment.poses["hunter"].theta % math.tau for pursuit in (late, without)]
    assert 0.0 < turned[0] < turned[1]


def test_it_stands_while_it_thinks_of_its_first_gait_and_may_lose_the_whole_step():
    pursuit = Pursuit(bh.load_experiment("paper", SLOW), "open", seed=1)
    start = pursuit.moment.poses["hunter"]
    pursuit.step("straight", nodes=10_000)
    assert pursuit.moment.poses["hunter"] == pytest.approx(start)
    assert pursuit.moment.time == pytest.approx(3.328)
    assert pursuit.moment.poses["prey"] != Pursuit("paper", "open", seed=1).moment.poses["prey"]


def test_depth_has_a_price_and_one_seed_one_hunt(khepera_model):
    ends = []
    for thinking in ("free", "nodes", "nodes"):
        settings = bh.load_experiment("paper", {**SLOW, "protocol.thinking": thinking})
        episode = bh.hunt(settings, bh.make_planner("planning", khepera_model), arena="open", theta=2.0, seed=3)
        ends.append(episode)
    assert ends[1].trail.equals(ends[2].trail)
    assert ends[0].time < ends[1].time
