"""Answers of the inverse model: a posterior over gaits, and everything that says how good it is."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core import displays, units
from bayeshunt.core.bins import ENERGY
from bayeshunt.core.geometry import Polar, wrap
from bayeshunt.models.body.explain import explain
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.certainty.interval import interval
from bayeshunt.models.certainty.sensitivity import sensitivity

__all__ = ["Cell", "CellPosterior", "Posterior"]


class Cell(NamedTuple):
    """A learned coordinate: the bins used as evidence, their centres and their labels.

    distance [m], angle and heading [rad, clockwise] and energy [J] are bin centres; the fields of heading and energy
    are None where none was asked.
    """

    distance_bin: int
    angle_bin: int
    distance: float
    angle: float
    distance_label: str
    angle_label: str
    heading_bin: int | None = None
    heading: float | None = None
    heading_label: str | None = None
    energy_bin: int | None = None
    energy: float | None = None
    energy_label: str | None = None

    @property
    def evidence(self) -> dict[str, str]:
        """Variable -> state label, as pgmpy takes evidence."""
        known = {"Distance": self.distance_label, "Angle": self.angle_label}
        known |= {} if self.heading_label is None else {"Heading": self.heading_label}
        return known if self.energy_label is None else {**known, ENERGY: self.energy_label}


class CellPosterior:
    """P(Gait | evidence) of one cell, made once and shared by every answer that uses the cell.

    values: read-only float64 [G]; evidence_probability: P(evidence); support: babbled rows in the
    cell, None if unknown; best: the most probable gait (ties: first in table order); model: the
    tables it comes from.
    """

    __slots__ = ("best", "cell", "evidence_probability", "gaits", "model", "support", "values")

    def __init__(
        self, cell: Cell, model: ForwardModel, values: np.ndarray, probability: float, support: int | None
    ) -> None:
        self.model = model
        self.gaits = gaits = model.gaits.names
        self.cell = cell
        self.values = values
        self.evidence_probability = probability
        self.support = support
        self.best = gaits[int(np.argmax(values))]


class Posterior(NamedTuple):
    """One answer: P(Gait | Distance, Angle [, Heading] [, Energy]) and the evidence that it rests on.

    source: the posterior of the cell used. distance [m], angle, heading [rad]: what was asked.
    snapped: the cell used is not the one that the question falls into. energy: joules asked, None: none.
    """

    source: CellPosterior
    distance: float
    angle: float
    heading: float | None
    snapped: bool
    energy: float | None = None

    @property
    def values(self) -> np.ndarray:
        """Read-only float64 [G], in table order."""
        return self.source.values

    @property
    def probabilities(self) -> pd.Series:
        """P(Gait | evidence) by gait name."""
        index = pd.Index(self.source.gaits, name="Gait")
        return pd.Series(self.source.values.copy(), index=index, name="probability")

    @property
    def evidence_probability(self) -> float:
        """P(Distance, Angle [, Heading]) under the model; the posterior rests on little where it is tiny.

        Of a model that is given the gait before (:attr:`evidence` then names it): the probability after that gait.
        """
        return self.source.evidence_probability

    @property
    def support(self) -> int | None:
        """Babbled rows that fell into the cell used; None where nobody knows: in an imported network."""
        return self.source.support

    @property
    def cell(self) -> Cell:
        """The learned coordinate used."""
        return self.source.cell

    @property
    def evidence(self) -> dict[str, str]:
        """Variable -> state label, as pgmpy takes evidence; with the gait before, where the model is given it."""
        return {**self.source.cell.evidence, **self.source.model.known}

    @property
    def target(self) -> Polar[Any]:
        """What was asked; the heading is None if none was given."""
        heading: Any = self.heading
        return Polar(self.distance, self.angle, heading)

    @property
    def gap(self) -> float:
        """Metres from the target to the centre of the learned coordinate used; within half a bin unless snapped."""
        used = Polar(self.cell.distance, self.cell.angle, 0.0)
        return math.hypot(self.target.forward - used.forward, self.target.right - used.right)

    @property
    def heading_gap(self) -> float | None:
        """Radians, >= 0, from the heading asked to the one used; None if none was asked."""
        if self.heading is None or self.cell.heading is None:
            return None
        return abs(float(wrap(self.heading - self.cell.heading)))

    @property
    def farthest(self) -> float:
        """Metres: the far edge of the farthest learned coordinate; nothing beyond it was ever reached."""
        return float(self.model.axes.distance.edges[self.model.learned_cells[:, 0].max() + 1])

    @property
    def beyond(self) -> bool:
        """Whether the target lies farther away than everything ever reached (:attr:`farthest`)."""
        return self.distance >= self.farthest

    @property
    def asked(self) -> str:
        """The target in words: "160 mm, 28.6°"; its heading too, where one was asked."""
        heading = "" if self.heading is None else f", heading {units.degrees(self.heading, 1)}"
        energy = "" if self.energy is None else f", {self.energy:.3g} J"
        return f"{units.length(self.distance)}, {units.degrees(self.angle, 1)}{heading}{energy}"

    @property
    def missed_by(self) -> str:
        """How far the coordinate used is from the target: "15.8 m away, heading 112° off"; "" unless snapped."""
        place, heading = self._misses()
        away = [f"{units.length(place)} away"] if place is not None else []
        turned = [f"heading {units.degrees(heading, 1)} off"] if heading is not None else []
        return ", ".join([*away, *turned, *self._joules_off()])

    def _joules_off(self) -> list[str]:
        """By how much the energy used misses the one asked, where that is in another bin: ["1.2 J off"] or []."""
        if self.energy is None or self.cell.energy is None or not self.snapped:
            return []
        moved = self.model.axes[ENERGY].index(float(self.energy)) != self.cell.energy_bin
        return [f"{abs(self.energy - self.cell.energy):.2g} J off"] if moved else []

    def _misses(self) -> tuple[float | None, float | None]:
        """Metres and radians by which place and heading were missed; None for one that is in its own bin."""
        if not self.snapped:
            return None, None
        axes, cell = self.model.axes, self.cell
        moved = (axes.distance.index(self.distance), axes.angle.index(self.angle)) != cell[:2]
        turned = self.heading is not None and axes.heading.index(self.heading) != cell.heading_bin
        return (self.gap if moved else None), (self.heading_gap if turned else None)

    @property
    def best(self) -> str:
        """Name of the most probable gait; ties go to the first in table order."""
        return self.source.best

    @property
    def model(self) -> ForwardModel:
        """The forward model whose tables were read backwards."""
        return self.source.model

    def explain(self, reference: str = "rival") -> pd.DataFrame:
        """Return what each variable said: the log-odds of each gait as a sum, one row per gait.

        reference: the gait that each is compared with: "rival" (the most probable of the others) or
            the name of a gait of probability > 0.

        Columns: probability; reference; prior, Distance, Angle, Heading, and Energy if it is a node: the parts,
        natural logarithms of ratios (positive speaks for the gait, 0 where no heading was asked, -inf where
        the gait was never seen there); log_odds: log P(gait | evidence) / P(reference | evidence),
        the sum of the parts.

        Raises InputError for an unknown reference, one of probability 0, or a single gait.
        """
        cell = self.cell
        bins = (cell.distance_bin, cell.angle_bin, cell.heading_bin)
        return explain(self.model, bins, self.values, reference, cell.energy_bin)

    def interval(self, level: float = 0.95, pseudo: float | None = None) -> pd.DataFrame:
        """Return how sure each probability is: low, median, high, a row per gait in table order.

        The Dirichlet uncertainty of every table cell that the answer is made of, carried to P(Gait | evidence) by
        draws that are the same every time; ``models.certainty.interval``. The printed probability lies inside.

        level: probability inside, in (0, 1). pseudo: Dirichlet pseudo-count per cell, > 0; None: the model's prior
            (with back-off: the rows of the tables leant on), and where that is 0, 1/K a cell of a table of K bins.
            ``attrs["pseudo"]`` says which.

        Raises InputError for an imported network, whose counts nobody knows, and for numbers out of range.
        """
        return interval(self.model.source, self._bins, self.values, level, pseudo)

    def sensitivity(self, level: float = 0.95) -> pd.DataFrame:
        """Return which table cells the answer hangs on: a row per cell, largest effect first.

        Each cell is moved to the ends of its own credible interval (that of ``model.table``), the others held.
        Columns: variable, state, gait (missing where the table has none), given (the parents' states): the cell;
        count: its rows; probability, low, high: the cell and its interval; best_at_low, best_at_high: P(best gait)
        with the cell there; effect: their difference.

        Raises InputError for an imported network, whose counts nobody knows, and for a level outside (0, 1).
        """
        return sensitivity(self.model.source, self._bins, int(np.argmax(self.values)), level)

    @property
    def _bins(self) -> dict[str, int]:
        """Bin number of each effect observed."""
        cell = self.cell
        bins = {"Distance": cell.distance_bin, "Angle": cell.angle_bin}
        bins |= {} if cell.heading_bin is None else {"Heading": cell.heading_bin}
        return bins if cell.energy_bin is None else {**bins, ENERGY: cell.energy_bin}

    def __repr__(self) -> str:
        evidence = ", ".join(f"{name} {units.label(label)}" for name, label in self.evidence.items())
        best = f"{self.best} {float(self.values.max()):.3f}"
        if self.support is None:
            return f"<Posterior: {best} given {evidence}{self._snap()}; support unknown>"
        at, found = int(np.argmax(self.values)), self.interval()
        low, high = (float(found[end].to_numpy()[at]) for end in ("low", "high"))
        rows = "1 row" if self.support == 1 else f"{self.support} rows"
        return f"<Posterior: {best} ({units.bounds(low, high)}) given {evidence}{self._snap()}; {rows}>"

    def _snap(self) -> str:
        """What was asked and how far off the answer is, as short as can be; "" unless snapped."""
        if not self.snapped:
            return ""
        angles = [units.degrees(value) for value in (self.angle, self.heading) if value is not None]
        place, heading = self._misses()
        missed = [units.length(place)] if place is not None else []
        missed += [f"{'' if missed else 'heading '}{units.degrees(heading)}"] if heading is not None else []
        asked = [units.length(self.distance), *angles, *([] if self.energy is None else [f"{self.energy:.3g} J"])]
        off = [f"{', '.join(missed)} off"] if missed else []
        return f", for {', '.join(asked)} ({', '.join([*off, *self._joules_off()])})"

    def __str__(self) -> str:
        return displays.to_text(self)

    def _repr_html_(self) -> str | None:
        return displays.to_html(self)
