"""A forward model made of probability tables from elsewhere: another program's network, or a published one.

It answers, samples and hunts like a learned one; but nobody knows the counts behind it, so the support of
its answers is None, it has no intervals and no rows, and it cannot learn further.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NoReturn

import numpy as np

from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, Structure, check_hunting, depends_on_previous


@dataclass(frozen=True, eq=False, repr=False)
class ImportedModel(ForwardModel):
    """A forward model whose tables are given; ``joint`` holds its gaits and bins and counts nothing.

    given: "Gait" [G], and P(effect | parents) [K, ...parents] of each effect, parents in alphabetical
        order; columns sum to 1. With the gait before as a cause "PreviousGait" [G], too.
    conditions: states of other variables that the tables hold for, {"PreviousGait": name} of a part (:meth:`after`).
    """

    given: Mapping[str, np.ndarray] = field(default_factory=dict)
    conditions: Mapping[str, str] = field(default_factory=dict)
    has_counts: ClassVar[bool] = False

    @classmethod
    def of(
        cls,
        gaits: GaitRepertoire,
        axes: EffectAxes,
        structure: Structure,
        given: Mapping[str, np.ndarray],
        conditions: Mapping[str, str] | None = None,
    ) -> ImportedModel:
        """Return the model of these tables; with the gait before as a cause ``structure`` is PREVIOUS_GAIT."""
        tables = {name: np.array(values, dtype=float) for name, values in given.items()}  # the caller's may change
        for values in tables.values():
            values.setflags(write=False)
        return cls(JointCounts.empty(gaits, axes), structure=structure, given=tables, conditions=conditions or {})

    @property
    def known(self) -> Mapping[str, str]:  # type: ignore[override]
        """The states that the tables are conditioned on."""
        return self.conditions

    @property
    def states(self) -> dict[str, list[str]]:
        """Names of the states of each variable of the network, in table order."""
        before = {PREVIOUS: list(self.gaits.names)} if depends_on_previous(self.structure) else {}
        return {**before, **super().states}

    @property
    def local_tables(self) -> dict[str, np.ndarray]:
        """The network's own tables, as given."""
        return {**{cause: self.given[cause] for cause in self.structure.causes}, **super().local_tables}

    def after(self, previous_gait: Gait | str | None) -> ForwardModel:
        """Return what each gait does right after ``previous_gait``; None: the gait before is summed over."""
        if previous_gait is None or not depends_on_previous(self.structure):
            return super().after(previous_gait)
        index = self.gaits.index(previous_gait)
        given = {"Gait": self.given["Gait"], **{effect: self.given[effect][:, :, index].copy() for effect in EFFECTS}}
        return ImportedModel.of(self.gaits, self.axes, NAIVE, given, {PREVIOUS: self.gaits.names[index]})

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: bins of Distance and Angle of positive probability, sorted."""
        distance, angle, _ = self.axes.shape
        joint = self.evidence(*np.ogrid[:distance, :angle])
        return np.argwhere(joint.sum(axis=-1) > 0)

    def predict(self, gait: Gait | str) -> Polar:
        """Return the expected pose after one step of ``gait``: the mean over bin centres."""
        index = self.gaits.index(gait)
        bins = [np.arange(size) for size in self.axes.shape]
        places = self._effects.evidence(np.ones(len(self.gaits)), bins[0][:, None], bins[1][None, :])[..., index]
        reach, angle = self.axes.distance.centres[:, None], self.axes.angle.centres[None, :]
        forward, right = ((places * reach * part).sum() for part in (np.cos(angle), np.sin(angle)))
        headings, centres = self.probabilities("Heading")[:, index], self.axes.heading.centres
        turn = np.arctan2((headings * np.sin(centres)).sum(), (headings * np.cos(centres)).sum())
        return Polar.from_cartesian(float(forward), float(right), float(turn))

    def table(self, variable: str, level: float = 0.95) -> ProbabilityTable:
        """Return a CPT that shows itself, without counts and intervals."""
        return ProbabilityTable(variable, self.cpt(variable), None, None, None, level, None)

    def counts(self, variable: str) -> NoReturn:
        """Raise InputError: nobody knows the counts."""
        raise InputError("an imported network has probabilities but no counts; ask for its cpt")

    def rows(self, variable: str, bin: Any, gait: Any = None) -> NoReturn:
        """Raise DataError: nobody knows the rows."""
        raise DataError("an imported network has no counts, so it has no rows behind them")

    def with_data(self, frame: Any) -> NoReturn:
        """Raise DataError: no rows can be shown to be those that the network was made from."""
        raise DataError("an imported network has no counts to hold rows against; fit a model: ForwardModel.fit")

    def credible_interval(self, variable: str, level: float = 0.95) -> NoReturn:
        """Raise InputError: without counts there is no interval."""
        raise InputError("an imported network has probabilities but no counts, so it has no intervals")

    def update(self, rows: Any) -> NoReturn:
        """Raise InputError: probabilities without counts cannot learn from further rows."""
        raise InputError("an imported network has no counts to add rows to; fit a model: ForwardModel.fit")

    def __repr__(self) -> str:
        bins = ", ".join(f"{axis.name} {axis.bins}" for axis in self.axes)
        return f"<ImportedModel: {len(self.gaits)} gaits, bins {bins}>"

    def __eq__(self, other: object) -> bool:
        """Equal gaits, bins, edges and tables."""
        if not isinstance(other, ImportedModel):
            return NotImplemented
        mine, theirs = ((m.gaits, m.axes, m.structure, dict(m.conditions)) for m in (self, other))
        return mine == theirs and all(np.array_equal(self.given[v], other.given[v]) for v in self.given)

    def __hash__(self) -> int:
        return hash((self.gaits, self.axes, self.structure))

    def __reduce__(self) -> tuple[Any, ...]:
        return ImportedModel.of, (self.gaits, self.axes, self.structure, dict(self.given), dict(self.conditions))

    # --- inside -------------------------------------------------------------------------------

    @cached_property
    def _effects(self) -> IndependentEffects | JointEffects:
        local = {effect: self.given[effect] for effect in EFFECTS}
        if self.structure.is_naive:
            return IndependentEffects.of_tables(local)
        shares = {PREVIOUS: self.given[PREVIOUS]} if depends_on_previous(self.structure) else None
        return JointEffects.of_tables(self.structure, local, (len(self.gaits), *self.axes.shape), shares)

    def _check_structure(self) -> None:
        check_hunting(self.structure)

    @cached_property
    def _tables(self) -> dict[str, np.ndarray]:
        derived = {"Gait": self.given["Gait"], **{effect: self._effects.marginal(effect) for effect in EFFECTS}}
        for table in derived.values():
            table.setflags(write=False)
        return derived
