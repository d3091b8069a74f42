"""Prey among walls: paths by hand, rooms guessed from turns, and the planners that use them."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from one_room import room_futures
from planner_cases import BODY, STEP

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.conformance import check_planner
from bayeshunt.planners.interception.bouncing import Walls, sliding_future
from bayeshunt.planners.interception.futures import turning_futures
from bayeshunt.planners.interception.guessing import completed, untouched_sides
from bayeshunt.planners.interception.intercept import intercept
from bayeshunt.planners.interception.intercept_room import intercept_room
from bayeshunt.planners.interception.intercept_walls import InterceptWallsPlanner, intercept_walls
from bayeshunt.planners.registry import make_planner, planner_names

SQUARE = Walls(((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)), (0.5,) * 4, 0.4)


def hunt_situation(hunter, prey, transitions=()):
    return Situation(
        hunter.relative(prey), PreyModel(), body_length=BODY, time_step=STEP,
        transitions=tuple(transitions), pose=hunter,
    )  # fmt: skip


def room(offset=0.57):
    sides = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    return RoomModel(sides, np.full(4, offset), np.full(4, 1.1), np.full(4, 50))


def test_the_wall_ahead_by_hand():
    assert SQUARE.meet(Pose(0.1, 0.2, 0.0)) == (0, pytest.approx(0.4))
    assert SQUARE.meet(Pose(0.1, 0.2, math.pi / 2)) == (2, pytest.approx(0.3))
    assert SQUARE.meet(Pose(0.0, 0.0, math.radians(200)))[0] == 1
    assert SQUARE.meet(Pose(0.9, 0.0, 0.0)) == (0, 0.0)  # beyond the wall: at it
    assert Walls(((1.0, 0.0),), (0.5,), 0.4).meet(Pose(0.0, 0.0, math.pi)) == (-1, math.inf)


def test_a_prey_leaves_a_wall_on_the_side_it_came_in_on():
    assert SQUARE.slant(0, 0.3) == pytest.approx(0.3)
    assert SQUARE.leave(0, 1.0) == pytest.approx(math.pi / 2 + 0.4)  # left along the wall, and away from it
    assert SQUARE.leave(2, -1.0) == pytest.approx(-0.4)


def test_a_path_by_hand():
    hunter = Pose(0.1, -0.1, 0.7)
    prey = Pose(0.0, 0.0, 0.3)  # well off head-on: no second path worth keeping at 0.8 rad, one at 0.3
    futures = room_futures(hunter.relative(prey), hunter, SQUARE, 0.05, 0.1, STEP)
    hit = 0.5 / math.cos(0.3) / 0.05
    forward, right = (a[0] for a in futures.at(np.array([0.0, hit, hit + 2.0])))
    expected = [prey, Pose(0.5, 0.5 * math.tan(0.3), 0.0)]
    way = math.pi / 2 + 0.4
    expected.append(Pose(0.5 + 0.1 * math.cos(way), 0.5 * math.tan(0.3) + 0.1 * math.sin(way), 0.0))
    seen = [hunter.relative(pose) for pose in expected]
    assert forward.tolist() == pytest.approx([float(p.forward) for p in seen])
    assert right.tolist() == pytest.approx([float(p.right) for p in seen])
    assert futures.foreseen


def test_head_on_a_prey_may_turn_either_way():
    hunter = Pose(0.0, 0.0, 0.0)
    even = room_futures(hunter.relative(Pose(0.2, 0.0, 0.0)), hunter, SQUARE, 0.05, 0.1, STEP)
    assert even.weights.tolist() == pytest.approx([0.5, 0.5])
    tilted = room_futures(hunter.relative(Pose(0.2, 0.0, 0.15)), hunter, SQUARE, 0.05, 0.1, STEP)
    steps = 0.3 / math.cos(0.15) / (0.05 * STEP)  # the heading's random walk on the way to the wall
    assert tilted.weights[1] == pytest.approx(0.5 * math.erfc(0.15 / (0.1 * math.sqrt(2 * steps))))
    slanted = room_futures(hunter.relative(Pose(0.2, 0.0, 0.785)), hunter, SQUARE, 0.05, 0.1, STEP)
    assert slanted.weights.tolist() == [1.0]
    assert even.groups.tolist() == [0, 0]  # 6 s away: not told apart by the next decision
    near = room_futures(hunter.relative(Pose(0.4, 0.0, 0.0)), hunter, SQUARE, 0.05, 0.1, STEP)
    assert near.groups.tolist() == [1, 2]


@pytest.mark.parametrize("seed", range(20))
def test_paths_stay_inside(seed):
    rng = np.random.default_rng(seed)
    hunter, prey = (Pose(*rng.uniform(-0.45, 0.45, 2), rng.uniform(-3, 3)) for _ in range(2))
    futures = room_futures(hunter.relative(prey), hunter, SQUARE, 0.05, 0.1, STEP, legs=9)
    forward, right = futures.at(np.linspace(0.0, 40.0, 400))
    for path in zip(forward, right, strict=True):
        places = hunter.compose(Polar.from_cartesian(*path))
        assert max(np.abs(places.x).max(), np.abs(places.y).max()) <= 0.5 + 1e-9


def test_no_wall_ahead_no_room_futures():
    one = Walls(((1.0, 0.0),), (0.5,), 0.4)
    assert room_futures(Polar(0.3, 0.0, math.pi), Pose(0, 0, 0), one, 0.05, 0.1, STEP) is None


def test_a_prey_that_keeps_its_heading_slides_to_the_corner():
    hunter, prey = Pose(0.1, -0.1, 0.7), Pose(0.0, 0.0, 0.3)
    future = sliding_future(hunter.relative(prey), hunter, SQUARE, 0.05)
    hit = 0.5 / math.cos(0.3) / 0.05
    up = 0.5 * math.tan(0.3)
    corner = hit + (0.5 - up) / (0.05 * math.sin(0.3))
    forward, right = (a[0] for a in future.at(np.array([0.0, hit, hit + 5.0, corner, corner + 20.0])))
    places = [(0.0, 0.0), (0.5, up), (0.5, up + 0.05 * math.sin(0.3) * 5.0), (0.5, 0.5), (0.5, 0.5)]
    seen = [hunter.relative(Pose(*place, 0.0)) for place in places]
    assert forward.tolist() == pytest.approx([float(p.forward) for p in seen])
    assert right.tolist() == pytest.approx([float(p.right) for p in seen])
    head_on = sliding_future(Polar(0.2, 0.0, 0.0), Pose(0.0, 0.0, 0.0), SQUARE, 0.05)
    assert head_on.at(np.array([6.0, 60.0]))[0][0].tolist() == pytest.approx([0.5, 0.5])  # stands at the wall


@pytest.mark.parametrize(("slant", "rebound", "kept"), [(0.3, 0.5, 0.04), (-0.8, 1.1, 0.0), (0.0, 0.2, 0.1)])
def test_how_a_prey_left_a_wall_is_read_back(slant, rebound, kept):
    """A made-up prey that turns at once, so far from the wall and at such an angle."""
    before, run = Pose(0.3, 0.0, slant), 0.4
    first = (0.2 - kept) / math.cos(slant)
    side = 1.0 if slant >= 0 else -1.0
    theta = side * (0.5 * math.pi + rebound)
    corner = (0.5 - kept, first * math.sin(slant))
    after = Pose(corner[0] + (run - first) * math.cos(theta), corner[1] + (run - first) * math.sin(theta), theta)
    assert SQUARE.left(0, before, after, run) == pytest.approx((rebound, kept), abs=1e-9)


# --- the planner that knows its walls --------------------------------------------------------------


def test_walls_planner_conforms(model):
    planner = intercept_walls(model, room=room())
    assert isinstance(planner, InterceptWallsPlanner)
    cases = [
        hunt_situation(Pose(0.1, 0.0, 1.0), Pose(0.3, 0.2, t), [Polar(0.16, 0, 0)] * n) for t, n in ((0, 0), (2, 3))
    ]
    check_planner(planner, model.gaits.names, cases, seed=2)


def test_a_room_without_walls_is_the_open(model):
    empty = RoomModel.empty()
    case = hunt_situation(Pose(0.1, 0.0, 1.0), Pose(0.3, 0.2, 0.5), [Polar(0.16, 0, 0)])
    with_walls, without = intercept_walls(model, room=empty, hazard=0.1), intercept(model, room_chance=0.0, hazard=0.1)
    assert (
        with_walls.plan(case, rng=np.random.default_rng(0)).value
        == without.plan(case, rng=np.random.default_rng(0)).value
    )


def test_a_wall_brings_the_prey_back(model):
    """A prey about to meet the wall ahead is caught sooner than one that runs on."""
    case = hunt_situation(Pose(0.0, 0.0, 0.0), Pose(0.4, 0.05, 0.1), [Polar(0.16, 0, 0)])
    known = intercept_walls(model, room=room()).plan(case, rng=np.random.default_rng(0))
    unknown = intercept(model, hazard=0.0).plan(case, rng=np.random.default_rng(0))
    assert known.value < unknown.value - 2.0


def sliding(steps):
    """A prey that has met the wall ahead at 0.57 m head-on, kept its heading and stands there."""
    poses = [Pose(0.2 + 0.16 * i, 0.1, 0.0) for i in range(3)] + [Pose(0.57, 0.1, 0.0)] * steps
    return [Polar(*(float(p) for p in a.relative(b))) for a, b in itertools.pairwise(poses)], poses[-1]


def test_what_the_prey_does_at_walls_is_counted(model):
    planner = intercept_walls(model, room=room())
    poses = [Pose(0.04 + 0.16 * i, 0.1, 0.0) for i in range(3)] + [Pose(0.47, 0.1, 1.9), Pose(0.42, 0.25, 1.9)]
    seen = [Polar(*(float(p) for p in a.relative(b))) for a, b in itertools.pairwise(poses)]
    habits = planner.at_walls(hunt_situation(Pose(0.0, 0.0, 0.0), poses[-1], seen))
    assert (len(habits.rebounds), habits.kept, habits.strays) == (0, 0, 0)  # 0.36 + 0.16 m is too close to call
    poses[1:] = [Pose(0.2, 0.1, 0.0), Pose(0.4, 0.1, 0.0), Pose(0.47, 0.18, 1.9), Pose(0.4, 0.37, 1.9)]
    seen = [Polar(*(float(p) for p in a.relative(b))) for a, b in itertools.pairwise(poses)]
    habits = planner.at_walls(hunt_situation(Pose(0.0, 0.0, 0.0), poses[-1], seen))
    assert habits.rebounds == pytest.approx((1.9 - 0.5 * math.pi,))
    assert habits.kept == 0
    assert habits.table().loc["turns at a wall", "seen"] == 1


def test_a_prey_that_slides_is_believed_to_slide(model):
    planner, hunter = intercept_walls(model, room=room()), Pose(0.0, 0.0, 0.0)
    before = planner.at_walls(hunt_situation(hunter, Pose(0.2, 0.1, 0.0)))
    assert before.keeping == pytest.approx(0.2)
    seen, last = sliding(2)
    case = hunt_situation(hunter, last, seen)
    habits = planner.at_walls(case)
    assert habits.kept == 3  # two legs at the wall, and its present place
    futures = planner.futures(case)
    likeliest = futures.likeliest(np.array([20.0]))
    assert (likeliest.forward[-1], likeliest.right[-1]) == pytest.approx((0.57, -0.1), abs=1e-3)


def test_a_prey_that_turns_where_there_is_no_wall_is_believed_to_turn_by_chance(model):
    planner, hunter = intercept_walls(model, room=room(1.5)), Pose(0.0, 0.0, 0.0)
    seen = [Polar(0.16, 0.0, 0.0), Polar(0.12, 0.3, 1.0), Polar(0.16, 0.0, 0.0)]
    case = hunt_situation(hunter, Pose(0.3, 0.1, 0.2), seen)
    assert planner.at_walls(case).hazard == pytest.approx(1 / (3 + 2))
    straight = hunt_situation(hunter, Pose(0.3, 0.1, 0.2), [Polar(0.16, 0.0, 0.0)] * 3)
    assert len(planner.futures(case).weights) > 10 > len(planner.futures(straight).weights)


def test_walls_planner_says_what_it_lacks(model):
    with pytest.raises(InputError, match="bayeshunt explore"):
        make_planner("intercept_walls", model)
    lost = Situation(Polar(0.3, 0.1, 0.2), PreyModel(), body_length=BODY, time_step=STEP)
    with pytest.raises(InputError, match="own pose"):
        intercept_walls(model, room=room()).plan(lost, rng=np.random.default_rng(0))
    assert "intercept_walls" not in planner_names(standalone=True)


# --- the planner that guesses its room -------------------------------------------------------------


def prey_trail(size, steps, start, theta):
    """Poses of a prey that goes 0.16 m a step and turns by 2 rad when the wall at ``size`` would be crossed."""
    poses = [Pose(*start, theta)]
    for _ in range(steps):
        x, y, t = poses[-1]
        there = Pose(x + 0.16 * math.cos(t), y + 0.16 * math.sin(t), t)
        if max(abs(there.x), abs(there.y)) > size:
            gap = SQUARE._replace(offsets=(size,) * 4).meet(poses[-1])[1]
            there = Pose(x + gap * math.cos(t), y + gap * math.sin(t), t + 2.0)
        poses.append(there)
    return poses


def belief_after(planner, poses):
    hunter = Pose(0.0, 0.0, 0.0)
    seen = [Polar(*(float(p) for p in a.relative(b))) for a, b in itertools.pairwise(poses)]
    return planner.rooms(hunt_situation(hunter, poses[-1], seen))


def test_rooms_before_anything_is_seen(model):
    table = intercept_room(model, room_chance=0.3, sizes=6).rooms(hunt_situation(Pose(0, 0, 0), Pose(0.3, 0, 0)))
    assert table["probability"].tolist() == pytest.approx([0.05] * 6 + [0.7])
    assert table["size"].iloc[[0, -2, -1]].tolist() == pytest.approx([4.5 * BODY, 18.0 * BODY, math.inf])


def test_rooms_show_what_was_believed_before(model):
    table = belief_after(intercept_room(model), prey_trail(0.45, 6, (0.2, 0.1), 0.1))
    assert table["before"].tolist() == pytest.approx([0.3 / 8] * 8 + [0.7])
    assert table["probability"].max() > 0.3


def test_the_planner_of_another_name_is_the_same_hunter(model):
    case = hunt_situation(Pose(0.0, 0.0, 0.0), Pose(0.3, 0.05, 0.1), [Polar(0.16, 0, 0)])
    plans = [make(model).plan(case, rng=np.random.default_rng(0)) for make in (intercept, intercept_room)]
    assert plans[0].value == plans[1].value


def test_a_hunter_that_does_not_know_where_it_is_believes_in_no_room(model):
    planner, lost = intercept(model), Situation(Polar(0.3, 0.1, 0.2), PreyModel(), body_length=BODY, time_step=STEP)
    assert planner.futures(lost).weights.tolist() == planner.turning(lost).weights.tolist()


def test_of_many_futures_the_likeliest_are_kept():
    known = TurnModel(0.16, np.array([1.0, -1.0, 2.0]), prior_hazard=0.3)
    whole = turning_futures(Polar(0.3, 0.1, 0.2), known, STEP, 4)
    some = whole.likely(5)
    assert len(some.weights) == 5
    assert some.weights.sum() == pytest.approx(1.0)
    assert some.weights.min() * np.sort(whole.weights)[-5:].sum() >= np.sort(whole.weights)[-6]
    assert some.groups[0] == 0  # straight on
    assert sorted(set(some.groups.tolist())) == list(range(int(some.groups.max()) + 1))


@pytest.mark.parametrize("size", [0.45, 0.7])
def test_a_turn_tells_the_size_of_the_room(model, size):
    planner = intercept_room(model)
    poses = prey_trail(size, 6, (0.2, 0.1), 0.1)
    table = belief_after(planner, poses)
    rooms = table[np.isfinite(table["size"])]
    mean = (rooms["size"] * rooms["probability"]).sum() / rooms["probability"].sum()
    assert mean == pytest.approx(size, abs=0.1)
    assert table["probability"].sum() == pytest.approx(1.0)
    assert table["probability"].iloc[-1] < 0.5


def test_a_prey_that_runs_on_and_on_is_in_no_room(model):
    table = belief_after(intercept_room(model), prey_trail(99.0, 10, (0.3, 0.0), 0.0))
    assert table["probability"].iloc[-1] > 0.95


def test_a_prey_that_has_come_beyond_a_wall_is_hardly_in_that_room(model):
    """It goes straight from 3 bodies to 8.9, or to 10.3; a room of 4.5 stands for those up to 9: 1.3 / 0.6 by hand."""
    planner = intercept(model, sizes=2, nearest=4.5, farthest=18.0, room_chance=0.5)
    ends = (8.9, 10.3)
    found = [belief_after(planner, [Pose(3.0 * BODY, 0.0, 0.0), Pose(x * BODY, 0.0, 0.0)]) for x in ends]
    odds = [float(np.log(table["probability"].iloc[0] / table["probability"].iloc[1])) for table in found]
    runs = [model_odds(planner, x - 3.0) for x in ends]
    assert np.subtract(odds, runs) == pytest.approx([0.0, -1.3 / 0.6])


def model_odds(planner, run):
    """The logarithm of how much less likely a straight leg of ``run`` bodies is in the small room than in the large."""
    error, gap = planner.settings.hazard, np.array([1.5, 15.0])
    chance = error + (1 - 2 * error) / (1 + np.exp((gap - run) / planner.settings.slack))
    return float(np.log((1 - chance[0]) / (1 - chance[1])))


def test_a_prey_that_turns_ever_again_on_its_way_out_is_in_no_room(model):
    """It zigzags away: the wall at which it first turned is behind it, and tells nothing of where it turns next."""
    poses, theta = [Pose(0.2, 0.0, 0.0)], 0.0
    for turn in (0.0, 1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, -1.0):
        at, theta = poses[-1], theta + turn
        poses.append(Pose(at.x + 0.15 * math.cos(at.theta), at.y + 0.15 * math.sin(at.theta), theta))
    table = belief_after(intercept(model), poses)
    assert table["probability"].iloc[-1] > 0.95


def test_the_guess_can_be_switched_off_and_moves_the_decision(model):
    case = hunt_situation(Pose(0.0, 0.0, 0.0), Pose(0.3, 0.05, 0.1), [Polar(0.16, 0, 0)])
    off = intercept_room(model, room_chance=0.0).plan(case, rng=np.random.default_rng(0)).value
    open_field = intercept_walls(model, room=RoomModel.empty(), hazard=0.02)
    assert off == open_field.plan(case, rng=np.random.default_rng(0)).value
    assert intercept_room(model, room_chance=0.9).plan(case, rng=np.random.default_rng(0)).value < off


@pytest.mark.parametrize(
    "wrong", [{"room_chance": 1.0}, {"sizes": 1}, {"error": 0.5}, {"nearest": 30.0}, {"rebound": 2}]
)
def test_wrong_settings_are_named(model, wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        intercept_room(model, **wrong)


@pytest.mark.parametrize(
    ("given", "rooms", "ahead"),
    [({}, 8, 4), ({"nearest": 1.0, "farthest": 2.0}, 2, 4), ({"sizes": 5, "hazard_steps": 0.3}, 5, 1),
     ({"hazard_steps": 0.3, "turn_steps": 2}, 8, 2)],
)  # fmt: skip
def test_how_many_rooms_and_legs_ahead_follows_from_the_other_settings(model, given, rooms, ahead):
    planner = intercept(model, **given)
    assert (planner.settings.rooms, len(planner.sizes), planner.settings.legs_ahead) == (rooms, rooms, ahead)


def test_the_smallest_two_rooms_are_no_more_than_a_body_length_apart(model):
    """By hand: 4.5 bodies times 4 ** (1 / 7) is 5.49; with one room less it would be 4.5 times 4 ** (1 / 6), 5.67."""
    gaps = [sizes[1] - sizes[0] for sizes in (intercept(model).sizes, intercept(model, sizes=7).sizes)]
    body = intercept(model).sizes[0] / 4.5
    assert np.allclose(np.divide(gaps, body), [0.986, 1.17], atol=0.001)
    assert gaps[0] <= body < gaps[1]


def corner(turn=0.0):
    """Two walls, 0.5 m ahead and to the left, and the places of a hunter that was 0.3 m behind and to the right."""
    cos, sin = math.cos(turn), math.sin(turn)
    walls = Walls(((cos, sin), (-sin, cos)), (0.5, 0.5), 0.4)
    been = np.array([[-0.3, -0.3], [0.3, 0.3]]) @ np.array([[cos, sin], [-sin, cos]])
    return walls, FreeSpace.of(0.001, been, been[:1])


@pytest.mark.parametrize("turn", [0.0, 0.7, -2.0])
def test_sides_that_were_not_touched_are_those_opposite(turn):
    walls, space = corner(turn)
    sides = untouched_sides(walls, space)
    assert [math.atan2(y, x) % (2 * math.pi) for (x, y), _ in sides] == pytest.approx(
        [(turn + angle) % (2 * math.pi) for angle in (math.pi, 1.5 * math.pi)]
    )
    assert [reached for _, reached in sides] == pytest.approx([0.3, 0.3], abs=0.002)


def test_nothing_is_guessed_of_a_room_of_which_nothing_or_all_is_known_or_that_is_not_square():
    _, space = corner()
    for walls in (Walls((), (), 0.4), SQUARE, Walls(((1.0, 0.0), (math.cos(0.6), math.sin(0.6))), (0.5, 0.5), 0.4)):
        assert untouched_sides(walls, space) == ()
    assert untouched_sides(corner()[0], None) == ()


def test_a_guessed_wall_is_as_far_as_the_others_and_no_nearer_than_anybody_was():
    walls, space = corner()
    sides = untouched_sides(walls, space)
    rooms = completed(walls, sides, 0.0, [Pose(0.0, -0.6, 0.0)])
    assert sum(chance for chance, _ in rooms) == pytest.approx(1.0)
    assert all(made.normals[:2] == walls.normals and made.offsets[:2] == walls.offsets for _, made in rooms)
    (_, nearest), *_ = rooms
    assert nearest.offsets[2:] == pytest.approx((0.5, 0.6))  # the prey was 0.6 m to the right
    assert max(made.offsets[2] for _, made in rooms) == pytest.approx(0.75)


def test_a_prey_is_expected_to_turn_at_a_wall_that_was_not_touched(khepera_model):
    walls, space = corner()
    some = RoomModel(np.array(walls.normals), np.array(walls.offsets), np.full(2, 1.0), np.full(2, 50), space=space)
    behind = hunt_situation(Pose(0.0, 0.0, 0.0), Pose(-0.3, 0.0, math.pi + 0.3))
    starts = intercept_walls(khepera_model, room=some).futures(behind).starts
    assert np.isfinite(starts[:, 1]).all()
    planner = intercept_walls(khepera_model, room=some)
    planner.untouched = ()
    assert np.isinf(planner.futures(behind).starts[0, 1])
