"""Maps: what is free, what stands in a ray's way."""

import numpy as np
import pytest

from bayeshunt.config.schema import ArenaSettings
from bayeshunt.protocols import Map, Ray
from bayeshunt.worlds.maps import map_of

WALLED, OPEN = map_of(ArenaSettings(walled=True, width=2.0, height=1.0)), map_of(ArenaSettings())


def test_both_are_maps():
    assert isinstance(WALLED, Map)
    assert isinstance(OPEN, Map)


@pytest.mark.parametrize(("x", "y", "free"), [(0, 0, True), (1.0, 0.5, True), (1.01, 0, False), (0, -0.51, False)])
def test_inside_the_walls_is_free(x, y, free):
    assert WALLED.free(x, y) is free
    assert OPEN.free(x, y) is True


def test_arrays_of_points():
    x, y = np.array([0.0, 2.0, 0.9]), np.array([0.0, 0.0, 0.6])
    assert WALLED.free(x, y).tolist() == [True, False, False]
    assert OPEN.free(x, y).tolist() == [True, True, True]


@pytest.mark.parametrize(
    ("ray", "blocked"), [((-0.9, 0.4, 0.9, -0.4), False), ((0, 0, 1.5, 0), True), ((-1.5, 0, 1.5, 0), True)]
)
def test_a_wall_stands_in_the_way(ray, blocked):
    assert WALLED.blocked(Ray(*ray)) is blocked
    assert not OPEN.blocked(Ray(*ray))
