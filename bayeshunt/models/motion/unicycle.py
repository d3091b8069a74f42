"""The command's own motion: forward speed and turning rate linear in the command, held for one time-step, along an arc.

For wheels that is the unicycle with its radius, effective base and asymmetry fitted: ``v = a . u``, ``w = b . u``; the
body then ends ``v sin(w) / w`` ahead and ``v (1 - cos(w)) / w`` to its left, both per time-step. Any number of
actuators will do.

Where it is known what was commanded before, each of the two speeds lags: it goes from that of the command before to its
own as a first-order system does, ``s(t) = v + (s0 - v) exp(-t / lag)``, whose mean over the first part p of a time-step
is ``v + (s0 - v) (lag / p) (1 - exp(-p / lag))``. The command before is taken as settled.
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
#: A lag [time-steps]: where its search starts, and its ends; rows after another command that tell of it, at least.
_LAG, _SHORTEST, _LONGEST = 0.3, 1e-3, 3.0
_CHANGES = 30


@dataclass(frozen=True)
class Unicycle:
    """Motion that a command asks for.

    forward: metres per time-step for one unit of each actuator [A]. left: radians counter-clockwise likewise [A].
    lag: time constants of the forward speed and of the turning rate, in time-steps; 0: a command acts at once.
    """

    forward: tuple[float, ...]
    left: tuple[float, ...]
    lag: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def fit(cls, commands: FloatArray, outcomes: Polar[FloatArray], before: FloatArray | None = None) -> Unicycle:
        """Fit to commands [N, A] and the poses after them (Polar of arrays [N]), by robust least squares.

        before: the commands before them [N, A], NaN where not known; with 30 changes of command the lag is fitted too.
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

        def apart(x: FloatArray, y: FloatArray, yaw: FloatArray) -> FloatArray:
            # the chord of the heading's error: the same for whole turns
            return np.concatenate([(x - ahead) / scale, (y - aside) / scale, 2 * np.sin((yaw - turned) / 2)])

        def errors(unknown: FloatArray) -> FloatArray:
            return apart(*_arc(units @ unknown[:actuators], units @ unknown[actuators:]))

        fits = [
            least_squares(errors, np.concatenate([start[:, 0], times * start[:, 1]]), loss="soft_l1", f_scale=_ROBUST)
            for times in _STARTS
        ]
        best, lag = min(fits, key=lambda found: float(found.cost)).x, (0.0, 0.0)
        if before is not None and (changed := np.abs(before - commands).max(axis=1) > 0).sum() >= _CHANGES:
            from_units = np.where(changed[:, None], before, commands) / np.where(size > 0, size, 1.0)

            def lagging(unknown: FloatArray) -> FloatArray:
                rates = [(units @ half, from_units @ half) for half in np.split(unknown[:-2], 2)]
                return apart(*_arc(*(_mean(*pair, float(t)) for pair, t in zip(rates, unknown[-2:], strict=True))))

            ends = np.full(len(best), np.inf)
            within = (np.append(-ends, [_SHORTEST] * 2), np.append(ends, [_LONGEST] * 2))
            found = least_squares(lagging, [*best, _LAG, _LAG], loss="soft_l1", f_scale=_ROBUST, bounds=within)
            best, lag = found.x[:-2], (float(found.x[-2]), float(found.x[-1]))
        best = best / np.tile(np.where(size > 0, size, 1.0), 2)
        return cls(tuple(best[:actuators].tolist()), tuple(best[actuators:].tolist()), lag)

    @property
    def lags(self) -> bool:
        """Whether it matters what was commanded before."""
        return max(self.lag) > 0

    def predict(
        self, commands: FloatArray, before: FloatArray | None = None, part: float | FloatArray = 1.0
    ) -> Polar[FloatArray]:
        """Return the pose after a part of a time-step of each command [N, A]: Polar of arrays [N], clockwise.

        before: the commands before them [N, A]; NaN, or None for all: as if they went on from long before.
        part: 0 to 1, one for all or [N]. The heading is not wrapped: it says how far the arc turned.
        """
        told = np.asarray(commands, dtype=float)
        length, turn = told @ np.array(self.forward), told @ np.array(self.left)
        if before is not None and self.lags:
            start = np.where(np.isfinite(before), before, told)
            length = _mean(length, start @ np.array(self.forward), self.lag[0], part)
            turn = _mean(turn, start @ np.array(self.left), self.lag[1], part)
        x, y, yaw = _arc(length * part, turn * part)
        return Polar.from_cartesian(x, -y)._replace(heading=-yaw)


def _mean(to: FloatArray, start: FloatArray, lag: float, part: float | FloatArray = 1.0) -> FloatArray:
    """Mean speed [N] over the first ``part`` of a time-step, from ``start`` to ``to`` with time constant ``lag``."""
    if lag <= 0:
        return to
    share = np.asarray(part, dtype=float) / lag
    return np.asarray(to + (start - to) * -np.expm1(-share) / share)


def _arc(length: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pose (x, y, yaw) [N] after arcs of a length and a turn [N]."""
    half = np.where(np.abs(turn) < 1e-9, 1e-9, turn) / 2
    chord = length * np.sin(half) / half
    return chord * np.cos(turn / 2), chord * np.sin(turn / 2), turn
