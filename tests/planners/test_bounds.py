"""The kinematic limit, the omniscient hunter and the value iteration behind the reference."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from planner_cases import BODY, STEP, situations

from bayeshunt.core.errors import InputError, ModelFileError
from bayeshunt.core.geometry import Polar
from bayeshunt.planners.api import Future
from bayeshunt.planners.bounds import reference
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.bounds.omniscient import Omniscient
from bayeshunt.planners.bounds.reference import Reference, ReferenceTable
from bayeshunt.planners.bounds.relative import Chase, Grid, expected_times, solve
from bayeshunt.planners.conformance import check_planner


def straight_future(prey: Polar, speed: float, duration: float = 60.0) -> Future:
    """A prey that goes straight on at ``speed`` [m/s]."""
    times = np.arange(0.0, duration + 0.01, 0.064)
    gone = speed * times
    return Future(times, prey.compose(Polar(gone, np.zeros_like(gone), np.zeros_like(gone))))


@pytest.mark.parametrize(
    ("theta", "seconds"), [(0, 23.6), (1, 13.6), (2, 3.6), (3, 2.2), (4, 2.8), (5, 9.3), (6, 22.7)]
)
def test_the_kinematic_limit_of_the_open_arena(theta, seconds):
    """Against the closed form |p + v t| = s t + r; the published figures are its values to a decimal."""
    prey, speed, top, reach = Polar(5 * BODY, float(theta), 0.0), 0.048, 0.0576, 1.02 * BODY
    x, y = prey.forward, prey.right
    a, b = speed**2 - top**2, x * speed - top * reach
    exact = (-b - math.sqrt(b * b - a * (x * x + y * y - reach * reach))) / a
    limit = KinematicLimit.capture_time(straight_future(prey, speed), top, reach)
    assert limit == pytest.approx(exact, abs=1e-3)
    assert limit == pytest.approx(seconds, abs=0.06)


def test_the_kinematic_limit_of_a_prey_that_gets_away_and_of_one_in_reach():
    away = straight_future(Polar(0.3, 0.0, 0.0), 0.2)
    assert KinematicLimit.capture_time(away, 0.05, 0.05) == math.inf
    # In reach at once, and out of reach for ever after: the start counts.
    assert KinematicLimit.capture_time(straight_future(Polar(0.04, 0.0, 0.0), 0.2), 0.05, 0.05) == 0.0


def test_the_kinematic_limit_between_known_poses_by_hand():
    """Gaps 0.2, 0.1, -0.1 at 0, 1 and 2 s: linear in between, so it is closed after 1.5 s; later gaps do not matter."""
    times = np.array([0.0, 1.0, 2.0, 3.0])
    distance = np.array([0.2, 0.1, -0.1, 0.5]) + 0.3 * times + 0.05
    future = Future(times, Polar(distance, np.zeros(4), np.zeros(4)))
    assert KinematicLimit.capture_time(future, 0.3, 0.05) == pytest.approx(1.5)
    # Just touching, in numbers that are exact: at a pose between two, and at the start.
    for distance, seconds in (([1.5, 0.75, 1.5, 2.5], 1.0), ([0.5, 1.5, 2.5, 3.5], 0.0)):
        touching = Future(times, Polar(np.array(distance), np.zeros(4), np.zeros(4)))
        assert KinematicLimit.capture_time(touching, 0.25, 0.5) == seconds
    from_later = Future(times + 4.0, Polar(np.zeros(4), np.zeros(4), np.zeros(4)))
    assert KinematicLimit.capture_time(from_later, 0.3, 0.05) == 4.0


def test_the_kinematic_limit_cannot_hunt(model):
    with pytest.raises(InputError, match="bound that no gaits reach"):
        KinematicLimit(model).plan(situations(1)[0], rng=np.random.default_rng(0))


def with_futures(cases):
    return [replace(case, future=straight_future(case.prey, 0.048)) for case in cases]


def test_the_omniscient_hunter_conforms(model):
    check_planner(Omniscient(model, depth=2), model.gaits.names, with_futures(situations(4)), seed=1)


def test_the_omniscient_hunter_takes_the_earliest_capture(model):
    """A prey that will come by is met where it comes by, not where it is."""
    case = replace(situations(1)[0], prey=Polar(0.25, 0.0, math.pi))
    coming = replace(case, future=straight_future(case.prey, 0.02))
    plan = Omniscient(model).plan(coming, rng=np.random.default_rng(0))
    assert plan.gait == "straight"
    closing = 0.0576 + 0.02
    assert plan.value == pytest.approx((0.25 - 0.9 * 1.02 * BODY) / closing, rel=0.05)
    assert plan.trace["chosen"].sum() >= 1
    assert plan.trace.loc[plan.trace["chosen"], "value"].min() == plan.value


def test_no_heading_is_made_up_where_only_places_are_predicted(model):
    for case in with_futures(situations(3)):
        plan = Omniscient(model, depth=3).plan(case, rng=np.random.default_rng(0))
        assert plan.predicted_prey.heading[0] == case.prey.heading
        assert np.isnan(plan.predicted_prey.heading[1:]).all()
        assert math.isnan(plan.target.heading)
        steps = STEP * np.arange(len(plan.gaits) + 1)
        assert plan.predicted_prey.forward == pytest.approx(case.future.at(steps)[0], abs=1e-12)


def test_the_omniscient_hunter_asks_for_the_future(model):
    with pytest.raises(InputError, match="future"):
        Omniscient(model).plan(situations(1)[0], rng=np.random.default_rng(0))


@pytest.mark.parametrize("setting", [{"depth": 0}, {"max_transitions": -1}, {"margin": 0.0}, {"margin": 1.5}])
def test_wrong_settings_of_the_omniscient_hunter(setting, model):
    with pytest.raises(InputError, match=f"omniscient: {next(iter(setting))}"):
        Omniscient(model, **setting)


def test_a_future_goes_on_after_its_last_pose():
    future = straight_future(Polar(0.3, 0.5, 0.2), 0.05, duration=5.0)
    ahead, right = future.at(np.array([0.0, 2.5, 8.0]))
    expected = Polar(0.3, 0.5, 0.2).compose(Polar(0.05 * np.array([0.0, 2.5, 8.0]), np.zeros(3), np.zeros(3)))
    assert ahead == pytest.approx(expected.forward, abs=1e-9)
    assert right == pytest.approx(expected.right, abs=1e-9)


# --- value iteration ------------------------------------------------------------------------------


def line_chase(prey_speed: float = 0.0) -> Chase:
    """A hunter that drives straight (gait 0) or turns by 90 degrees to the right on the spot (gait 1)."""
    points = 13
    share = np.arange(1, points + 1) / points
    straight = np.stack([0.19 * share, 0 * share, 0 * share], axis=1)
    turn = np.stack([0 * share, 0 * share, 0.5 * math.pi * share], axis=1)
    prey = np.stack([prey_speed * STEP * share, 0 * share, 0 * share], axis=1)
    return Chase(np.stack([straight, turn])[:, None], prey[None], STEP, BODY, closing=0.19 / STEP)


def small_grid() -> Grid:
    return Grid(np.arange(0.05, 0.8, 0.02), 24, 8)


def test_value_iteration_against_a_prey_that_stands_still():
    """Straight ahead the time is distance / speed; behind, two quarter turns come first."""
    chase, grid = line_chase(), small_grid()
    values = solve(chase, grid)
    speed = 0.19 / STEP
    for distance in (0.15, 0.29, 0.47):
        ahead = expected_times(chase, grid, values, np.array([distance, 0.0, 0.0]))
        assert int(np.argmin(ahead)) == 0
        assert ahead[0] == pytest.approx((distance - BODY) / speed, abs=0.35)
        behind = expected_times(chase, grid, values, np.array([distance, math.pi, 0.0]))
        assert int(np.argmin(behind)) == 1
        assert behind[1] == pytest.approx(2 * STEP + (distance - BODY) / speed, abs=0.5)


def test_value_iteration_is_a_fixed_point():
    chase, grid = line_chase(0.02), small_grid()
    values = solve(chase, grid, tolerance=1e-4)
    rng = np.random.default_rng(3)
    states = grid.states()
    for index in rng.choice(len(states), 12, replace=False):
        best = expected_times(chase, grid, values, states[index]).min()
        assert best == pytest.approx(values.ravel()[index], abs=2e-3)


def test_interpolation_weights_sum_to_one_and_reproduce_grid_points():
    grid = small_grid()
    states = grid.states()
    cells, weights = grid.corners(*states.T)
    assert weights.sum(axis=1) == pytest.approx(1.0, abs=1e-5)
    heaviest = cells[np.arange(len(states)), weights.argmax(axis=1)]
    assert (heaviest == np.arange(len(states))).mean() > 0.99


@pytest.fixture
def table(model) -> ReferenceTable:
    chase = line_chase()
    hunter = np.repeat(chase.hunter[:1], len(model.gaits), axis=0)
    chase = Chase(hunter, chase.prey, STEP, BODY, chase.closing)
    grid = Grid(np.arange(0.05, 0.8, 0.1), 8, 4)
    return ReferenceTable(solve(chase, grid), grid, chase, model.gaits.names, {"digest": "abc"})


def test_the_reference_conforms(model, table):
    check_planner(Reference(model, table=table), model.gaits.names, situations(4), seed=1)


def test_a_reference_table_survives_its_file(table, tmp_path, model):
    path = tmp_path / "table.npz"
    table.save(path)
    again = ReferenceTable.load(path)
    assert np.array_equal(again.values, table.values)
    assert again.gaits == table.gaits
    assert again.facts == table.facts
    plans = [Reference(model, table=t).plan(situations(1)[0], rng=np.random.default_rng(0)) for t in (table, path)]
    assert plans[0].value == plans[1].value


@pytest.mark.parametrize("place", [0.3, 0.5, 0.7, 0.95])
def test_a_damaged_reference_table_is_refused(table, tmp_path, place):
    path = tmp_path / "table.npz"
    table.save(path)
    content = bytearray(path.read_bytes())
    content[int(place * len(content))] ^= 0xFF
    path.write_bytes(bytes(content))
    with pytest.raises(ModelFileError, match=r"table\.npz: .*(make it again|made by: bayeshunt reference)"):
        ReferenceTable.load(path)


def drop_duration(head, arrays):
    del head["duration"]


def spell_duration(head, arrays):
    head["duration"] = "long"


def drop_a_gait(head, arrays):
    head["gaits"].pop()


def flatten_values(head, arrays):
    arrays["values"] = arrays["values"].ravel()


@pytest.mark.parametrize("spoil", [drop_duration, spell_duration, drop_a_gait, flatten_values])
def test_a_reference_table_of_other_content_is_refused(table, tmp_path, spoil):
    """The checksum is sound: somebody wrote such a file, and it is still no reference table."""
    path = tmp_path / "table.npz"
    table.save(path)
    with np.load(path) as stored:
        head, arrays = json.loads(str(stored["head"])), {key: stored[key] for key in reference._ARRAYS}
    spoil(head, arrays)
    text = json.dumps(head)
    np.savez(path, head=np.array(text), checksum=np.array(reference._checksum(text, arrays)), **arrays)
    with pytest.raises(
        ModelFileError, match=r"table\.npz: malformed content; give a file made by: bayeshunt reference"
    ):
        ReferenceTable.load(path)


def test_a_reference_needs_a_table_for_this_robot(model, small_model, table, tmp_path):
    with pytest.raises(InputError, match="bayeshunt reference --out"):
        Reference(model)
    with pytest.raises(ModelFileError, match="no such file"):
        Reference(model, table=tmp_path / "none.npz")
    with pytest.raises(InputError, match="gaits"):
        Reference(small_model, table=table)
