"""The nearest learned cell, against all cells compared with every target, for small and wide tables."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bayeshunt.core.bins import Axis
from bayeshunt.models.body.nearest import FARTHEST, CellFinder


def some_cells(distance_bins: int, angle_bins: int, count: int, rng: np.random.Generator) -> np.ndarray:
    """Int64 [M, 2]: ``count`` different cells, sorted."""
    chosen = rng.choice(distance_bins * angle_bins, count, replace=False)
    return np.stack(np.divmod(np.sort(chosen), angle_bins), axis=1)


def by_comparing_all(distance: Axis, angle: Axis, cells: np.ndarray, d: float, a: float) -> int:
    """The first cell within 1e-12 (relative to the scale of the squares) of the least squared distance."""
    reach, bearing = distance.centres[cells[:, 0]], angle.centres[cells[:, 1]]
    # less |p|^2, which is the same for all and would drown the differences of far targets
    squares = reach**2 - 2.0 * reach * (d * math.cos(a) * np.cos(bearing) + d * math.sin(a) * np.sin(bearing))
    slack = 1e-12 * reach.max() * (reach.max() + d)
    return int(np.flatnonzero(squares <= squares.min() + slack)[0])


def check(distance: Axis, angle: Axis, cells: np.ndarray, d: np.ndarray, a: np.ndarray) -> None:
    finder = CellFinder(distance, angle, cells)
    own = {tuple(cell): index for index, cell in enumerate(cells.tolist())}
    nearest = [by_comparing_all(distance, angle, cells, *target) for target in zip(d.tolist(), a.tolist(), strict=True)]
    used = [
        own.get((distance.index(x), angle.index(y)), best)
        for x, y, best in zip(d.tolist(), a.tolist(), nearest, strict=True)
    ]
    single = [
        finder.nearest(x, y, x / distance.width, (y - angle.edges[0].item()) / angle.width)
        for x, y in zip(d.tolist(), a.tolist(), strict=True)
    ]
    reach, bearing = distance.centres[cells[:, 0]], angle.centres[cells[:, 1]]
    radius = float(reach.max())
    for found, wanted in ((single, nearest), (finder.find_many(d, a).tolist(), used)):
        for i in np.flatnonzero(np.array(found) != np.array(wanted)).tolist():
            # another cell only where the two differ by rounding: at the rim of what counts as a tie
            one, two = (
                reach[c] ** 2 - 2.0 * d[i] * reach[c] * math.cos(a[i] - bearing[c]) for c in (found[i], wanted[i])
            )
            assert abs(one - two) <= 3e-12 * radius * (radius + d[i])


@pytest.mark.parametrize(
    ("distance_bins", "angle_bins", "count"), [(6, 8, 10), (40, 36, 370), (1700, 36, 23_000), (80_000, 36, 23_000)]
)
def test_tables_of_any_size(distance_bins: int, angle_bins: int, count: int) -> None:
    rng = np.random.default_rng(count + distance_bins)
    distance, angle = Axis.linear("Distance", 0.0057, distance_bins), Axis.full_turn("Angle", angle_bins)
    cells = some_cells(distance_bins, angle_bins, count, rng)
    reach = distance.edges[-1].item()
    d = np.r_[rng.uniform(0, reach, 150), rng.uniform(0, 3 * reach, 50), 10.0 ** rng.uniform(-6, 12, 50), 0.0, FARTHEST]
    a = rng.uniform(-math.pi, math.pi, len(d))
    half_bin = math.pi / angle_bins
    a[::4] = np.round(a[::4] / half_bin) * half_bin  # midway between rays, where two cells are equally near
    a = np.clip(a, np.nextafter(-math.pi, 0.0), math.pi)
    check(distance, angle, cells, d, a)


@pytest.mark.parametrize(("distance_bins", "count"), [(1700, 5), (80_000, 1)])
def test_few_cells_in_a_wide_table(distance_bins: int, count: int) -> None:
    rng = np.random.default_rng(count)
    distance, angle = Axis.linear("Distance", 0.0057, distance_bins), Axis.full_turn("Angle", 36)
    cells = some_cells(30, 36, count, rng)  # all of them near: the wide table ends with empty bins
    d, a = rng.uniform(0, 1.0, 200), rng.uniform(-math.pi, math.pi, 200)
    check(distance, angle, cells, d, a)
    check(distance, angle, cells, 1000.0 * d, a)


@settings(max_examples=60)
@given(
    seed=st.integers(0, 1000),
    shape=st.tuples(st.integers(1, 60), st.integers(1, 40)),
    share=st.floats(0.01, 1.0),
    width=st.floats(1e-4, 10.0),
)
def test_random_tables(seed: int, shape: tuple[int, int], share: float, width: float) -> None:
    rng = np.random.default_rng(seed)
    distance, angle = Axis.linear("Distance", width, shape[0]), Axis.full_turn("Angle", shape[1])
    cells = some_cells(*shape, max(1, int(share * shape[0] * shape[1])), rng)
    d = width * np.r_[rng.uniform(0, 1.5 * shape[0], 30), 10.0 ** rng.uniform(-3, 7, 10)]
    check(distance, angle, cells, d, rng.uniform(-math.pi, math.pi, len(d)))


def test_more_angle_bins_than_sectors() -> None:
    rng = np.random.default_rng(3)
    distance, angle = Axis.linear("Distance", 0.01, 20), Axis.full_turn("Angle", 3600)
    cells = some_cells(20, 3600, 400, rng)
    check(distance, angle, cells, rng.uniform(0, 0.5, 200), rng.uniform(-math.pi, math.pi, 200))


def test_in_a_wide_table_few_cells_are_looked_at() -> None:
    """Of 23,000 cells each target is compared with a handful, asked alone or with others, and memory stays bounded."""
    rng = np.random.default_rng(4)
    distance, angle = Axis.linear("Distance", 0.0057, 1700), Axis.full_turn("Angle", 36)
    finder = CellFinder(distance, angle, some_cells(1700, 36, 23_000, rng))
    d, a = rng.uniform(0, 9.69, 500), rng.uniform(-math.pi, math.pi, 500)
    finder.find_many(d, a)
    held = [len(cells) for cells in finder._lists]
    assert len(held) > 10
    assert max(held) < 50
    looked: list[int] = []
    for x, y in zip(d.tolist(), a.tolist(), strict=True):
        place = (x / distance.width, (y - angle.edges[0].item()) / angle.width)
        finder.nearest(x, y, *place)  # one question of a bucket may look at every cell
        finder.nearest(x, y, *place)
        looked.append(len(found) if isinstance(found := [*finder._entries.values()][-1], list) else 1)
    assert max(looked) < 50
    assert len(finder._codes) + len(finder._own) < 5_000_000
