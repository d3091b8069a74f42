"""A cloud of particles: places where the prey may be, how it may be moving, and what each of them rests on."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from bayeshunt.core.geometry import FloatArray, Pose, wrap

__all__ = ["Cloud", "systematic"]


@dataclass(frozen=True, eq=False)
class Cloud:
    """N particles, in the odometry frame.

    x, y: metres; theta: radians counter-clockwise; speed: metres per second while it moves. still: whether it stands.
    weight: sums to 1. sightings: how many sightings it explains, each by its probability of being of this prey.
    from_x, from_y, from_theta: where it was when the present time-step began. turned: heading change by chance within
    this step [rad, clockwise], 0 if there was none.
    """

    x: FloatArray
    y: FloatArray
    theta: FloatArray
    speed: FloatArray
    still: np.ndarray
    weight: FloatArray
    sightings: FloatArray
    from_x: FloatArray
    from_y: FloatArray
    from_theta: FloatArray
    turned: FloatArray

    @classmethod
    def at(cls, pose: Pose[FloatArray], speed: FloatArray, still: np.ndarray, sightings: float = 0.0) -> Cloud:
        """Return equally weighted particles at poses [N]."""
        count = len(speed)
        return cls(
            pose.x, pose.y, pose.theta, speed, still, np.full(count, 1.0 / count), np.full(count, sightings),
            pose.x, pose.y, pose.theta, np.zeros(count),
        )  # fmt: skip

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Cloud):
            return NotImplemented
        return all(np.array_equal(getattr(self, f.name), getattr(other, f.name)) for f in fields(self))

    __hash__ = None  # type: ignore[assignment]  # arrays inside

    def __len__(self) -> int:
        return len(self.x)

    @property
    def effective(self) -> float:
        """How many equally weighted particles it is worth."""
        return float(1.0 / np.square(self.weight).sum())

    def begin_step(self) -> Cloud:
        """Return it with the present as the beginning of a time-step."""
        return replace(self, from_x=self.x, from_y=self.y, from_theta=self.theta, turned=np.zeros(len(self)))

    def pick(self, chosen: np.ndarray) -> Cloud:
        """Return the particles of these numbers, equally weighted."""
        parts = {f.name: getattr(self, f.name)[chosen] for f in fields(self)}
        return Cloud(**{**parts, "weight": np.full(len(chosen), 1.0 / len(chosen))})

    def put(self, where: np.ndarray, other: Cloud, share: float) -> Cloud:
        """Return it with the particles ``where`` replaced by ``other``, which get ``share`` of the weight."""
        parts = {f.name: getattr(self, f.name).copy() for f in fields(self)}
        for f in fields(self):
            parts[f.name][where] = getattr(other, f.name)
        weight = parts["weight"]
        weight[where] = 0.0
        rest = weight.sum()
        weight *= (1.0 - share) / rest if rest > 0 else 0.0
        weight[where] = (share if rest > 0 else 1.0) / len(where)
        return Cloud(**parts)

    def shaken(self, own: Pose, off: FloatArray, turn: FloatArray) -> Cloud:
        """Return it with the error of the hunter's odometry on it: all that the hunter sees is off by that.

        own: the hunter's pose. off: metres ahead [N]. turn: radians counter-clockwise [N].
        """
        dx, dy = self.x - own.x, self.y - own.y
        cos, sin = np.cos(turn), np.sin(turn)
        return replace(
            self,
            x=own.x + cos * dx - sin * dy + off * np.cos(own.theta),
            y=own.y + sin * dx + cos * dy + off * np.sin(own.theta),
            theta=np.asarray(wrap(self.theta + turn)),
        )

    def heading(self) -> tuple[float, float]:
        """Return the mean heading [rad] and its resultant, 0 (flat) to 1 (known); those that stand count as well."""
        return _direction(self.theta, self.weight)

    def heading_before(self) -> tuple[float, float]:
        """Return the same of where the time-step began, with all that has been seen since."""
        return _direction(self.from_theta, self.weight)

    def centre(self) -> tuple[float, float]:
        """Return the mean place [m]."""
        return float(self.weight @ self.x), float(self.weight @ self.y)


def _direction(theta: FloatArray, weight: FloatArray) -> tuple[float, float]:
    cos, sin = float(weight @ np.cos(theta)), float(weight @ np.sin(theta))
    return math.atan2(sin, cos), min(math.hypot(cos, sin), 1.0)


def systematic(weight: FloatArray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return ``count`` numbers of particles drawn by systematic resampling: each as often as its weight says, +- 1."""
    marks = (np.arange(count) + rng.random()) / count
    reach = np.cumsum(weight)
    chosen: np.ndarray = np.minimum(np.searchsorted(reach, marks * reach[-1]), len(weight) - 1)
    return chosen
