"""The inverse model: which gait leads there, P(Gait | Distance, Angle [, Heading]).

The forward model read backwards by Bayes' rule (the paper, section "Inverse model"):
``P(G | D, A) = P(G) P(D | G) P(A | G) / P(D, A)``. A target that no babbled row reached is replaced
by the nearest learned coordinate, nearest in metres. Everything is compiled once per model.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.errors import ImpossibleEvidenceError, InputError, ZeroCountError
from bayeshunt.geometry import wrap
from bayeshunt.models.forward import ForwardModel
from bayeshunt.models.nearest import NearestPoint
from bayeshunt.models.posterior import Cell, CellPosterior, Posterior

_PI, _TWO_PI, _INF = math.pi, 2.0 * math.pi, math.inf
_floor, _cos, _sin = math.floor, math.cos, math.sin
_make = tuple.__new__
#: Angular distances [rad] closer than this are ties.
_TIE = 1e-9


class InverseModel:
    """P(Gait | Distance, Angle [, Heading]) of a forward model; immutable.

    Learned coordinates are the (Distance, Angle) cells that babbled rows fell into.
    Letters: M learned coordinates, G gaits.

    Raises ZeroCountError if the forward model has counted nothing.
    """

    def __init__(self, model: ForwardModel) -> None:
        if not model.joint.total:
            raise ZeroCountError("the forward model has counted nothing, so it has no inverse; babble first")
        self.model = model
        distance, angle = model.axes.distance, model.axes.angle
        self._distance_width, self._distance_bins = distance.width, distance.bins
        self._angle_width, self._angle_bins, self._angle_edge = angle.width, angle.bins, angle.edges[0].item()
        self._cells = np.argwhere(model.joint.support > 0)  # [M, 2], sorted
        self._values, self._evidence = self._compile()
        self._sources = [self._source(row) for row in range(len(self._cells))]
        self._row_of = np.full((distance.bins, angle.bins), -1, dtype=np.int64)
        self._row_of[tuple(self._cells.T)] = np.arange(len(self._cells))
        self._own = [[self._sources[r] if r >= 0 else None for r in rows] for rows in self._row_of.tolist()]
        reach, bearing = distance.centres[self._cells[:, 0]], angle.centres[self._cells[:, 1]]
        self._nearest = NearestPoint(reach * np.cos(bearing), reach * np.sin(bearing))
        self._find = self._nearest.find
        self._others: dict[tuple[int, int, int | None], CellPosterior | None] = {}
        self._heading_counts: dict[tuple[int, int, int], int] | None = None

    def posterior(self, distance: float, angle: float, heading: float | None = None, *, snap: bool = True) -> Posterior:
        """Return P(Gait | evidence) for a target in the robot's frame.

        distance: metres, >= 0. angle, heading: radians clockwise; any finite value, it is wrapped.
        snap: use the target's own (Distance, Angle) cell if babbling reached it, else the learned
            cell whose centre is nearest in metres (ties: lowest index). If a heading is given and
            has probability 0 there, the nearest heading bin that has not.

        Raises InputError for a number out of range, and with ``snap=False``
        ImpossibleEvidenceError where P(evidence) = 0 in the target's own bins.
        """
        d, a = float(distance), float(angle)
        if not (0.0 <= d < _INF and -_INF < a < _INF):
            raise InputError(f"target ({distance}, {angle}): expected distance >= 0 [m] and a finite angle [rad]")
        # The arithmetic of Axis.index and wrap, inlined: this is the innermost loop of a hunt.
        a_bin = _PI - (_PI - a) % _TWO_PI
        a_bin = _floor(((a_bin if a_bin > -_PI else _PI) - self._angle_edge) / self._angle_width)
        d_bin = d / self._distance_width
        if heading is not None or not snap:
            return self._careful(d, a, heading, snap, d_bin, a_bin % self._angle_bins)
        if d_bin < self._distance_bins:
            source = self._own[int(d_bin)][a_bin % self._angle_bins]
            if source is not None:
                return _make(Posterior, (source, d, a, None, False))
        return _make(Posterior, (self._sources[self._find(d * _cos(a), d * _sin(a))], d, a, None, True))

    def posterior_many(self, distances: Any, angles: Any) -> np.ndarray:
        """Return float64 [N, G]: the values of :meth:`posterior` (snapping) for N targets at once.

        distances [m] >= 0 and angles [rad clockwise]: arrays [N], or a scalar beside an array.
        Raises InputError for a number out of range.
        """
        d, a = np.broadcast_arrays(np.asarray(distances, dtype=float), np.asarray(angles, dtype=float))
        d, a = np.ascontiguousarray(d.ravel()), np.ascontiguousarray(a.ravel())
        if not (np.all(d >= 0.0) and np.all(d < np.inf) and np.all(np.isfinite(a))):
            raise InputError("targets: expected distances >= 0 [m] and finite angles [rad]")
        return np.take(self._values, self._rows(d, a), axis=0)

    def table(self) -> pd.DataFrame:
        """Return the whole posterior table, one row per learned cell, in order of distance and angle.

        Columns: distance [m], angle [rad] (cell centres), support (rows), evidence_probability, and
        one column per gait.
        """
        cells = [source.cell for source in self._sources]
        frame = pd.DataFrame(
            {
                "distance": [cell.distance for cell in cells],
                "angle": [cell.angle for cell in cells],
                "support": [source.support for source in self._sources],
                "evidence_probability": self._evidence,
            }
        )
        return pd.concat([frame, pd.DataFrame(self._values, columns=list(self.model.gaits.names))], axis=1)

    def __reduce__(self) -> tuple[Any, ...]:
        return InverseModel, (self.model,)

    # --- inside -------------------------------------------------------------------------------

    def _joint(self, distance_bins: Any, angle_bins: Any, heading_bins: Any = None) -> np.ndarray:
        """P(Gait, evidence) [..., G] of the given bins."""
        p = self.model.probabilities
        joint = p("Gait") * p("Distance")[distance_bins] * p("Angle")[angle_bins]
        return joint if heading_bins is None else joint * p("Heading")[heading_bins]

    def _compile(self) -> tuple[np.ndarray, np.ndarray]:
        """Posterior [M, G] and P(evidence) [M] of every learned cell."""
        joint = self._joint(self._cells[:, 0], self._cells[:, 1])
        evidence = joint.sum(axis=1)
        values = joint / evidence[:, None]
        values.setflags(write=False)
        return values, evidence

    def _source(self, row: int) -> CellPosterior:
        d_bin, a_bin = self._cells[row].tolist()
        support = int(self.model.joint.support[d_bin, a_bin])
        cell, names = self._cell(d_bin, a_bin, None), self.model.gaits.names
        return CellPosterior(cell, names, self._values[row], float(self._evidence[row]), support)

    def _cell(self, d_bin: int, a_bin: int, h_bin: int | None) -> Cell:
        distance, angle, heading = self.model.axes
        place = (distance.centres[d_bin].item(), angle.centres[a_bin].item())
        cell = Cell(d_bin, a_bin, *place, distance.labels[d_bin], angle.labels[a_bin])
        if h_bin is None:
            return cell
        return cell._replace(
            heading_bin=h_bin, heading=heading.centres[h_bin].item(), heading_label=heading.labels[h_bin]
        )

    def _rows(self, d: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Row [N] of the learned cell that each target uses."""
        d_bins = d / self._distance_width
        inside = d_bins < self._distance_bins
        d_bins = np.where(inside, d_bins, 0.0).astype(np.int64)
        rows = np.where(inside, self._row_of[d_bins, self.model.axes.angle.index(a)], -1)
        far = np.flatnonzero(rows < 0)
        if far.size:
            d, a = d[far], a[far]
            rows[far] = self._nearest.find_many(d * np.cos(a), d * np.sin(a))
        return rows

    def _careful(self, d: float, a: float, heading: float | None, snap: bool, d_bin: float, a_bin: int) -> Posterior:
        """The answer when a heading is given or snapping is forbidden."""
        if heading is not None and not math.isfinite(heading):
            raise InputError(f"target heading {heading}: expected a finite angle [rad]")
        h = None if heading is None else float(heading)
        h_bin = None if h is None else self.model.axes.heading.index(h)
        inside = d_bin < self._distance_bins
        if not snap:
            source = self._evidence_source(int(d_bin), a_bin, h_bin) if inside else None
            if source is None:
                raise ImpossibleEvidenceError(self._impossible(d, a, h))
            return Posterior(source, d, a, h, False)
        place = self._own[int(d_bin)][a_bin] if inside else None
        snapped = place is None
        place = place or self._sources[self._find(d * _cos(a), d * _sin(a))]
        cell = place.cell
        source = self._evidence_source(cell.distance_bin, cell.angle_bin, h_bin)
        if source is None and h is not None:
            h_bin, snapped = self._nearest_heading(cell, h), True
            source = self._evidence_source(cell.distance_bin, cell.angle_bin, h_bin)
        if source is None:
            raise ImpossibleEvidenceError(self._impossible(d, a, h))
        return Posterior(source, d, a, h, snapped)

    def _evidence_source(self, d_bin: int, a_bin: int, h_bin: int | None) -> CellPosterior | None:
        """The posterior given exactly these bins, or None where P(evidence) = 0. Remembered."""
        key = (d_bin, a_bin, h_bin)
        if h_bin is None and self._own[d_bin][a_bin] is not None:
            return self._own[d_bin][a_bin]
        if key not in self._others:
            joint = self._joint(d_bin, a_bin, h_bin)
            total = joint.sum()
            self._others[key] = None
            if total > 0:
                values = joint / total
                values.setflags(write=False)
                cell, names = self._cell(d_bin, a_bin, h_bin), self.model.gaits.names
                self._others[key] = CellPosterior(cell, names, values, float(total), self._support(key))
        return self._others[key]

    def _support(self, key: tuple[int, int, int | None]) -> int:
        d_bin, a_bin, h_bin = key
        if h_bin is None:
            return int(self.model.joint.support[d_bin, a_bin])
        if self._heading_counts is None:
            self._heading_counts = {}
            for cell, count in zip(self.model.joint.cells.tolist(), self.model.joint.counts.tolist(), strict=True):
                place = (cell[1], cell[2], cell[3])
                self._heading_counts[place] = self._heading_counts.get(place, 0) + count
        return self._heading_counts.get((d_bin, a_bin, h_bin), 0)

    def _nearest_heading(self, cell: Cell, heading: float) -> int:
        """The heading bin nearest to ``heading`` of those possible in ``cell`` (ties: lowest)."""
        bins = np.arange(self.model.axes.heading.bins)
        possible = self._joint(cell.distance_bin, cell.angle_bin, bins).sum(axis=1) > 0
        gaps = np.abs(wrap(self.model.axes.heading.centres - heading))
        gaps = np.where(possible, gaps, np.inf)
        return int(np.flatnonzero(gaps <= gaps.min() + _TIE)[0])

    def _impossible(self, d: float, a: float, h: float | None) -> str:
        asked = f"Distance = {d:g} m, Angle = {math.degrees(a):g} deg"
        asked += "" if h is None else f", Heading = {math.degrees(h):g} deg"
        return f"P({asked}) = 0 under this model: no gait does that; snap=True gives the nearest learned cell"
