"""A belief made of particles, and the table of it that a person opens: P(prey in cell), as the hunter sees it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from bayeshunt.core import displays
from bayeshunt.core.geometry import FloatArray, Polar, Pose, wrap
from bayeshunt.perception.trackers.cloud import Cloud, systematic
from bayeshunt.perception.trackers.common import LEAST_RESULTANT
from bayeshunt.perception.trackers.motion import PreyMotion
from bayeshunt.perception.trackers.sightings import Eye

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["ParticleBelief"]

#: Rings of the table of what is believed, metres, and its sectors.
RINGS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.3, 1.7, 2.2, 3.0, math.inf)
SECTORS = 12


@dataclass(frozen=True, eq=False, repr=False)
class ParticleBelief(displays.Displayed):
    """Where the prey may be, as weighted particles; see ``bayeshunt.protocols.Belief``.

    time: seconds, of the observation. own: the hunter's pose then. expected: transitions that the prey may have made in
    the last step, with their probabilities (they sum to 1), empty if nothing was learned of it; motion: what is
    believed of how it moves.
    """

    time: float
    own: Pose
    cloud: Cloud
    motion: PreyMotion
    eye: Eye
    last_seen: float = math.inf
    transitions: tuple[Polar, ...] = ()
    expected: tuple[Polar[FloatArray], FloatArray] | None = None
    sightings: int = 0

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ParticleBelief):
            return NotImplemented
        return self._facts() == other._facts() and self.cloud == other.cloud

    __hash__ = None  # type: ignore[assignment]  # arrays inside

    def _facts(self) -> tuple[object, ...]:
        known = self.motion
        learned = (known.steps, known.turns, known.turn_counts, known.still_steps, known.speed_sum, known.drift_sum)
        return (self.time, self.own, self.last_seen, self.transitions, self.sightings, learned)

    @cached_property
    def mean(self) -> Pose:
        """Its expected pose; where the heading is as good as unknown, it is taken to go away from the hunter."""
        x, y = self.cloud.centre()
        theta, resultant = self.cloud.heading()
        if resultant < LEAST_RESULTANT:
            theta = math.atan2(y - self.own.y, x - self.own.x)
        return Pose(x, y, theta)

    @cached_property
    def resultant(self) -> float:
        """How sure the heading is, 0 (unknown) to 1 (known)."""
        return self.cloud.heading()[1]

    @cached_property
    def covariance(self) -> FloatArray:
        """Of x, y, theta: [3, 3]; that of theta is -2 log resultant."""
        weight, mean = self.cloud.weight, self.mean
        off = np.stack([self.cloud.x - mean.x, self.cloud.y - mean.y, np.asarray(wrap(self.cloud.theta - mean.theta))])
        matrix = np.array((off * weight) @ off.T)
        matrix[2, 2] = -2.0 * math.log(max(self.resultant, 1e-12))
        matrix.setflags(write=False)
        return matrix

    @property
    def spread(self) -> float:
        """Metres: the standard deviation of the place, over both directions."""
        return math.sqrt(float(self.covariance[0, 0] + self.covariance[1, 1]))

    def sample(self, n: int, *, rng: np.random.Generator) -> Pose[FloatArray]:
        """Return ``n`` poses that it may have."""
        return self.sample_motion(n, rng=rng)[0]

    def sample_motion(self, n: int, *, rng: np.random.Generator) -> tuple[Pose[FloatArray], FloatArray]:
        """Return ``n`` poses that it may have, and its speed [m/s] in each; 0 where it stands."""
        chosen = systematic(self.cloud.weight, n, rng)
        cloud = self.cloud
        speed = np.where(cloud.still[chosen], 0.0, cloud.speed[chosen])
        return Pose(cloud.x[chosen], cloud.y[chosen], cloud.theta[chosen]), speed

    def seen(self) -> Polar[FloatArray]:
        """Return every particle as the hunter sees it now: Polar of arrays [N]."""
        return self.own.relative(Pose(self.cloud.x, self.cloud.y, self.cloud.theta))

    def in_view(self) -> float:
        """Return the probability that it is in view now."""
        inside = self.eye.camera.in_view(self.seen(), self.eye.width)
        return min(float(self.cloud.weight @ inside), 1.0)

    def table(self) -> pd.DataFrame:
        """Return P(prey in cell) for every ring and sector about the hunter, a row a cell, the nearest ring first.

        Index: Distance "200 to 300 mm", Angle "-15 to 15 deg" (clockwise). Columns: probability, sums to 1; sightings:
        how many sightings of this hunt the particles in the cell explain, on average (0: nobody looked, or nobody saw
        it there: the cell rests on the motion model alone); heading: resultant of the particles' headings in the cell,
        0 (any) to 1 (one); still: probability that it stands, if it is there.
        """
        import pandas as pd

        index = pd.MultiIndex.from_product([_rings(), _sectors()], names=["Distance", "Angle"])
        return pd.DataFrame(self._histogram(), index=index)

    def cells(self, least: float = 0.005) -> list[list[float]]:
        """Return the table's cells that hold at least ``least``, the likeliest first, as plain numbers.

        [nearest m, farthest m, from rad, to rad (clockwise), probability, sightings] each; the last ring ends at inf.
        """
        columns = self._histogram()
        probability, sightings = columns["probability"], columns["sightings"]
        width, rows = 2.0 * math.pi / SECTORS, []
        for cell in np.argsort(-probability, kind="stable").tolist():
            if probability[cell] < least:
                break
            ring, centre = cell // SECTORS, width * (cell % SECTORS) - math.pi
            place = [RINGS[ring], RINGS[ring + 1], centre - 0.5 * width, centre + 0.5 * width]
            rows.append([*place, float(probability[cell]), float(sightings[cell])])
        return rows

    def _histogram(self) -> dict[str, FloatArray]:
        """The table's columns, ring by ring and sector by sector."""
        seen, cloud = self.seen(), self.cloud
        width = 2.0 * math.pi / SECTORS
        ring = np.clip(np.searchsorted(RINGS, seen.distance, side="right") - 1, 0, len(RINGS) - 2)
        sector = np.floor((seen.angle + 0.5 * width + math.pi) / width).astype(int) % SECTORS
        cell, count = ring * SECTORS + sector, (len(RINGS) - 1) * SECTORS

        def summed(values: FloatArray) -> FloatArray:
            return np.asarray(np.bincount(cell, weights=cloud.weight * values, minlength=count), dtype=float)

        total = summed(np.ones(len(cloud)))
        share = np.where(total > 0.0, total, 1.0)
        return {
            "probability": total / total.sum(),
            "sightings": summed(cloud.sightings) / share,
            "heading": np.hypot(summed(np.cos(cloud.theta)), summed(np.sin(cloud.theta))) / share,
            "still": summed(cloud.still.astype(float)) / share,
        }

    def __repr__(self) -> str:
        seen = "never seen" if math.isinf(self.last_seen) else f"last seen {self.last_seen:.3g} s ago"
        place = self.own.relative(self.mean)
        return (
            f"<ParticleBelief: {1000 * place.distance:.0f} mm away at {math.degrees(place.angle):.0f} deg, "
            f"give or take {1000 * self.spread:.0f} mm; {seen}; {len(self.cloud)} particles>"
        )


def _rings() -> list[str]:
    inner = [f"{low * 1000:g} to {high * 1000:g} mm" for low, high in pairwise(RINGS[:-1])]
    return [*inner, f"over {RINGS[-2] * 1000:g} mm"]


def _sectors() -> list[str]:
    width = 360.0 / SECTORS
    centres = [width * sector - 180.0 for sector in range(SECTORS)]
    return [f"{centre - 0.5 * width:g} to {centre + 0.5 * width:g} deg" for centre in centres]
