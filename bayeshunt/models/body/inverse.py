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

from bayeshunt.core import displays
from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import ENERGY
from bayeshunt.core.checks import FULL_TURN, check_bearings, check_kind, check_number, check_numbers, check_radians
from bayeshunt.core.errors import ImpossibleEvidenceError, InputError, ZeroCountError, shown, warn
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Polar, Pose, wrap
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.nearest import FARTHEST, CellFinder
from bayeshunt.models.body.posterior import Cell, CellPosterior, Posterior
from bayeshunt.models.tables.structures import PREVIOUS, depends_on_previous

__all__ = ["InverseModel"]

_PI, _TWO_PI, _INF = math.pi, 2.0 * math.pi, math.inf
#: Angles of a target may be this many turns off: sums of a bearing and a turn; degrees go far beyond.
_TURNS = 2
_FARTHEST_TURN = _TURNS * FULL_TURN
_floor = math.floor
_make = tuple.__new__
#: Targets that a belief is asked for.
_SAMPLES = 1000
#: A target this many times farther than what was ever reached is hardly one in metres.
_TIMES = 100
#: Angular distances [rad] closer than this are ties.
_TIE = 1e-9


class InverseModel(displays.Displayed):
    """P(Gait | Distance, Angle [, Heading]) of a forward model; immutable.

    Learned coordinates are the (Distance, Angle) cells that babbled rows fell into; in an imported
    network, which has no rows, the cells of positive probability.
    Letters: M learned coordinates, G gaits.

    Raises ZeroCountError if the forward model has counted nothing.
    """

    @checked
    def __init__(self, model: ForwardModel) -> None:
        model = model.binned
        self._cells = model.learned_cells  # [M, 2], sorted
        if not len(self._cells):
            raise ZeroCountError("the forward model has counted nothing, so it has no inverse; babble first")
        self.model = model
        distance, angle, _ = model.axes
        self._distance_width, self._distance_bins = distance.width, distance.bins
        self._angle_width, self._angle_edge, self._angle_bins = angle.width, angle.edges[0].item(), angle.bins
        self._values, self._evidence = self._compile()
        # Answers are made when first asked for: a wide table has tens of thousands.
        self._sources: list[CellPosterior | None] = [None] * len(self._cells)
        self._rows = dict(zip(map(tuple, self._cells.tolist()), range(len(self._cells)), strict=True))
        self._implausible = _TIMES * self._distance_width * (int(self._cells[:, 0].max()) + 1)
        self._finder = CellFinder(distance, angle, self._cells)
        self._nearest = self._finder.nearest
        self._known: dict[tuple[int, int, int | None, int | None], CellPosterior | None] = {}
        self._heading_counts: dict[tuple[int, int, int], int] | None = None
        self._depends = depends_on_previous(model.structure) or PREVIOUS in model.known
        self._after: dict[str, InverseModel] = {}

    def after(self, previous_gait: Gait | str | None) -> InverseModel:
        """Return P(Gait | Distance, Angle [, Heading], PreviousGait): the inverse of ``model.after(previous_gait)``.

        None: nothing is known of the gait before. The same inverse, whatever is given, unless the
        structure is "previous_gait". Learned coordinates are those reached right after that gait. Remembered.
        Raises InputError for a gait that is not in the repertoire.
        """
        if not self._depends:  # every decision of a reactive hunter passes here
            return self
        part = self.model.after(previous_gait)
        if part is self.model:
            return self
        name = part.known.get(PREVIOUS, "")
        if name not in self._after:
            self._after[name] = InverseModel(part)
        return self._after[name]

    def posterior(
        self, distance: float, angle: float, heading: float | None = None, *, energy: float | None = None,
        snap: bool = True,
    ) -> Posterior:  # fmt: skip
        """Return P(Gait | evidence) for a target in the robot's frame.

        distance: metres, >= 0. angle, heading: radians clockwise, -4 pi to 4 pi; they are wrapped.
        snap: use the target's own (Distance, Angle) cell if babbling reached it, else the learned
            cell whose centre is nearest in metres (ties: lowest index). If a heading is given and
            has probability 0 there, the nearest heading bin that has not; likewise energy.
        energy: joules that the step is to cost, >= 0; of models with Energy as a node.

        Issues a DataWarning for a distance over 100 times the farthest learned, which is likelier one in millimetres.
        Raises InputError for a number out of range, and with ``snap=False``
        ImpossibleEvidenceError where P(evidence) = 0 in the target's own bins.
        """
        try:
            d, a = float(distance), float(angle)
        except (TypeError, ValueError):  # no check beforehand: this is the innermost loop of a hunt
            raise InputError(f"target: expected two numbers, got {shown(distance)} and {shown(angle)}") from None
        if not (0.0 <= d <= FARTHEST and -_FARTHEST_TURN <= a <= _FARTHEST_TURN):
            if not (0.0 <= d <= FARTHEST and -_INF < a < _INF):
                raise InputError(f"target ({distance}, {angle}): expected 0 to {FARTHEST:g} m and a finite angle [rad]")
            check_radians(a, "target angle", _TURNS)
        # The arithmetic of Axis.index and wrap, inlined: this is the innermost loop of a hunt.
        d_bins = d / self._distance_width
        a_bins = ((a if -_PI < a <= _PI else wrap(a)) - self._angle_edge) / self._angle_width
        row = self._rows.get((int(d_bins), _floor(a_bins) % self._angle_bins))
        snapped = row is None
        if row is None:
            if d > self._implausible:
                self._warn_of_millimetres(d)
            row = self._nearest(d, a, d_bins, a_bins)
        source = self._sources[row] or self._source(row)
        if heading is None and energy is None and snap is True:
            return _make(Posterior, (source, d, a, None, snapped, None))
        check_kind(snap, "snap", bool, "True or False")
        return self._careful(Posterior(source, d, a, heading, snapped, energy), snap)

    def posterior_many(self, distances: Any, angles: Any) -> np.ndarray:
        """Return float64 [N, G]: the values of :meth:`posterior` (snapping) for N targets at once.

        distances [m] >= 0 and angles [rad clockwise]: arrays [N], or a scalar beside an array.
        Raises InputError for a number out of range.
        """
        d, a = check_numbers(distances, "distances"), check_numbers(angles, "angles")
        try:
            d, a = np.broadcast_arrays(d, a)
        except ValueError:
            raise InputError(f"targets: {d.size} distances and {a.size} angles; expected as many of both") from None
        d, a = np.ascontiguousarray(d.ravel()), np.ascontiguousarray(a.ravel())
        if d.size and not (d.min() >= 0.0 and d.max() <= FARTHEST and a.min() > -_INF and a.max() < _INF):
            raise InputError(f"targets: expected distances of 0 to {FARTHEST:g} m and finite angles [rad]")
        check_bearings(a, "target angles", _TURNS)
        if d.size and d.max() > self._implausible:
            self._warn_of_millimetres(float(d.max()))
        return np.take(self._values, self._finder.find_many(d, a), axis=0)

    def _warn_of_millimetres(self, distance: float) -> None:
        warn(
            f"target distance: {distance:g} m, but the farthest learned coordinate ends at "
            f"{self._implausible / _TIMES:.3g} m; if it is in millimetres, give {distance / 1000:g}"
        )

    def posterior_of(self, samples: Any, weights: Any = None) -> pd.Series:
        """Return ``sum_k w_k P(Gait | target_k)``: which gait leads there when the target is not a point.

        samples: K targets in the robot's frame: a Polar of arrays [K], a Pose of arrays [K] (counter-clockwise), a
            DataFrame with columns distance [m] and angle [rad clockwise], or an array [K, 2] of both. A belief whose
            frame is the robot's own is asked for 1,000 samples, the same every time.
        weights: [K], >= 0, not all 0; they need not sum to 1. None: equal.

        Raises InputError for samples or weights of another kind, or out of range.
        """
        distances, angles = _targets(samples)
        answers = self.posterior_many(distances, angles)
        if not len(answers):
            raise InputError("samples: expected at least one target")
        shares = np.ones(len(answers)) if weights is None else check_numbers(weights, "weights")
        if shares.shape != (len(answers),) or not (
            np.isfinite(shares).all() and shares.min() >= 0 and shares.sum() > 0
        ):
            raise InputError(f"weights: expected {len(answers)} numbers >= 0, one a target, not all 0")
        mixed = (shares / shares.sum()) @ answers
        return pd.Series(mixed, index=pd.Index(self.model.gaits.names, name="Gait"), name="probability")

    def table(self) -> pd.DataFrame:
        """Return the whole posterior table, one row per learned cell, in order of distance and angle.

        Columns: distance [m], angle [rad] (cell centres), support (rows; all missing, as Int64, in an
        imported network), evidence_probability, and one column per gait.
        """
        distance, angle, _ = self.model.axes
        bins = tuple(self._cells.T)
        known = self.model.has_counts
        frame = pd.DataFrame(
            {
                "distance": distance.centres[bins[0]],
                "angle": angle.centres[bins[1]],
                "support": self.model.joint.support[bins] if known else pd.array([None] * len(bins[0]), dtype="Int64"),
                "evidence_probability": self._evidence,
            }
        )
        return pd.concat([frame, pd.DataFrame(self._values, columns=list(self.model.gaits.names))], axis=1)

    def __repr__(self) -> str:
        learned = "learned " if self.model.has_counts else ""
        return f"<InverseModel: {len(self._cells)} {learned}coordinates, {len(self.model.gaits)} gaits>"

    def __reduce__(self) -> tuple[Any, ...]:
        return InverseModel, (self.model,)

    # --- inside -------------------------------------------------------------------------------

    def _joint(
        self, distance_bins: Any, angle_bins: Any, heading_bins: Any = None, energy_bins: Any = None
    ) -> np.ndarray:
        """P(Gait, evidence) [..., G] of the given bins."""
        return self.model.evidence(distance_bins, angle_bins, heading_bins, energy_bins)

    def _compile(self) -> tuple[np.ndarray, np.ndarray]:
        """Posterior [M, G] and P(evidence) [M] of every learned cell."""
        joint = self._joint(self._cells[:, 0], self._cells[:, 1])
        evidence = joint.sum(axis=1)
        values = joint / evidence[:, None]
        values.setflags(write=False)
        return values, evidence

    def _source(self, row: int) -> CellPosterior:
        """The posterior of a learned cell. Remembered."""
        d_bin, a_bin = self._cells[row].tolist()
        cell, support = self._cell(d_bin, a_bin, None), self._support((d_bin, a_bin, None))
        source = CellPosterior(cell, self.model, self._values[row], float(self._evidence[row]), support)
        self._sources[row] = source
        return source

    def _cell(self, d_bin: int, a_bin: int, h_bin: int | None, e_bin: int | None = None) -> Cell:
        distance, angle, heading = self.model.axes
        place = (distance.centres[d_bin].item(), angle.centres[a_bin].item())
        cell = Cell(d_bin, a_bin, *place, distance.labels[d_bin], angle.labels[a_bin])
        if e_bin is not None:
            axis = self.model.axes[ENERGY]
            cell = cell._replace(energy_bin=e_bin, energy=axis.centres[e_bin].item(), energy_label=axis.labels[e_bin])
        if h_bin is None:
            return cell
        return cell._replace(
            heading_bin=h_bin, heading=heading.centres[h_bin].item(), heading_label=heading.labels[h_bin]
        )

    def _careful(self, found: Posterior, snap: bool) -> Posterior:
        """The answer when a heading is given or snapping is forbidden; ``found`` has the cell used."""
        source, d, a, heading, snapped, energy = found
        e_bin = None if energy is None else self._energy_bin(energy)
        h = None if heading is None else check_number(heading, "target heading", "a finite angle [rad]")
        if h is not None:
            check_radians(h, "target heading", _TURNS)
        axes = self.model.axes
        h_bin = None if h is None else axes.heading.index(h)
        if not snap:
            place = (axes.distance.index(d), axes.angle.index(a))
        else:
            place = (source.cell.distance_bin, source.cell.angle_bin)
        answer = self._evidence_source(*place, h_bin, e_bin)
        if answer is None and snap and h is not None and self._evidence_source(*place, h_bin) is None:
            h_bin, snapped = self._nearest_heading(source.cell, h), True
            answer = self._evidence_source(*place, h_bin, e_bin)
        if answer is None and snap and energy is not None:
            e_bin, snapped = self._nearest_energy(place, h_bin, energy), True
            answer = self._evidence_source(*place, h_bin, e_bin)
        if answer is None:
            raise ImpossibleEvidenceError(_impossible(d, a, h, energy))
        return Posterior(answer, d, a, h, snap and snapped, energy)

    def _energy_bin(self, energy: float) -> int:
        """The bin of an energy, perhaps beyond the last; InputError where Energy is no node, or for no joules >= 0."""
        axis = self.model.axes.energy
        if axis is None:
            raise InputError("energy: this model has no node Energy; fit it with effects=[..., 'Energy']")
        joules = check_number(energy, "target energy", "joules >= 0")
        if joules < 0:
            raise InputError(f"target energy: expected joules >= 0, got {joules:g}")
        return int(axis.index(joules))

    def _nearest_energy(self, place: tuple[int, int], h_bin: int | None, energy: float) -> int:
        """The bin of energy nearest to ``energy`` of those possible there (ties: lowest)."""
        axis = self.model.axes[ENERGY]
        possible = np.array([self._joint(*place, h_bin, e).sum() > 0 for e in range(axis.bins)])
        gaps = np.where(possible, np.abs(axis.centres - energy), np.inf)
        return int(np.flatnonzero(gaps <= gaps.min() + _TIE)[0])

    def _evidence_source(
        self, d_bin: int, a_bin: int, h_bin: int | None, e_bin: int | None = None
    ) -> CellPosterior | None:
        """The posterior given exactly these bins, or None where P(evidence) = 0. Remembered."""
        if d_bin >= self._distance_bins or (e_bin is not None and e_bin >= self.model.axes[ENERGY].bins):
            return None
        row = None if h_bin is not None or e_bin is not None else self._rows.get((d_bin, a_bin))
        if row is not None:
            return self._sources[row] or self._source(row)
        key = (d_bin, a_bin, h_bin, e_bin)
        if key not in self._known:
            joint = self._joint(d_bin, a_bin, h_bin, e_bin)
            total = joint.sum()
            self._known[key] = None
            if total > 0:
                values = joint / total
                values.setflags(write=False)
                cell = self._cell(*key)
                self._known[key] = CellPosterior(cell, self.model, values, float(total), self._support(key[:3]))
        return self._known[key]

    def _support(self, key: tuple[int, int, int | None]) -> int | None:
        """Rows that fell into these bins; None where nobody knows."""
        if not self.model.has_counts:
            return None
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


def _targets(samples: Any) -> tuple[Any, Any]:
    """Distances and angles [K] of targets given in one of three ways."""
    if callable(sample := getattr(samples, "sample", None)) and not isinstance(samples, pd.DataFrame):
        samples = sample(_SAMPLES, rng=np.random.default_rng(0))
    if isinstance(samples, Pose):
        samples = Pose(0.0, 0.0, 0.0).relative(Pose(*map(np.atleast_1d, samples)))
    if isinstance(samples, Polar):
        return np.atleast_1d(samples.distance), np.atleast_1d(samples.angle)
    if isinstance(samples, pd.DataFrame):
        if missing := [name for name in ("distance", "angle") if name not in samples]:
            raise InputError(f"samples: the table has no column {missing[0]!r}")
        return samples["distance"].to_numpy(), samples["angle"].to_numpy()
    try:
        array = np.asarray(samples, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(
            "samples: expected a Polar of arrays, a table with columns distance and angle, or an array [K, 2]"
        )
    return array[:, 0], array[:, 1]


def _impossible(d: float, a: float, h: float | None, energy: float | None = None) -> str:
    asked = f"Distance = {d:g} m, Angle = {math.degrees(a):g}°"
    asked += "" if h is None else f", Heading = {math.degrees(h):g}°"
    asked += "" if energy is None else f", Energy = {energy:g} J"
    fix = "leave out --no-snap (snap=False) to get the nearest learned cell"
    return f"P({asked}) = 0 under this model: no gait does that; {fix}"
