"""Babbling one's own robot, live: which gait next, and where each took it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pandas as pd

from bayeshunt.core.checks import check_whole, warn_of_degrees
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Pose
from bayeshunt.data.babbling_table import PROVENANCE_KEY

__all__ = ["Babbler"]


class Babbler:
    """Chooses gaits at random for a robot of one's own and keeps the babbling table.

    ``babbler.record(pose)`` says where the robot stands; then again and again ``gait = babbler.next()``, execute it,
    ``babbler.record(pose)``. Without that first record the first gait gives no row: nobody knows where it began. A
    record without a ``next`` before it says that the robot was put elsewhere: its next gait follows no other.

    gaits: a repertoire, a robot's settings, or Gait objects or names. seed: of the order; all come equally often.
    """

    def __init__(self, gaits: GaitRepertoire | Iterable[Gait | str], seed: int = 0) -> None:
        check_whole(seed, "seed", 0)
        self.gaits = GaitRepertoire.of(gaits)
        self.seed = int(seed)
        self._rng = np.random.default_rng(self.seed)
        self._waiting: list[int] = []  # of the present round
        self._pose: Pose | None = None
        self._gait: str | None = None  # handed out, not yet recorded
        self._previous: str | None = None
        self._rows: list[tuple[str, float, float, float, str | None]] = []

    def next(self) -> Gait:
        """Return the gait to execute now; InputError if the one before was not recorded."""
        if self._gait is not None:
            raise InputError(f"record where {self._gait!r} took the robot before asking for the next gait")
        if not self._waiting:
            self._waiting = self._rng.permutation(len(self.gaits)).tolist()
        gait: Gait = self.gaits[self._waiting.pop()]
        self._gait = gait.name
        return gait

    def record(self, own_pose: Pose) -> None:
        """Say where the robot is now: a pose [m, rad] in a fixed counter-clockwise frame, the same in every call.

        Raises InputError unless it is three finite numbers.
        """
        try:
            pose = Pose(*(float(part) for part in own_pose))
        except (TypeError, ValueError):
            raise InputError(f"own_pose: expected a Pose(x, y, theta) of numbers, got {shown(own_pose)}") from None
        if not all(map(math.isfinite, pose)):
            raise InputError(f"own_pose: expected finite numbers, got {pose}")
        if self._pose is None:
            warn_of_degrees(pose.theta, "own_pose")
        if self._gait is not None and self._pose is not None:
            self._rows.append((self._gait, *self._pose.relative(pose), self._previous))
        self._pose, self._previous, self._gait = pose, self._gait, None

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<Babbler: {len(self)} steps of {len(self.gaits)} gaits>"

    def table(self) -> pd.DataFrame:
        """Return the babbling table so far: gait, distance [m], angle and heading [rad clockwise], previous_gait."""
        columns = ["gait", "distance", "angle", "heading", "previous_gait"]
        frame = pd.DataFrame(self._rows, columns=columns)
        frame = frame.astype(dict.fromkeys(columns[1:4], float) | {"gait": object, "previous_gait": object})
        frame["previous_gait"] = frame["previous_gait"].where(frame["previous_gait"].notna(), None)
        frame.insert(0, "step", np.arange(len(frame), dtype=np.int64))
        frame.attrs[PROVENANCE_KEY] = {
            "kind": "babbling table", "source": "bayeshunt.Babbler", "seed": self.seed, "steps": len(frame),
            "gaits": list(self.gaits.names), "body_length": self.gaits.body_length, "duration": self.gaits.duration,
        }  # fmt: skip
        return frame
