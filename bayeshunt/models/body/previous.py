"""The forward model in which momentum carries over: what a gait does depends on the gait before it as well.

The paper's network with a second cause, ``P(PreviousGait) P(Gait) prod_v P(v | Gait, PreviousGait)`` for v
in Distance, Angle, Heading. Its tables are those of one naive Bayes model for each gait before, so that
:meth:`PreviousGaitModel.after` is an ordinary forward model, and everything asked of one can be asked of it.

Before the first decision of a hunt there is no gait before. The data have a single such row a table (the
robot at rest; one a shard of a large table), too few for tables of their own, so that row is not counted,
and PreviousGait is then simply not known: it is summed over,
``P(v.. | Gait) = sum_p P(PreviousGait = p) P(v.. | Gait, p)``, as the network's own inference does. P(PreviousGait) is
set as P(Gait) is: uniform (``gait_prior="uniform"``, the robot chooses), or the share of the rows.
Letters: G gaits, K bins of a variable, P part-way poses of a gait.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from operator import methodcaller
from typing import Any, ClassVar, NoReturn

import numpy as np
import pandas as pd

from bayeshunt.core import statistics
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.rows import CountedRows
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts, previous_codes
from bayeshunt.models.tables.effects import JointEffects, local_tables
from bayeshunt.models.tables.structures import PREVIOUS, PREVIOUS_GAIT, Structure


@dataclass(frozen=True, eq=False, repr=False)
class PreviousGaitModel(ForwardModel):
    """P(Gait), P(PreviousGait) and P(effect | Gait, PreviousGait), and the counts behind them.

    by_previous: the counts of the rows after each gait; ``joint`` holds the same rows together.

    Asked directly, it answers as if the gait before were not known (summed over); :meth:`after` answers
    for one that is. Counts and intervals of its own tables P(effect | Gait) are those of all rows; its
    predicted and mean poses are means of all rows.
    """

    counter: ClassVar[type[JointCounts] | type[PreviousCounts]] = PreviousCounts
    structure: Structure = PREVIOUS_GAIT
    by_previous: PreviousCounts = field(kw_only=True)

    @classmethod
    def _of_counts(
        cls, counts: JointCounts | PreviousCounts, prior: float, gait_prior: str, provenance: Mapping[str, Any]
    ) -> PreviousGaitModel:
        if not isinstance(counts, PreviousCounts):
            raise InputError("structure 'previous_gait' is fitted to PreviousCounts: count the gait before as well")
        return cls(counts.joint, prior, gait_prior, provenance, by_previous=counts)

    def after(self, previous_gait: Gait | str | None) -> ForwardModel:
        """Return what each gait does right after ``previous_gait``; None: this model, which sums over it."""
        return self if previous_gait is None else self._models_after[self.gaits.index(previous_gait)]

    @property
    def local_tables(self) -> dict[str, np.ndarray]:
        """The network's own tables: "PreviousGait" [G], "Gait" [G], P(effect | Gait, PreviousGait) [K, G, G].

        With prior 0 a column of gaits never babbled one after the other is 0 throughout.
        """
        return {PREVIOUS: self._previous, **super().local_tables}

    @property
    def states(self) -> dict[str, list[str]]:
        """Names of the states of each variable: gait names (of PreviousGait, too) and bin labels."""
        return {PREVIOUS: list(self.gaits.names), **super().states}

    def log_likelihood(self, rows: pd.DataFrame | JointCounts | PreviousCounts) -> float:
        """Return sum over rows of log P(Gait) + log P(Distance, Angle, Heading | Gait, PreviousGait), natural log.

        rows: a babbling table with its previous gaits, or its PreviousCounts. As in learning, rows that
        no gait went before are left out. -inf if some row has probability 0.
        Raises InputError for counts that do not know the gait before.
        """
        if isinstance(rows, JointCounts):
            raise InputError("structure 'previous_gait' needs PreviousCounts: these do not know the gait before")
        if not isinstance(rows, PreviousCounts):
            rows = PreviousCounts.of(rows, self.gaits, self.axes)
        seen = zip(self._models_after, rows.after, strict=True)
        return sum(model.log_likelihood(part) for model, part in seen if part.total)

    def __repr__(self) -> str:
        return super().__repr__().replace("ForwardModel", "PreviousGaitModel", 1)

    def __eq__(self, other: object) -> bool:
        """Equal counts after every gait, prior and gait prior."""
        if not isinstance(other, PreviousGaitModel):
            return NotImplemented
        mine, theirs = ((m.prior, m.gait_prior, m.by_previous) for m in (self, other))
        return mine == theirs

    def __hash__(self) -> int:
        return hash((self.by_previous, self.prior, self.gait_prior))

    def __reduce__(self) -> tuple[Any, ...]:
        return PreviousGaitModel._of_counts, (self.by_previous, self.prior, self.gait_prior, self.provenance)

    # --- inside -------------------------------------------------------------------------------

    @cached_property
    def _models_after(self) -> tuple[AfterModel, ...]:
        """The model after each gait, in table order."""
        made = zip(self.by_previous.after, self.gaits.names, strict=True)
        settings = (self.prior, self.gait_prior, self.provenance)
        return tuple(AfterModel(joint, *settings, whole=self, previous_gait=name) for joint, name in made)

    @cached_property
    def _previous(self) -> np.ndarray:
        """P(PreviousGait) [G], set as P(Gait) is."""
        count = len(self.gaits)
        shares = np.full(count, 1.0 / count) if self.gait_prior == "uniform" else self._shares[PREVIOUS]
        shares.setflags(write=False)
        return shares

    @property
    def _shares(self) -> dict[str, np.ndarray]:
        """P(Gait) and P(PreviousGait) [G] as the rows have them."""
        before = self.by_previous.pairs.sum(axis=1)
        return {PREVIOUS: statistics.normalise(before[:, None], self.prior, name=PREVIOUS)[:, 0], **super()._shares}

    @cached_property
    def _effects(self) -> JointEffects:
        local = local_tables(PREVIOUS_GAIT, self.counted_cells, self.prior)
        sizes = (len(self.gaits), *self.axes.shape)
        return JointEffects.of_tables(PREVIOUS_GAIT, local, sizes, {PREVIOUS: self._previous})

    @property
    def counted_cells(self) -> CountedCells:
        """The counts over every variable of the network, PreviousGait first."""
        return self.by_previous.table

    def _counted_with(self, rows: pd.DataFrame) -> dict[str, Any]:
        counted = self.by_previous.merge(PreviousCounts.of(rows, self.gaits, self.axes))
        return {"joint": counted.joint, "by_previous": counted}

    @cached_property
    def _counted_rows(self) -> CountedRows:
        return CountedRows(self, tuple(f[previous_codes(f, self.gaits) >= 0] for f in self.data))

    def _check_every_gait_seen(self) -> None:
        super()._check_every_gait_seen()
        unseen = np.argwhere(self.by_previous.pairs == 0)
        if self.prior == 0 and len(unseen):
            before, gait = (self.gaits.names[i] for i in unseen[0])
            raise DataError(
                f"structure 'previous_gait': gait {gait!r} was never babbled right after {before!r} ({len(unseen)} of "
                f"{len(self.gaits) ** 2} pairs are missing); babble more, or fit with a prior > 0"
            )

    def _check_structure(self) -> None:
        if self.structure != PREVIOUS_GAIT:
            raise InputError(f"structure {self.structure.name!r}: a PreviousGaitModel has 'previous_gait'")


@dataclass(frozen=True, eq=False, repr=False)
class AfterModel(ForwardModel):
    """What each gait does right after one gait: naive Bayes given ``PreviousGait = previous_gait``.

    whole: the model that it is a part of. previous_gait: the gait before.

    Learned coordinates, counts and rows are those of the rows after that gait. Where there are none (the
    model was smoothed by a prior), poses and coordinates are those of all rows; ``counts`` shows the 0.
    """

    whole: PreviousGaitModel = field(kw_only=True)
    previous_gait: str = field(kw_only=True)

    @property
    def known(self) -> Mapping[str, str]:  # type: ignore[override]
        """The state that the tables are conditioned on: {"PreviousGait": name}."""
        return {PREVIOUS: self.previous_gait}

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that rows after the gait fell into, sorted; of all rows if none."""
        return super().learned_cells if self.joint.total else self.whole.learned_cells

    @cached_property
    def mean_paths(self) -> np.ndarray | None:  # type: ignore[override]  # [G, P + 1, 3]
        """Mean path of each gait after that gait; of one that never followed it, after any gait."""
        paths = self.whole.mean_paths
        if paths is None:
            return None
        seen = self.joint.marginal("Gait") > 0
        paths = np.stack([self.joint.mean_poses(g) if seen[g] else paths[g] for g in range(len(seen))])
        paths.setflags(write=False)
        return paths

    def predict(self, gait: Gait | str) -> Polar:
        """Return the expected pose after one step of ``gait``; of one that never followed, after any gait."""
        followed = self.joint.marginal("Gait")[self.gaits.index(gait)] > 0
        return super().predict(gait) if followed else self.whole.predict(gait)

    def after(self, previous_gait: Gait | str | None) -> ForwardModel:
        """Return the model after another gait; None: the whole model."""
        return self.whole.after(previous_gait)

    def update(self, rows: Any) -> NoReturn:
        """Raise InputError: the whole model learns."""
        raise InputError(f"this is the part after {self.previous_gait!r}; update the whole model")

    def save(self, path: Any) -> NoReturn:
        """Raise InputError: a model file holds the whole model."""
        raise InputError(f"this is the part after {self.previous_gait!r}; save the whole model")

    def __repr__(self) -> str:
        return super().__repr__().replace("ForwardModel:", f"ForwardModel after {self.previous_gait!r}:", 1)

    def __eq__(self, other: object) -> bool:
        """Parts of equal models after the same gait."""
        if not isinstance(other, AfterModel):
            return NotImplemented
        return self.previous_gait == other.previous_gait and self.whole == other.whole

    def __hash__(self) -> int:
        return hash((self.whole, self.previous_gait))

    def __reduce__(self) -> tuple[Any, ...]:
        return methodcaller("after", self.previous_gait), (self.whole,)

    # --- inside -------------------------------------------------------------------------------

    @property
    def _shares(self) -> dict[str, np.ndarray]:
        return {"Gait": self.whole._shares["Gait"]}

    @cached_property
    def _tables(self) -> dict[str, np.ndarray]:
        # P(Gait) does not depend on the gait before: the robot chooses.
        return {**super()._tables, "Gait": self.whole.probabilities("Gait")}

    @cached_property
    def _counted_rows(self) -> CountedRows:
        before = self.gaits.index(self.previous_gait)
        chosen = (f[previous_codes(f, self.gaits) == before] for f in self.whole.data)
        return CountedRows(self, tuple(f for f in chosen if len(f)))
