"""Obstacles: settings, where bodies are stopped, what the prey's sensors see, what a map says."""

import math

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ArenaSettings, ObstacleSettings, PhysicsSettings
from bayeshunt.core.errors import ConfigError
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Ray
from bayeshunt.planners.api import Situation
from bayeshunt.worlds.box2d.world import build_obstacles, new_world
from bayeshunt.worlds.foresight import foresee
from bayeshunt.worlds.maps import ForBody, map_of
from bayeshunt.worlds.prey.proximity import MAX_VALUE, Solid, proximity
from tests.worlds.test_sensors import UNIT, cast
from tests.worlds.trial_cases import Trial

DISC = ObstacleSettings(x=0.2, y=-0.1, radius=0.07)
PLANK = ObstacleSettings(x=-0.2, y=0.15, width=0.3, height=0.04, angle=0.6)
BARRIER = ObstacleSettings(x=0.175, y=0.0, width=0.03, height=0.4)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"radius": 0.1, "width": 1.0}, "obstacles 1: an obstacle is a disc .* or a rectangle"),
        ({"width": 1.0}, "obstacles 1: an obstacle is a disc .* or a rectangle"),
        ({}, "obstacles 1: an obstacle is a disc .* or a rectangle"),
        ({"radius": -0.1}, "obstacles 1.radius: input should be greater than 0, got -0.1"),
        ({"radus": 0.1}, "obstacles 1.radus: unknown key; did you mean 'radius'"),
        ({"width": 1, "height": 1, "angle": 90.0}, "obstacles 1: angle: "),
    ],
)
def test_a_wrong_obstacle_is_named_in_one_line(given, said):
    with pytest.raises(ConfigError, match=said) as caught:
        load_experiment("paper", {"arenas.walled.obstacles": [{"x": 0.3, "y": 0.3, **given}]})
    assert "\n" not in str(caught.value)


def test_nobody_starts_in_an_obstacle():
    settings = load_experiment("paper", {"arenas.open.obstacles": [{"x": 0.0, "y": -0.285, "radius": 0.03}]})
    settings.check_arena("open", 0.0)
    with pytest.raises(ConfigError, match=r"arenas.open.obstacles 1: the prey would start in it \(theta 1.5708"):
        settings.check_arena("open", math.pi / 2)
    near = load_experiment("paper", {"arenas.open.obstacles": [{"x": 0.05, "y": 0.0, "radius": 0.025}]})
    with pytest.raises(ConfigError, match="the hunter would start in it"):
        bh.evaluate(near, runs=1, arenas=["open"])


@pytest.mark.parametrize("obstacle", [DISC, PLANK])
def test_gaps_agree_with_shapely(obstacle):
    import shapely

    shape = shapely.Polygon(obstacle.outline())
    for x, y in np.random.default_rng(0).uniform(-0.5, 0.5, (200, 2)):
        assert obstacle.gap(x, y) == pytest.approx(shape.distance(shapely.Point(x, y)), abs=1e-4)
    far = max(math.dist((obstacle.x, obstacle.y), corner) for corner in obstacle.outline())
    assert obstacle.reach == pytest.approx(far)


def test_rays_agree_with_box2d():
    world = new_world()
    build_obstacles(world, (DISC, PLANK), UNIT)
    solids, hits = [Solid.of(DISC), Solid.of(PLANK)], 0
    rng = np.random.default_rng(1)
    for ox, oy in rng.uniform(-0.55, 0.55, (500, 2)):
        if min(DISC.gap(ox, oy), PLANK.gap(ox, oy)) < 1e-3:
            continue
        direction = rng.uniform(-math.pi, math.pi)
        ray = (ox, oy, math.cos(direction), math.sin(direction))
        ours, theirs = min(solid.distance(*ray) for solid in solids), cast(world, *ray, 2.0)
        assert ours == pytest.approx(theirs, abs=2e-4)
        hits += math.isfinite(theirs)
    assert hits > 50


def test_a_sensor_in_an_obstacle_sees_it_at_once_and_along_its_side_nothing():
    box = Solid.of(ObstacleSettings(x=0.0, y=0.0, width=0.2, height=0.1))
    assert box.distance(0.0, 0.0, 1.0, 0.0) == 0.0
    assert box.distance(-1.0, 0.05, 1.0, 0.0) == math.inf
    assert box.distance(-1.0, 0.02, 1.0, 0.0) == pytest.approx(0.9)
    assert box.distance(1.0, 0.0, 1.0, 0.0) == math.inf


def test_the_sensors_of_a_prey_see_an_obstacle():
    ahead = Solid.of(ObstacleSettings(x=0.067, y=0.0, radius=0.02))  # 20 mm before the two front sensors, at 27 mm
    seen = proximity(0.0, 0.0, 0.0, 0.05, None, None, [ahead])
    gap = math.hypot(0.067 - 0.027, 0.0)  # the rays run 7.5 mm beside the middle
    expected = MAX_VALUE * (1 - (gap - math.sqrt(0.02**2 - 0.0075**2)) / 0.05)
    assert seen[2:4] == pytest.approx([expected, expected])
    assert seen[6:] == [0.0, 0.0]
    assert proximity(0.0, 0.0, 0.0, 0.05, None, None, [Solid.of(ObstacleSettings(x=0.5, y=0.0, radius=0.1))]) is None


def trial(paper, arena, **prey):
    prey = paper.prey.model_copy(update=prey)
    return Trial(
        paper.robot, prey, arena, PhysicsSettings(), hunter_pose=Pose(0.0, 0.0, 0.0), prey_pose=Pose(0.5, 0.3, math.pi),
        catch_distance=0.05,
    )  # fmt: skip


@pytest.fixture(scope="module")
def paper():
    return load_experiment("paper")


@pytest.mark.parametrize("obstacle", [BARRIER, ObstacleSettings(x=0.26, y=0.0, radius=0.1)])
def test_an_obstacle_stops_the_robot_where_it_stands(paper, obstacle):
    least = []
    for obstacles in ((obstacle,), ()):
        moments = []
        trial(paper, ArenaSettings(obstacles=obstacles)).run(paper.robot.gaits["straight"].command, 5.0, moments)
        least.append(min(obstacle.gap(moment.poses["hunter"].x, moment.poses["hunter"].y) for moment in moments))
    assert least == pytest.approx([0.0285, 0.0], abs=2e-3)


def test_a_lure_stays_where_it_is(paper):
    lured = trial(paper, ArenaSettings(walled=True), behaviour="straight", speed=0.0)
    lured.run((0.0, 0.0), 20.0)
    assert lured.prey.pose[:2] == pytest.approx((0.5, 0.3), abs=1e-6)


def test_what_is_foreseen_turns_at_obstacles(paper):
    """The prey heads for a barrier: with it, its future turns away before it; without, it passes."""
    wall = ObstacleSettings(x=0.2, y=0.3, width=0.03, height=0.5)
    ahead = [foresee(trial(paper, ArenaSettings(obstacles=some)).simulation, 10.0)[1].x for some in ((wall,), ())]
    assert ahead[0].min() > 0.215
    assert ahead[1].min() < 0.1


def test_a_map_with_obstacles():
    walled = map_of(ArenaSettings(walled=True, obstacles=(BARRIER, DISC)))
    assert walled.free(0.0, 0.0) is True
    assert walled.free(0.175, 0.0) is False
    assert walled.free([0.0, 0.175, 0.2, 0.7], [0.0, 0.3, -0.1, 0.0]).tolist() == [True, True, False, False]
    assert walled.blocked(Ray(0.0, 0.0, 0.36, 0.0))
    assert not walled.blocked(Ray(0.0, 0.0, 0.36, 0.5))
    assert walled.blocked(Ray(0.0, 0.0, 0.7, 0.5))
    assert not map_of(ArenaSettings(obstacles=(DISC,))).blocked(Ray(0.0, 0.0, 9.0, 9.0))


def test_a_hunt_among_obstacles_is_one_to_look_at(paper, khepera_model):
    settings = load_experiment("paper", {"arenas.walled.obstacles": [BARRIER.model_dump(), DISC.model_dump()]})
    assert "2 obstacles" in str(settings)
    episode = bh.hunt(settings, bh.make_planner("reactive", khepera_model), arena="walled", theta=2.0, seed=0)
    assert episode._repr_html_().count("<title>obstacle</title>") == 2
    from bayeshunt.views.pages.replay import replay_data

    assert [len(outline) for outline in replay_data(episode)["obstacles"]] == [4, 64]


def test_a_map_for_a_body_in_the_frame_of_its_start():
    """The barrier is 0.16 to 0.19 m ahead of the centre; the hunter starts 0.1 m before it, facing left."""
    seen = ForBody(map_of(ArenaSettings(obstacles=(BARRIER,))), Pose(0.06, 0.0, math.pi / 2), 0.0285)
    assert seen.free([0.0, 0.0, 0.0], [0.0, -0.08, -0.2]).tolist() == [True, False, True]  # y is to the left
    assert seen.free(0.0, -0.07) is True  # 1.5 mm of room
    assert seen.blocked(Ray(0.0, 0.0, 0.0, -0.2))
    assert not seen.blocked(Ray(0.0, 0.0, 0.3, 0.0))


def test_yardsticks_are_told_of_obstacles_and_nobody_else_is(paper, khepera_model):
    settings = load_experiment("detour")
    for name, told in (("omniscient", True), ("detour", False)):
        episode = bh.hunt(settings, bh.make_planner(name, khepera_model), arena="barrier", theta=0.0, seed=5)
        assert all((situation.map is not None) == told for situation in episode.situations)
        assert episode.caught == told  # a detour without a map runs at the barrier
    free = bh.hunt(paper, bh.make_planner("omniscient", khepera_model), arena="walled", theta=0.0, seed=5)
    assert all(situation.map is None for situation in free.situations)


def test_the_reference_takes_no_gait_into_an_obstacle(khepera_model):
    table = bh.reference("detour", samples=2, angles=12, headings=12)
    planner = bh.make_planner("reference", khepera_model, table=table)
    episode = bh.hunt("detour", planner, arena="barrier", theta=0.0, seed=5)
    first = planner.plan(episode.situations[0], rng=np.random.default_rng(0))
    assert first.gait != "straight"
    assert first.value < 1e3  # free, and no second-best of blocked ones
    blind = Situation(**{**vars(episode.situations[0]), "map": None})
    assert planner.plan(blind, rng=np.random.default_rng(0)).gait == "straight"
