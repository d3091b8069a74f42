"""What the planners that look two gaits ahead share: the choice and its explanation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.cost import Charges, Cost
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.charging import PairCharge, near_walls
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.lookahead import Charge, PairPaths, decide, look_ahead

__all__ = ["PairPlanner", "trace"]


class PairPlanner(Shown):
    """Chooses the pair of gaits of the earliest expected capture; ties go to the first in table order.

    homing: the estimate beyond both steps; each decision has its own :meth:`reach`. spread: metres, see
    :func:`look_ahead`. cost: what else is weighed.
    """

    def __init__(self, model: ForwardModel, homing: Homing, spread: float, cost: Cost) -> None:
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)
        self.time_step = model.gaits.need("duration")
        self.pairs = PairPaths.mean(model)
        after = self.gaits if depends_on_previous(model.structure) else ()
        #: Those that follow a gait, where that changes them.
        self.pairs_after = {gait: PairPaths.mean(model, gait) for gait in after}
        self.homing, self.spread = homing, spread
        self.charges = Charges(model, cost) if cost.of_gaits else None

    def pairs_from(self, situation: Situation) -> PairPaths:
        """Return the mean paths of every pair of gaits after the one just executed."""
        return self.pairs_after.get(situation.previous_gait or "", self.pairs)

    def reach(self, situation: Situation) -> float:
        """Return the distance between the centres that is a capture [m]; by default the homing estimate's."""
        return self.homing.reach

    def own_walls(self) -> Walls | None:
        """Return the walls at which the hunter's own centre is stopped, in the frame of the start; None: none known."""
        return None

    def charge(self, situation: Situation, pairs: PairPaths) -> Charge | None:
        """Return what a decision charges beside the time; None: nothing."""
        if self.charges is None:
            return None
        walls, near = self.own_walls(), None
        if self.charges.cost.clearance and walls is not None and situation.pose is not None:
            near = near_walls(walls, situation.pose, pairs, self.hunter.need("body_length"))
        return PairCharge(self.charges, self.charges.number(situation.previous_gait), near)

    @property
    def objective(self) -> str:
        """What the values of plans are."""
        weighed = "" if self.charges is None else f", weighed by {self.charges.cost}"
        return f"expected time to the capture{weighed} [s]"

    def choose(self, situation: Situation, pairs: PairPaths, futures: Futures, spread: float) -> Plan:
        """Return the best plan against ``futures``; spread: metres, see :func:`look_ahead`.

        ``prey_known`` is False until a transition has been seen; ``trace`` has one row per sequence of
        at most two gaits, see :func:`trace`; ``predicted_prey`` is the most probable future.
        """
        homing = self.homing
        if (reach := self.reach(situation)) != homing.reach:
            homing = replace(homing, reach=reach)
        charge = self.charge(situation, pairs)
        outlook = look_ahead(pairs, futures, homing, spread, charge)
        values, pair_values = decide(outlook, futures)
        return self.best(
            values, pair_values, self.objective,
            partial(trace, self.gaits, pairs, futures, homing, spread, charge), self.predicted(futures),
            prey_known=bool(situation.transitions),
        )  # fmt: skip

    def predicted(self, futures: Futures) -> Polar[FloatArray]:
        """Return the most probable future now and at the ends of both steps."""
        return futures.likeliest(np.array([1.0, 2.0]) * self.time_step)

    def best(
        self, values: np.ndarray, pair_values: np.ndarray, objective: str, make_trace: Callable[[], pd.DataFrame],
        prey: Polar[FloatArray], *, prey_known: bool,
    ) -> Plan:  # fmt: skip
        """Return the plan of the first gait of least value [G], and the second of the least value after it [G, G]."""
        first = int(values.argmin())
        second = int(pair_values[first].argmin())
        return Plan(
            gait=self.gaits[first],
            gaits=(self.gaits[first], self.gaits[second]),
            value=float(values[first]),
            objective=objective,
            nodes=1 + len(values) + pair_values.size,
            make_trace=make_trace,
            expansions=1 + len(values),
            prey_known=prey_known,
            predicted_prey=prey,
        )


def trace(
    gaits: tuple[str, ...], pairs: PairPaths, futures: Futures, homing: Homing, spread: float,
    charge: Charge | None = None,
) -> pd.DataFrame:  # fmt: skip
    """Return one row per sequence: the root, every first gait, every pair.

    T; gaits; gait (the last); hunter_* (mean pose at T); value_s: expected time of capture [s], charged, of a
    first gait with the best second one for what will then be seen; capture_probability: by the end
    of step T; capture_by_N: P(captured by t) at the N-th part-way time, NaN beyond the sequence's end.
    """
    outlook = look_ahead(pairs, futures, homing, spread, charge)
    values, pair_values = decide(outlook, futures)
    count, points = len(gaits), pairs.first.shape[2]
    first, second = np.repeat(np.arange(count), count), np.tile(np.arange(count), count)
    best = int(values.argmin())
    chosen = (first == best) & (second == int(pair_values[best].argmin()))
    curves = np.full((1 + count + count * count, 2 * points), np.nan)
    early = outlook.first @ futures.weights  # [G, P]
    curves[0] = 0.0
    curves[1 : 1 + count, :points] = early
    curves[1 + count :] = np.concatenate([early[first], (outlook.second @ futures.weights)[first, second]], axis=1)
    reached = np.concatenate([[0.0], early[:, -1], curves[1 + count :, -1]])
    x, y, heading = (
        np.concatenate([[0.0], one.mean(axis=-1), two.mean(axis=-1).ravel()])
        for one, two in zip(pairs.first_end, pairs.end, strict=True)
    )
    columns = {
        "node": np.arange(len(curves)),
        "parent": np.concatenate([[-1], np.zeros(count, dtype=int), 1 + first]),
        "T": np.repeat([0, 1, 2], [1, count, count * count]),
        "gaits": ["", *gaits, *(f"{gaits[i]}, {gaits[j]}" for i, j in zip(first, second, strict=True))],
        "gait": ["", *gaits, *(gaits[j] for j in second)],
        "hunter_forward": x,
        "hunter_right": y,
        "hunter_heading": np.asarray(wrap(heading)),
        "value_s": np.concatenate([[values[best]], values, pair_values.ravel()]),
        "capture_probability": reached,
        "chosen": np.concatenate([[True], np.arange(count) == best, chosen]),
        **{f"capture_by_{i + 1}": curves[:, i] for i in range(2 * points)},
    }
    return pd.DataFrame(columns)
