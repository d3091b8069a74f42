"""The closed-form sensors against Box2D's own ray casts, and the edges of their range."""

import math

import Box2D
import numpy as np
import pytest

from bayeshunt.worlds.box2d.world import build_walls, new_world
from bayeshunt.worlds.prey.proximity import (
    MAX_VALUE,
    MOUNT_RADIUS,
    distance_to_disc,
    distance_to_walls,
    proximity,
    rays,
)

UNIT = 0.057  # metres per Box2D unit


class Nearest(Box2D.b2RayCastCallback):
    """Keeps the nearest hit."""

    def __init__(self):
        super().__init__()
        self.fraction = None

    def ReportFixture(self, fixture, point, normal, fraction):  # noqa: N802
        self.fraction = fraction
        return fraction


def cast(world, ox, oy, dx, dy, reach):
    callback = Nearest()
    end = ((ox + reach * dx) / UNIT, (oy + reach * dy) / UNIT)
    world.RayCast(callback, (ox / UNIT, oy / UNIT), end)
    return math.inf if callback.fraction is None else callback.fraction * reach


def test_rays_agree_with_box2d():
    rng = np.random.default_rng(0)
    world = new_world()
    build_walls(world, 1.2 / UNIT, 1.2 / UNIT)
    disc = world.CreateStaticBody(position=(0.2 / UNIT, -0.1 / UNIT))
    disc.CreateFixture(shape=Box2D.b2CircleShape(radius=0.5))
    hits = 0
    for _ in range(500):
        ox, oy = rng.uniform(-0.55, 0.55, 2)
        if math.hypot(ox - 0.2, oy + 0.1) < 0.5 * UNIT + 1e-3:
            continue
        direction = rng.uniform(-math.pi, math.pi)
        dx, dy = math.cos(direction), math.sin(direction)
        ours = min(distance_to_walls(ox, oy, dx, dy, 0.6, 0.6), distance_to_disc(ox, oy, dx, dy, 0.2, -0.1, 0.5 * UNIT))
        theirs = cast(world, ox, oy, dx, dy, 2.0)
        # Box2D walls of polygons carry no skin for rays; both are exact up to float32
        assert ours == pytest.approx(theirs, abs=2e-4)
        hits += math.isfinite(theirs)
    assert hits > 300


def test_value_is_linear_in_distance():
    # facing a wall: the two front sensors sit 27 mm ahead of the centre
    for gap in (0.0, 0.01, 0.025, 0.049):
        values = proximity(0.6 - 0.027 - gap, 0.0, 0.0, 0.05, (0.6, 0.6), None)
        assert values[2] == pytest.approx(MAX_VALUE * (1 - gap / 0.05))
        assert values[2] == pytest.approx(values[3])


def test_nothing_in_reach_is_said_exactly():
    rng = np.random.default_rng(1)
    for _ in range(300):
        x, y = rng.uniform(-0.57, 0.57, 2)
        theta = rng.uniform(-4, 4)
        if proximity(x, y, theta, 0.05, (0.6, 0.6), None) is None:
            for ox, oy, dx, dy in rays(x, y, theta):
                assert distance_to_walls(ox, oy, dx, dy, 0.6, 0.6) >= 0.05


def test_left_and_right_are_not_swapped():
    # a disc to the left of a robot that faces along x
    values = proximity(0.0, 0.0, 0.0, 0.05, None, (0.0, 0.07, 0.0285))
    assert values[0] > 0
    assert values[5] == 0


def test_sensor_positions_are_the_robots():
    for ox, oy, dx, dy in rays(0.0, 0.0, 0.3):
        assert math.hypot(dx, dy) == pytest.approx(1)
        assert math.hypot(ox, oy) <= MOUNT_RADIUS + 1e-12
