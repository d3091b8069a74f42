"""The grid of relative poses and one step of a chase over it, by hand and against composed poses."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bayeshunt.core.geometry import Polar, wrap
from bayeshunt.planners.bounds.relative import Chase, Grid, expected_times, solve

DURATION, REACH = 2.0, 0.06


def random_chase(gaits=3, samples=4, points=5, seed=0):
    """Random paths that end up to 0.2 m ahead, to either side, turned by up to 1.5 rad."""
    rng = np.random.default_rng(seed)
    ends = rng.uniform([0.0, -0.1, -1.5], [0.2, 0.1, 1.5], (gaits + 1, samples, 1, 3))
    paths = ends * (np.arange(1, points + 1) / points)[:, None]
    return Chase(paths[:-1], paths[-1], DURATION, REACH, closing=0.02)


def test_a_step_of_a_chase_against_composed_poses():
    chase = random_chase()
    rng = np.random.default_rng(1)
    states = np.column_stack([rng.uniform(0.05, 0.4, 30), *rng.uniform(-math.pi, math.pi, (2, 30))])
    caught = 0
    for gait in range(3):
        times, after = chase.outcomes(states, gait)
        for n, i in np.ndindex(times.shape):
            mine = [Polar.from_cartesian(*pose) for pose in chase.hunter[gait, i]]
            its = [Polar(*states[n]).compose(Polar.from_cartesian(*pose)) for pose in chase.prey[i]]
            seen = [prey.seen_from(hunter) for prey, hunter in zip(its, mine, strict=True)]
            near = [point for point, pose in enumerate(seen) if pose.distance <= REACH]
            expected = (near[0] + 0.5) * DURATION / 5 if near else math.inf
            caught += bool(near)
            assert times[n, i] == pytest.approx(expected)
            assert after[0][n, i] == pytest.approx(seen[-1].distance)
            for k in (1, 2):
                assert wrap(float(after[k][n, i] - seen[-1][k])) == pytest.approx(0.0, abs=1e-9)
    assert 10 < caught < 350  # both cases are tested


def test_the_time_beyond_the_grid():
    grid = Grid(np.array([0.1, 0.2, 0.5]), 4, 4)
    beyond = random_chase().beyond(np.array([0.1, 0.5, 0.56]), grid)
    np.testing.assert_allclose(beyond, [0.0, 0.0, 0.06 / 0.02])


def test_states_and_corners_by_hand():
    grid = Grid(np.array([0.1, 0.2, 0.5]), 4, 2)
    states = grid.states()
    assert states.shape == (24, 3)
    np.testing.assert_allclose(states[0], [0.1, 0.0, 0.0])
    np.testing.assert_allclose(states[1], [0.1, 0.0, math.pi])  # headings vary fastest
    np.testing.assert_allclose(states[2], [0.1, math.pi / 2, 0.0])
    np.testing.assert_allclose(states[8], [0.2, 0.0, 0.0])
    # a third of the way from 0.2 to 0.5 m, half-way between the angles 270 and 360 degrees, heading on a line
    cells, weights = grid.corners(np.array([0.3]), np.array([-math.pi / 4]), np.array([math.pi]))
    found = {int(c): float(w) for c, w in zip(cells[0], weights[0], strict=True) if w > 1e-6}
    assert found == pytest.approx({15: 1 / 3, 9: 1 / 3, 23: 1 / 6, 17: 1 / 6}, abs=1e-6)
    # nearer than the first distance and beyond the last one: at the edge
    for distance, row in ((0.02, 0), (0.9, 2)):
        cells, weights = grid.corners(np.array([distance]), np.zeros(1), np.zeros(1))
        assert {int(c) for c, w in zip(cells[0], weights[0], strict=True) if w > 1e-6} == {8 * row}
    # just below the full turn, which rounds to the full turn itself
    cells, weights = grid.corners(np.array([0.2]), np.array([-1e-20]), np.array([-1e-20]))
    assert {int(c) for c, w in zip(cells[0], weights[0], strict=True) if w > 1e-6} == {8}


def test_a_function_linear_in_each_coordinate_is_interpolated_exactly():
    grid = Grid(np.array([0.05, 0.1, 0.25, 0.4]), 6, 5)
    distance, angle, heading = grid.states().T
    values = (1.0 + distance) * (2.0 + angle) * (3.0 - heading)
    rng = np.random.default_rng(2)
    # below the last line of each angle: between it and the first the function is not linear
    d, a, h = (
        rng.uniform(0.05, 0.4, 50),
        rng.uniform(0, 5 / 6 * 2 * math.pi, 50),
        rng.uniform(0, 4 / 5 * 2 * math.pi, 50),
    )
    cells, weights = grid.corners(d, a, h)
    np.testing.assert_allclose((values[cells] * weights).sum(axis=1), (1 + d) * (2 + a) * (3 - h), rtol=1e-5)


def test_one_sweep_of_value_iteration_against_loops():
    """From V = 0, one sweep gives the least mean time within the step; a second one builds on it."""
    chase, grid = random_chase(), Grid(np.array([0.05, 0.15, 0.3]), 4, 4)
    values = np.zeros(grid.shape, dtype=np.float32)
    for sweeps in (1, 2, 3):
        best = np.empty(len(grid.states()))
        for n, state in enumerate(grid.states()):
            means = []
            for gait in range(3):
                times, after = chase.outcomes(state[None], gait)
                total = 0.0
                for i in range(times.shape[1]):
                    if math.isfinite(times[0, i]):
                        total += times[0, i]
                        continue
                    cells, weights = grid.corners(*(part[0, i : i + 1] for part in after))
                    onward = float((values.ravel()[cells[0]] * weights[0]).sum())
                    total += DURATION + max(float(after[0][0, i]) - 0.3, 0.0) / 0.02 + onward
                means.append(total / times.shape[1])
            assert expected_times(chase, grid, values, state) == pytest.approx(means, rel=1e-5)
            best[n] = min(means)
        values = best.reshape(grid.shape).astype(np.float32)
        told = []
        np.testing.assert_allclose(
            solve(chase, grid, sweeps=sweeps, tolerance=0.0, progress=told.append), values, rtol=1e-5
        )
        assert told == [1] * (3 + sweeps)  # gaits tabulated, then sweeps


def test_value_iteration_stops_when_nothing_changes():
    """A prey in reach at the first point is caught in half a point's time, whatever the sweep."""
    chase = random_chase()
    near = Chase(0 * chase.hunter, 0 * chase.prey, DURATION, REACH, 0.02)
    told = []
    values = solve(near, Grid(np.array([0.01, 0.05]), 3, 3), progress=told.append)
    np.testing.assert_allclose(values, 0.5 * DURATION / 5, rtol=1e-6)
    assert len(told) == 3 + 2
