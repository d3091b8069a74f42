"""The interception hunter of a prey that may react to it: by a table of what it does given where the hunter is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.reactions import Reactions
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings
from bayeshunt.planners.interception.lookahead import Outlook, decide, look_ahead
from bayeshunt.planners.interception.pairs import trace
from bayeshunt.planners.interception.reacting import Reacting, look_ahead_of_reactions
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.settings import Number, planner_settings, setting

__all__ = ["EvaderSettings", "InterceptEvaderPlanner"]

#: A hypothesis less probable than this is left out of a decision.
_NEGLIGIBLE = 0.01
#: Slower gaits than this share of the fastest are no way for a prey to get on.
_SLOW = 0.4
#: Equal parts of a full turn that turns are told apart by.
_TURNS = 16


@planner_settings("intercept_evader")
class EvaderSettings(InterceptSettings):
    """Settings of the interception hunter, and what is believed of a prey that reacts before anything is seen."""

    name: ClassVar[str] = "intercept_evader"
    reacts: Number = setting(
        0.2, "probability that the prey minds the hunter, believed beforehand; 0: never, 1: always", ge=0, le=1
    )
    evasion: Number = setting(
        1.0, "how much likelier a motion is that takes the prey a body length farther away, as a logarithm", ge=0
    )
    backoff: Number = setting(1.0, "how many transitions a coarser table of its motions is worth in a finer one", gt=0)
    other: Number = setting(0.25, "probability that a prey that reacts does what its table does not say", gt=0, lt=1)


class InterceptEvaderPlanner(InterceptPlanner):
    """Interception of a prey that may react to the hunter, by a table of its motions given where the hunter is.

    Two hypotheses. The prey goes its own way, as ``intercept`` believes. Or it reacts: what it does next depends on the
    hunter's place in its own frame, a band of distance and a sector of bearing. That is counted within the hunt, each
    place leaning on its sector, the sector on all, and all on a prey that moves as the hunter does and prefers what
    takes it away (:meth:`reactions` opens the table). Against a prey that reacts the hunter foresees what it will do
    in the second step from where the first gait leads.

    ``P(reacts | prey so far)`` follows from how well each hypothesis foretold every motion (:meth:`reacting`); a
    decision weighs both. Without ``situation.approaches`` there is nothing to count, and the prey goes its own way.
    """

    name = "intercept_evader"
    Settings = EvaderSettings
    settings: EvaderSettings

    def __init__(self, model: ForwardModel, settings: EvaderSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        own = np.array([model.predict(gait) for gait in model.gaits], dtype=float)
        own = own[own[:, 0] >= _SLOW * own[:, 0].max()]
        own[:, 0] *= self.step_prior.prior_speed / own[:, 0].max()
        #: What is believed of a prey that reacts, before anything is seen.
        self.believed = Reactions(
            Polar(*own.T), model.gaits.need("body_length"), self.settings.evasion, self.settings.backoff
        )

    def reactions(self, situation: Situation) -> Reactions:
        """Return the table of what the prey has done in this hunt, given where the hunter was."""
        return self.believed.learn(situation.transitions, situation.approaches)

    def reacting(self, situation: Situation) -> float:
        """Return the probability that the prey reacts to the hunter, given what it has done in this hunt."""
        return self._reacts(situation, self.reactions(situation))

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the pair of gaits of the earliest expected capture."""
        situation = check_request(situation, rng, self.hunter)
        table, pairs = self.reactions(situation), self.pairs_from(situation)
        reacts = self._reacts(situation, table)
        homing = replace(self.homing, reach=self.reach(situation))
        futures = self.futures(situation)
        charge = self.charge(situation, pairs)
        ahead = self.ahead(situation, futures, rng)
        own = partial(look_ahead, ahead[0], ahead[1], homing, ahead[2], charge)
        other = partial(look_ahead_of_reactions, pairs, situation.prey, table, homing, self.spread, charge)
        weigh = partial(_weighed, own, ahead[1], other, reacts)
        values, pair_values, against = weigh()
        trace_own = partial(trace, self.gaits, ahead[0], ahead[1], homing, ahead[2], charge)
        first = int(values.argmin())
        prey = self.predicted(futures)
        if against is not None and reacts > 0.5:
            places, headings = (part[first] for part in against.prey)
            prey = Polar.from_cartesian(places.real, places.imag, np.asarray(wrap(headings)))
        return self.best(
            values, pair_values, self.objective,
            partial(_trace, trace_own, weigh, reacts), prey,
            prey_known=bool(situation.transitions),
        )  # fmt: skip

    def _reacts(self, situation: Situation, table: Reactions) -> float:
        """P(the prey reacts), from what both hypotheses foretold."""
        before = self.settings.reacts
        if situation.pose is None or not table.transitions or before in (0.0, 1.0):
            return before if table.transitions or before == 1.0 or not situation.transitions else 0.0
        own = self.own_way(situation) - self._turned(situation).sum() * math.log(_TURNS)
        odds = math.log(before / (1.0 - before)) + self._foretold(situation, table) - own
        return 1.0 / (1.0 + math.exp(-min(max(odds, -50.0), 50.0)))

    def _turned(self, situation: Situation) -> np.ndarray:
        """Which of the prey's legs turned [N]."""
        return np.array([abs(leg.heading) >= self.prior.threshold for leg in self.legs(situation)])

    def _foretold(self, situation: Situation, table: Reactions) -> float:
        """The logarithm of the probability of the prey's turns under the table, as it stood before each."""
        made = self._parts(np.array([t.heading for t in table.transitions]))
        alike = made[:, None] == self._parts(table.motions.heading)
        other = self.settings.other
        told = (1.0 - other) * (table.foretold() * alike).sum(axis=1) + other / _TURNS
        return float(np.log(told).sum())

    def _parts(self, heading: FloatArray) -> np.ndarray:
        """Which part of a full turn a change of heading [rad] falls into; -1 if it is no turn."""
        part = np.floor((wrap(heading) + np.pi) * (_TURNS / (2 * np.pi))).astype(int) % _TURNS
        return np.where(np.abs(heading) < self.step_prior.threshold, -1, part)


def _weighed(
    own: Callable[[], Outlook], futures: Futures, other: Callable[[], Reacting], reacts: float
) -> tuple[FloatArray, FloatArray, Reacting | None]:
    """Return the expected time of every first gait [G] and pair [G, G], and what the prey's reactions bring."""
    values, pair_values, against = np.zeros(1), np.zeros(1), None
    if reacts < 1.0 - _NEGLIGIBLE:
        values, pair_values = decide(own(), futures)
    if reacts > _NEGLIGIBLE:
        against = other()
        share = reacts if values.size > 1 else 1.0
        values, pair_values = (
            (1.0 - share) * one + share * two for one, two in zip((values, pair_values), against.decide(), strict=True)
        )
    return values, pair_values, against


def _trace(
    own_way: Callable[[], pd.DataFrame], weigh: Callable[[], tuple[FloatArray, FloatArray, Reacting | None]],
    reacts: float,
) -> pd.DataFrame:  # fmt: skip
    """Return the rows of :func:`~bayeshunt.planners.interception.pairs.trace`, valued under both hypotheses.

    value_s: both, weighed. own_way_s, reacting_s: under either alone; NaN for one that was left out. reacts: the
    probability of the second. capture_probability and capture_by_N are of a prey that goes its own way.
    """
    rows = own_way()
    values, pair_values, against = weigh()
    best = int(values.argmin())
    rows["own_way_s"] = rows["value_s"] if reacts < 1.0 - _NEGLIGIBLE else np.nan
    rows["value_s"] = np.concatenate([[values[best]], values, pair_values.ravel()])
    other = None if against is None else against.decide()
    rows["reacting_s"] = np.nan if other is None else np.concatenate([[other[0][best]], other[0], other[1].ravel()])
    first, second = np.divmod(np.arange(pair_values.size), len(values))
    chosen = (first == best) & (second == int(pair_values[best].argmin()))
    rows["chosen"] = np.concatenate([[True], np.arange(len(values)) == best, chosen])
    return rows.assign(reacts=reacts)
