"""What pairs of gaits cost beside the time to the capture. Letters: G gaits, P part-way poses, K prey futures."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bayeshunt.core.geometry import FloatArray, Pose, placed
from bayeshunt.planners.cost import Charges
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.lookahead import Outlook, PairPaths

__all__ = ["PairCharge", "near_walls"]


@dataclass(frozen=True, eq=False)
class PairCharge:
    """Turns the expected time of pairs into all that they cost, in seconds of the fastest gait.

    charges: of the model. before: number of the gait just executed, -1: not known.
    near: whether the hunter is near a wall part-way through the first step [G, P] and the second [G, G, P]; None: it
        knows no walls.
    """

    charges: Charges
    before: int
    near: tuple[np.ndarray, np.ndarray] | None = None

    def __call__(self, outlook: Outlook) -> Outlook:
        """Return the outlook with costs for times; of each step only the share before the capture is charged."""
        charges, gaits = self.charges, len(self.charges.names)
        one, two = 1.0 - outlook.first.mean(axis=1), 1.0 - outlook.second.mean(axis=2)  # [G, K], [G, G, K]
        onward = np.maximum(outlook.time - charges.seconds * (one[:, None] + two), 0.0)
        begun = 1.0 - outlook.first[:, None, -1]  # P(the second step is begun) [G, 1, K]

        def spent(table: np.ndarray, per_second: float) -> np.ndarray:
            first, second = table[self.before][:, None, None], table[:gaits, :, None]
            return np.asarray(first * one[:, None] + second * two + per_second * onward)

        changes = charges.changes[self.before][:, None, None] + charges.changes[:gaits, :, None] * begun
        total: FloatArray = charges.cost.total(
            outlook.time, spent(charges.metres, charges.speed), changes, 0.0,
            spent(charges.joules, charges.joules_per_second), self._seconds_near(outlook),
        )  # fmt: skip
        return replace(outlook, time=total / charges.per_second)

    def _seconds_near(self, outlook: Outlook) -> np.ndarray | float:
        """Expected seconds near a wall before the capture [G, G, K]."""
        if self.near is None:
            return 0.0
        first, second = self.near
        inside = ((1.0 - outlook.first) * first[:, :, None]).sum(axis=1)[:, None]
        inside = inside + ((1.0 - outlook.second) * second[..., None]).sum(axis=2)
        return np.asarray(inside * (self.charges.seconds / first.shape[1]))


def near_walls(walls: Walls, pose: Pose, pairs: PairPaths, within: float) -> tuple[np.ndarray, np.ndarray]:
    """Return whether the part-way poses of pairs come within ``within`` [m] of where a wall stops the hunter.

    pose: the hunter's, in the frame of the start, as the walls are. Returns [G, P] and [G, G, P].
    """
    found = []
    for paths in (pairs.first, pairs.second):
        x, y = placed(pose, *paths[:2].mean(axis=-1))
        gaps = [offset - nx * x - ny * y for (nx, ny), offset in zip(walls.normals, walls.offsets, strict=True)]
        found.append(np.min(gaps, axis=0) < within if gaps else np.zeros(x.shape, dtype=bool))
    return found[0], found[1]
