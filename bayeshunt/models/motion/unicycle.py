"""The command's own motion: forward speed and turning rate linear in the command, held for one time-step, along an arc.

For wheels that is the unicycle with its radius, effective base and asymmetry fitted: ``v = a . u``, ``w = b . u``; the
body then ends ``v sin(w) / w`` ahead and ``v (1 - cos(w)) / w`` to its left, both per time-step. Any number of
actuators will do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bayeshunt.core.errors import DataError
from bayeshunt.core.geometry import FloatArray, Polar, wrap

__all__ = ["Unicycle"]

#: Multiples of the linear turning rate that the search starts from: headings beyond half a turn look smaller.
_STARTS = (0.5, 1.0, 1.5, 2.0, 3.0)
_ROBUST = 0.3  # errors beyond this (typical steps, radians) count linearly


@dataclass(frozen=True)
class Unicycle:
    """Motion that a command asks for.

    forward: metres per time-step for one unit of each actuator [A]. left: radians counter-clockwise likewise [A].
    """

    forward: tuple[float, ...]
    left: tuple[float, ...]

    @classmethod
    def fit(cls, commands: FloatArray, outcomes: Polar[FloatArray]) -> Unicycle:
        """Fit to commands [N, A] and the poses after them (Polar of arrays [N]), by robust least squares.

        Raises DataError for fewer rows than unknowns.
        """
        from scipy.optimize import least_squares

        count, actuators = commands.shape
        if count < 2 * actuators:
            raise DataError(f"unicycle: {count} rows cannot fit the motion of {actuators} actuators")
        ahead, aside, turned = outcomes.forward, -outcomes.right, -np.asarray(outcomes.heading)
        scale = float(np.median(np.hypot(ahead, aside))) or 1.0
        size = np.abs(commands).max(axis=0)
        units = commands / np.where(size > 0, size, 1.0)
        signed = np.where(ahead < 0, -1.0, 1.0) * np.hypot(ahead, aside)
        start = np.linalg.lstsq(units, np.stack([signed, np.asarray(wrap(turned))], axis=1), rcond=None)[0]

        def errors(unknown: FloatArray) -> FloatArray:
            x, y, yaw = _arc(units, unknown[:actuators], unknown[actuators:])
            # the chord of the heading's error: the same for whole turns
            return np.concatenate([(x - ahead) / scale, (y - aside) / scale, 2 * np.sin((yaw - turned) / 2)])

        fits = [
            least_squares(errors, np.concatenate([start[:, 0], times * start[:, 1]]), loss="soft_l1", f_scale=_ROBUST)
            for times in _STARTS
        ]
        best = min(fits, key=lambda found: float(found.cost)).x / np.tile(np.where(size > 0, size, 1.0), 2)
        return cls(tuple(best[:actuators].tolist()), tuple(best[actuators:].tolist()))

    def predict(self, commands: FloatArray) -> Polar[FloatArray]:
        """Return the pose after one time-step of each command [N, A]: Polar of arrays [N], clockwise.

        The heading is not wrapped: it says how far the arc turned.
        """
        x, y, yaw = _arc(np.asarray(commands, dtype=float), np.array(self.forward), np.array(self.left))
        return Polar.from_cartesian(x, -y)._replace(heading=-yaw)


def _arc(commands: FloatArray, forward: FloatArray, left: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pose (x, y, yaw) [N] after the arcs of commands [N, A]."""
    length, turn = commands @ forward, commands @ left
    half = np.where(np.abs(turn) < 1e-9, 1e-9, turn) / 2
    chord = length * np.sin(half) / half
    return chord * np.cos(turn / 2), chord * np.sin(turn / 2), turn
