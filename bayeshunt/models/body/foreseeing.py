"""What will happen: poses after a gait, expected and drawn, and how likely rows and evidence are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_generator, check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.data import babbling_table
from bayeshunt.models.body.opening import OpenTables
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.tables import sampling

__all__ = ["ForeseeingModel"]


class ForeseeingModel(OpenTables):
    """What says where gaits lead; a forward model does."""

    def predict(self, gait: Gait | str) -> Polar:
        """Return the expected pose after one step of ``gait``, in the robot's present frame.

        The mean of forward, right [m] and the circular mean heading over the babbled rows
        themselves (exact fixed-point sums), not over bin centres; of an imported network, which has no
        rows, over bin centres. Raises ZeroCountError if the gait was never babbled: a prior says nothing
        about a pose.
        """
        forward, right, heading = map(float, self.source.mean_pose(self.gaits.index(gait)))
        return Polar.from_cartesian(forward, right, heading)

    def sample(self, gait: Gait | str, n: int, *, rng: np.random.Generator) -> Polar[FloatArray]:
        """Return ``n`` outcomes of ``gait`` drawn from the network: Polar of arrays [n].

        In the paper's structure distance, angle and heading are drawn from their own CPT columns,
        independently; in any structure they are uniform within each bin.
        """
        index = self.gaits.index(gait)
        check_whole(n, "n", 0)
        check_generator(rng)
        return self.source.draw(index, rng.random((int(n), sampling.UNIFORMS)))

    def outcomes(self, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return the outcome of **every** gait for the same random numbers: Polar of arrays [G, ...].

        uniforms: [..., 6] in [0, 1): the first three choose the bins of Distance, Angle and Heading
        by inverse CDF, the last three the place inside them. One array shared by all gaits gives
        common random numbers. A bin of probability 0 is never chosen.
        """
        draws = sampling.check_uniforms(uniforms)
        poses = [self.source.draw(gait, draws) for gait in range(len(self.gaits))]
        return Polar(*(np.stack(parts) for parts in zip(*poses, strict=True)))

    @checked
    def log_likelihood(self, rows: pd.DataFrame | JointCounts | PreviousCounts) -> float:
        """Return sum over rows of log P(Gait) + log P(Distance, Angle, Heading | causes), natural log.

        rows: a babbling table, or its counts. With the gait before as a cause it must say which gait went before;
            as in learning, rows that no gait went before are left out. An imported network sums over it.
        -inf if the model gives some row probability 0 (with prior 0: a bin that the gait was never
        seen in; always: beyond the distance axis).
        """
        if isinstance(rows, (JointCounts, PreviousCounts)):
            return self.source.log_likelihood(rows)
        babbling_table.validate(rows, self.gaits.names)
        counted = type(self.source.counted).of(self.source.recast(rows), self.gaits, self.axes)
        return self.source.log_likelihood(counted)

    def evidence(
        self, distance_bins: Any, angle_bins: Any, heading_bins: Any = None, energy_bins: Any = None
    ) -> np.ndarray:
        """Return P(Gait, evidence) [..., G] for bin numbers, or arrays of them, of Distance, Angle, Heading, Energy."""
        try:
            return self.source.evidence(distance_bins, angle_bins, heading_bins, energy_bins)
        except (IndexError, TypeError):
            raise InputError("distance_bins, angle_bins, heading_bins: expected bin numbers or arrays") from None
