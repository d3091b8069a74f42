"""Shared by the hunters that aim at a point: where the prey was, when it can be met, which gait leads there."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.planners.api import Plan, Situation

__all__ = ["Steering", "intercept_time", "prey_track"]


class Steering:
    """What each gait does on average, and the choice of the gait that leads to a point.

    gaits: names, in table order. forward, right: mean end of each gait [G] (metres); heading: radians clockwise [G].
    reach: distance of the farthest of these ends, metres. hunter: the gaits, with the body's length and the time-step.
    """

    def __init__(self, model: ForwardModel) -> None:
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)
        ends = [model.predict(gait) for gait in self.gaits]
        self.forward, self.right = np.array([e.forward for e in ends]), np.array([e.right for e in ends])
        self.heading = np.array([float(e.heading) for e in ends])
        self.reach = float(np.hypot(self.forward, self.right).max())
        before = self.gaits if depends_on_previous(model.structure) else ()
        self._after = {gait: Steering(model.after(gait)) for gait in before}

    def after(self, previous_gait: str | None) -> Steering:
        """Return what each gait does after the one just executed, where that changes it."""
        return self._after.get(previous_gait or "", self)

    @property
    def top_speed(self) -> float:
        """Metres per second of the gait that reaches farthest; InputError if the model does not know its time-step."""
        return self.reach / self.hunter.need("duration")

    def towards(self, forward: float, right: float, *, heading: float = math.nan, prey_known: bool = False) -> Plan:
        """Return the plan to execute the gait whose mean end is nearest to a point [m]; a tie goes to the first.

        heading: what the prey faces there [rad clockwise], NaN if that is not known.
        """
        miss = np.hypot(self.forward - forward, self.right - right)
        target = Polar.from_cartesian(forward, right, heading)
        return self.plan(miss, "distance from the gait's mean end to the point aimed at [m]", target, prey_known)

    def plan(self, values: np.ndarray, objective: str, target: Polar, prey_known: bool) -> Plan:
        """Return the plan to execute the gait of least value [G]."""
        best = int(np.argmin(values))
        aimed_at = Polar(*map(float, target))
        return Plan(
            gait=self.gaits[best],
            gaits=(self.gaits[best],),
            value=float(values[best]),
            objective=objective,
            nodes=len(self.gaits),
            make_trace=partial(_trace, self, values, aimed_at, best),
            target=aimed_at,
            prey_known=prey_known,
        )


def _trace(steering: Steering, values: np.ndarray, target: Polar, best: int) -> pd.DataFrame:
    """One row per gait: its mean end, what it is judged by, and the point aimed at."""
    return pd.DataFrame(
        {
            "node": np.arange(len(steering.gaits)),
            "gait": list(steering.gaits),
            "end_forward": steering.forward,
            "end_right": steering.right,
            "end_heading": steering.heading,
            "value": values,
            "target_distance": target.distance,
            "target_angle": target.angle,
            "chosen": np.arange(len(steering.gaits)) == best,
        }
    )


def prey_track(situation: Situation) -> Polar[FloatArray]:
    """Return where the prey was at each time-step observed, oldest first: Polar of arrays [K + 1].

    Every pose is in the hunter's present frame; the last is the prey now. It follows from the
    transitions seen, each undone in turn: ``pose[k - 1] = pose[k] o transition[k]^-1``.
    """
    poses = [situation.prey]
    for transition in reversed(situation.transitions):
        here = Polar(0.0, 0.0, 0.0).seen_from(transition)  # the earlier pose, seen from the later one
        poses.append(poses[-1].compose(here))
    return Polar(*(np.array([float(p[i]) for p in reversed(poses)]) for i in range(3)))


def intercept_time(ahead: float, right: float, v_ahead: float, v_right: float, speed: float, reach: float) -> float:
    """Return the least t >= 0 at which a point of ``speed`` [m/s] can be within ``reach`` [m] of a straight mover.

    ahead, right: where the mover is now [m]; v_ahead, v_right: its velocity [m/s].
    ``|p + v t| = speed t + reach``; inf if the mover gets away.
    """
    gap = ahead * ahead + right * right - reach * reach
    if gap <= 0:
        return 0.0
    a = v_ahead * v_ahead + v_right * v_right - speed * speed
    b = ahead * v_ahead + right * v_right - speed * reach
    if abs(a) < 1e-15:
        return -gap / (2 * b) if b < 0 else math.inf
    root = b * b - a * gap
    if root < 0:
        return math.inf
    times = sorted(((-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a))
    return next((t for t in times if t >= 0 and speed * t + reach >= 0), math.inf)
