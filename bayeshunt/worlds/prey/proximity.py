"""The Khepera's eight infrared proximity sensors, in closed form: rays against walls and discs.

Positions and directions are those of Webots' model of the robot. A value falls linearly from
1023 at contact to 0 at the sensor's range. A test holds the rays to Box2D's ``RayCast``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, hypot, inf, pi, radians, sin, sqrt
from typing import NamedTuple

from bayeshunt.config.schema import ObstacleSettings

__all__ = [
    "KHEPERA_DIAMETER",
    "KHEPERA_SENSORS",
    "MAX_VALUE",
    "MOUNT_RADIUS",
    "Solid",
    "distance_to_disc",
    "distance_to_walls",
    "proximity",
    "rays",
]

#: Sensor positions [m] (x right, y forward of the centre) and directions [degrees counter-clockwise from x].
KHEPERA_SENSORS = (
    (-0.0245, 0.012, 175.0),
    (-0.0185, 0.021, 135.0),
    (-0.0075, 0.027, 90.0),
    (0.0075, 0.027, 90.0),
    (0.0185, 0.021, 45.0),
    (0.0245, 0.012, 5.0),
    (0.009, -0.026, 270.0),
    (-0.009, -0.026, 270.0),
)
#: Diameter [m] of the robot that they are mounted on.
KHEPERA_DIAMETER = 0.057
#: Value of a sensor that touches an obstacle.
MAX_VALUE = 1023.0

#: The same sensors as bearing and distance of the origin and bearing of the ray, counter-clockwise from the heading.
_MOUNTS = tuple(
    (hypot(x, y), atan2(y, x) - 0.5 * pi, radians(direction) - 0.5 * pi) for x, y, direction in KHEPERA_SENSORS
)
#: Largest distance of a sensor from the robot's centre [m].
MOUNT_RADIUS = max(hypot(x, y) for x, y, _ in KHEPERA_SENSORS)


def rays(x: float, y: float, theta: float) -> list[tuple[float, float, float, float]]:
    """Return origin x, y [m] and unit direction x, y of each sensor of a robot at (x, y, theta)."""
    result = []
    for distance, mount, direction in _MOUNTS:
        bearing, towards = theta + mount, theta + direction
        result.append((x + distance * cos(bearing), y + distance * sin(bearing), cos(towards), sin(towards)))
    return result


def distance_to_walls(ox: float, oy: float, dx: float, dy: float, half_width: float, half_height: float) -> float:
    """Return metres from (ox, oy) along (dx, dy) to the walls of a rectangle centred on the origin.

    The origin is inside the rectangle (or touches it: then the distance is not below 0).
    """
    along_x = (half_width - ox) / dx if dx > 0 else (-half_width - ox) / dx if dx < 0 else inf
    along_y = (half_height - oy) / dy if dy > 0 else (-half_height - oy) / dy if dy < 0 else inf
    return max(0.0, min(along_x, along_y))


def distance_to_disc(ox: float, oy: float, dx: float, dy: float, cx: float, cy: float, radius: float) -> float:
    """Return metres from (ox, oy) along (dx, dy) to a disc; inf where the ray misses, 0 from inside."""
    fx, fy = cx - ox, cy - oy
    gap = fx * fx + fy * fy - radius * radius
    if gap <= 0:
        return 0.0
    along = fx * dx + fy * dy
    # |t d - f|^2 = r^2  ->  t = along - sqrt(along^2 - gap)
    reach = along * along - gap
    return along - sqrt(reach) if along > 0 and reach >= 0 else inf


class Solid(NamedTuple):
    """An obstacle as the sensors meet it: a disc, or a rectangle of half sides ``a``, ``b``, turned.

    x, y: its centre [m]. reach: metres from there to its farthest point; of a disc (``a`` is 0) the radius.
    cos, sin: of the angle by which a rectangle is turned.
    """

    x: float
    y: float
    reach: float
    a: float = 0.0
    b: float = 0.0
    cos: float = 1.0
    sin: float = 0.0

    @classmethod
    def of(cls, obstacle: ObstacleSettings, scale: float = 1.0) -> Solid:
        """Return an obstacle, every length multiplied by ``scale``."""
        centre = obstacle.x * scale, obstacle.y * scale, obstacle.reach * scale
        if obstacle.radius is not None:
            return cls(*centre)
        width, height = obstacle.sides
        return cls(*centre, 0.5 * width * scale, 0.5 * height * scale, cos(obstacle.angle), sin(obstacle.angle))

    def distance(self, ox: float, oy: float, dx: float, dy: float) -> float:
        """Return metres from (ox, oy) along (dx, dy) to it; inf where the ray misses, 0 from inside."""
        if not self.a:
            return distance_to_disc(ox, oy, dx, dy, self.x, self.y, self.reach)
        c, s = self.cos, self.sin
        fx, fy = ox - self.x, oy - self.y
        enter, leave = 0.0, inf
        for at, along, half in ((c * fx + s * fy, c * dx + s * dy, self.a), (c * fy - s * fx, c * dy - s * dx, self.b)):
            if along == 0.0:
                if abs(at) >= half:
                    return inf
                continue
            near, far = (-half - at) / along, (half - at) / along
            enter, leave = max(enter, min(near, far)), min(leave, max(near, far))
        return enter if enter < leave else inf


def proximity(
    x: float,
    y: float,
    theta: float,
    sensor_range: float,
    walls: tuple[float, float] | None,
    disc: tuple[float, float, float] | None,
    solids: Sequence[Solid] = (),
) -> list[float] | None:
    """Return the eight noise-free sensor values, or None where nothing is within any sensor's reach.

    walls: half width and half height [m] of the arena, None when open.
    disc: centre x, y and radius [m] of another robot, None when it is not sensed. solids: obstacles.
    """
    reach = MOUNT_RADIUS + sensor_range
    half_width, half_height = (inf, inf) if walls is None else walls
    beside, before = abs(x) + reach >= half_width, abs(y) + reach >= half_height  # a wall at the end of x, of y
    if disc is not None and hypot(disc[0] - x, disc[1] - y) > reach + disc[2]:
        disc = None
    if solids:
        solids = [solid for solid in solids if hypot(solid.x - x, solid.y - y) <= reach + solid.reach]
    if not (beside or before or solids) and disc is None:
        return None
    values = []
    for distance, mount, direction in _MOUNTS:
        # rays() and distance_to_walls() of the walls that any ray may reach, written out: it is done eight times in
        # every control interval at a wall
        bearing, towards, nearest = theta + mount, theta + direction, inf
        if beside:
            ox, dx = x + distance * cos(bearing), cos(towards)
            nearest = (half_width - ox) / dx if dx > 0 else (-half_width - ox) / dx if dx < 0 else inf
        if before:
            oy, dy = y + distance * sin(bearing), sin(towards)
            along_y = (half_height - oy) / dy if dy > 0 else (-half_height - oy) / dy if dy < 0 else inf
            if along_y < nearest:
                nearest = along_y
        if nearest < 0.0:
            nearest = 0.0
        if disc is not None or solids:
            ray = x + distance * cos(bearing), y + distance * sin(bearing), cos(towards), sin(towards)
            if disc is not None:
                nearest = min(nearest, distance_to_disc(*ray, *disc))
            for solid in solids:
                nearest = min(nearest, solid.distance(*ray))
        values.append(MAX_VALUE * (1.0 - nearest / sensor_range) if nearest < sensor_range else 0.0)
    return values
