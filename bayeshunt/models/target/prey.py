"""The prey model: how often each pose transition of the prey was seen, learned online.

A transition is the prey's pose after one time-step in its own frame one time-step earlier (the
paper, section "Prey model"). This is the one model of the project that changes in place.
"""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np

from bayeshunt.core import displays, statistics
from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.checks import FULL_TURN, check_generator, check_kind, check_numbers, check_radians, check_whole
from bayeshunt.core.errors import InputError, NothingObservedError, shown
from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.data.transitions import validate_transitions
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS
from bayeshunt.models.target.conditions import Conditions, ahead_of, binned, check_given, default_axes
from bayeshunt.models.target.expected import PART, expected_cells
from bayeshunt.models.target.following import MOST_FOLLOWED, foreseen_path, mean_transition
from bayeshunt.models.target.prey_file import PREY_FILES, StoredPrey
from bayeshunt.models.target.speed_table import BACKOFF, cell_codes

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["BODY_LENGTH", "PREY_FILES", "PreyModel"]

#: Body length [m] of the default distance bins: a Khepera.
BODY_LENGTH = 0.057
_EFFECT_COLUMNS = ("distance", "angle", "heading")
#: Sums are whole numbers of 2**-60, so that the order of observations cannot change a bit.
_UNIT = 1 << 60


class PreyModel(displays.Displayed, StoredPrey):
    """Joint counts of (Distance, Angle, Heading) transitions; mutable: :meth:`observe` adds one.

    axes: bins; the distance grid is open-ended. Default ``EffectAxes.standard(0.057)``.
    conditions: what the prey's next steps depend on besides, see :meth:`fit`; None: nothing, as in the paper.
    """

    def __init__(self, axes: EffectAxes | None = None, *, conditions: Conditions | None = None) -> None:
        if axes is not None:
            check_kind(axes, "axes", EffectAxes, "EffectAxes, for example EffectAxes.standard(body_length)")
        self.axes = axes if axes is not None else EffectAxes.standard(BODY_LENGTH)
        self.conditions = conditions
        self._cells: dict[tuple[int, int, int], int] = {}  # 2**-10
        self._moments = (0, 0, 0, 0)  # forward, right, cos(heading), sin(heading) of cell centres, 2**-60
        self._observations = 0  # 2**-10, with those of _waiting
        self._waiting: list[tuple[float, float, float]] = []  # observed, and counted when somebody asks
        self._followed: tuple[Polar, ...] = ()  # what the present prey did, for a model with conditions
        self._shares = False  # whether a copy of this model has the same conditions, which then must not change

    # --- learning -----------------------------------------------------------------------------

    def observe(self, transition: Polar) -> None:
        """Count one transition, given in the prey's own previous frame. O(1).

        Raises InputError unless distance [m] >= 0 and all three numbers are finite.
        """
        try:
            distance, angle, heading = transition
            distance, angle, heading = float(distance), float(angle), float(heading)
        except (TypeError, ValueError):
            raise InputError(f"prey transition: expected a Polar of three numbers, got {transition!r}") from None
        if not (0.0 <= distance < math.inf and math.isfinite(angle) and math.isfinite(heading)):
            raise InputError(f"prey transition ({distance}, {angle}, {heading}): expected distance >= 0, finite angles")
        if not (-FULL_TURN <= angle <= FULL_TURN and -FULL_TURN <= heading <= FULL_TURN):
            check_radians(angle, "prey transition: angle")
            check_radians(heading, "prey transition: heading")
        if not distance < MAX_DISTANCE_BINS * self.axes.distance.width:
            raise InputError(f"prey transition of {distance} m: the distance grid does not reach that far")
        self._waiting.append((distance, angle, heading))
        self._observations += PART
        if self.conditions is not None:
            self._followed = (*self._followed, Polar(distance, angle, heading))[-MOST_FOLLOWED:]

    def expect(self, transitions: Polar[FloatArray], weights: FloatArray) -> None:
        """Count one transition of which only probabilities are known: expected counts, the cells' shares of one.

        transitions: what it may have been, Polar of arrays [N], in the prey's own previous frame. weights: their
        probabilities [N], >= 0, any positive sum. Shares are rounded to 1/1024, the least ones to nothing; they
        sum to 1, and the order of calls changes no bit. Raises InputError for what is not finite or negative.
        """
        for cell, parts in expected_cells(self.axes, transitions, weights):
            self._add(cell, parts)
        if self.conditions is not None:
            self._followed = (*self._followed, mean_transition(transitions, weights))[-MOST_FOLLOWED:]

    @classmethod
    def fit(
        cls,
        transitions: pd.DataFrame,
        given: str | None = None,
        residual_of: str | None = None,
        *,
        axes: EffectAxes | None = None,
        backoff: float = BACKOFF,
    ) -> PreyModel:
        """Learn from a table of transitions (:func:`bayeshunt.transitions`); equal to :meth:`update` in any split.

        given: "speed": transitions are also counted by class of the prey's own speed the step before, each backed off
            to like speeds; None: not. residual_of: "constant_velocity": what that misses is also counted over whole
            futures, by class of the path seen; None: not.
        axes: bins; by default a twentieth of the table's typical step, and 120 bins of a turn (36 without ``given``).
        backoff: weight [transitions] of like speeds, and of coarser classes of paths.

        Raises DataError if the table is none or lacks what is asked for, InputError for an unknown motion or context.
        """
        check_given(given, residual_of, backoff)
        validate_transitions(transitions, conditioned=given is not None)
        conditions = Conditions.of(transitions, given, residual_of, axes, backoff)
        grid = axes if axes is not None else default_axes(transitions, fine=given is not None)
        return cls(grid, conditions=conditions).update(transitions)

    def update(self, transitions: pd.DataFrame) -> PreyModel:
        """Count a table of transitions too, in place, and return this model: the order and the split change no bit."""
        validate_transitions(transitions, conditioned=self.conditions is not None)
        for cell, count in binned(transitions, self.axes):
            self._add(cell, count * PART)
        if self.conditions is not None:
            self._own_conditions().update(transitions)
        return self

    def futures(
        self, seen: FloatArray, steps: int, n: int, *, rng: np.random.Generator, headings: FloatArray | None = None
    ) -> FloatArray:
        """Return complex [N, n, steps]: places x + i y that may follow the places ``seen``, complex [N, T], one a step.

        headings: of the body at present [N], rad counter-clockwise, where the table was counted with them. Without
        conditions, every step is drawn from all transitions. Raises NothingObservedError before the first.
        """
        check_whole(steps, "steps", 1)
        check_whole(n, "n", 1)
        check_generator(rng)
        if np.ndim(seen) != 2 or np.asarray(seen).dtype.kind not in "cf":
            raise InputError(f"seen: expected places as a complex array [N, T], got {shown(seen)}")
        if headings is not None:
            headings = check_numbers(headings, "headings")
        self._check_seen()
        if self.conditions is not None and not self.conditions.is_empty:
            if np.shape(seen)[1] < 2:
                raise InputError("seen: expected two places or more of each path: this model goes by speed")
            return self.conditions.futures(np.asarray(seen), steps, n, rng=rng, headings=headings)
        drawn = self.sample_paths(steps, n * len(seen), rng=rng)
        ahead = (drawn.forward - 1j * drawn.right)[:, 1:].reshape(len(seen), n, steps)
        return ahead_of(np.asarray(seen), ahead, headings)

    def log_likelihood(self, transitions: pd.DataFrame) -> float:
        """Return the sum over rows of log P(Distance, Angle, Heading | speed class), natural log.

        Cells that were never seen share one transition's worth of probability. Without ``given``, P is that of all.
        Raises NothingObservedError before the first observation.
        """
        validate_transitions(transitions, conditioned=self.conditions is not None)
        self._check_seen()
        seen = np.zeros(len(transitions))
        codes = cell_codes(self.axes, *(transitions[name].to_numpy(dtype=float) for name in _EFFECT_COLUMNS))
        cells, counts = self._table()
        known = cells @ np.array([self.axes.angle.bins * self.axes.heading.bins, self.axes.heading.bins, 1])
        at = np.searchsorted(known, codes).clip(max=len(known) - 1)
        seen = np.where(known[at] == codes, counts[at] / self.observations, 0.0)
        if self.conditions is not None and self.conditions.speed is not None:
            told = np.isfinite(transitions["speed"].to_numpy(dtype=float))
            kinds, cells_of = self.conditions.kinds(transitions), self.conditions.codes(transitions)
            seen[told] = self.conditions.speed.probabilities(kinds[told], cells_of[told])
        far = max(int(cells[:, 0].max()) + 1, self.axes.distance.bins)
        spread = 1.0 / (far * self.axes.angle.bins * self.axes.heading.bins)
        return float(np.log((seen * self.observations + spread) / (self.observations + 1.0)).sum())

    @checked
    def merge(self, other: PreyModel) -> PreyModel:
        """Return a new model that has seen what both have seen; raises InputError if bins or conditions differ."""
        if other.axes != self.axes:
            raise InputError("cannot join prey models with different bins")
        merged = self.copy()
        if merged.conditions is not None or other.conditions is not None:
            if merged.conditions is None or other.conditions is None:
                raise InputError("cannot join a prey model with conditions and one without")
            merged._own_conditions().merge(other.conditions)
        for cell, count in other._counts.items():
            merged._add(cell, count)
        return merged

    def copy(self) -> PreyModel:
        """Return an independent model with the same counts."""
        twin = PreyModel(self.axes)
        twin._cells, twin._moments, twin._observations = dict(self._counts), self._sums, self._observations
        twin.conditions, twin._followed = self.conditions, self._followed
        self._shares = twin._shares = self.conditions is not None
        return twin

    # --- tables -------------------------------------------------------------------------------

    @property
    def observations(self) -> int:
        """Number of transitions seen, expected ones too."""
        return self._observations // PART

    @property
    def is_empty(self) -> bool:
        """True before the first observation: there is nothing to predict from."""
        return not self._observations

    @property
    def counts(self) -> pd.DataFrame:
        """Column "count" by (Distance, Angle, Heading) labels, seen cells only, in table order."""
        import pandas as pd

        cells, counts = self._table()
        return pd.DataFrame({"count": counts}, index=self._index(cells))

    def cpt(self) -> pd.DataFrame:
        """Return columns probability, count, low, high of every cell seen; the table sums to 1.

        low, high: 95 % Jeffreys interval of each cell against all others. Empty before the first
        observation.
        """
        import pandas as pd

        cells, counts = self._table()
        low, high = statistics.credible_interval(counts[:, None]) if len(counts) else (np.zeros((0, 1)),) * 2
        columns = {
            "probability": counts / max(self.observations, 1),
            "count": counts,
            "low": low[:, 0],
            "high": high[:, 0],
        }
        return pd.DataFrame(columns, index=self._index(cells))

    # --- what will happen ---------------------------------------------------------------------

    def predict(self, steps: int) -> Polar:
        """Return the expected pose ``steps`` ahead, in the prey's present frame: Polar of floats.

        The mean transition (mean forward and right displacement and circular mean heading of the
        cells' centres) composed with itself ``steps`` times. A model with conditions that has observed the present
        prey foresees it from what it did: the median of its futures, see ``models.target.following``.

        Raises NothingObservedError before the first observation, InputError unless steps >= 0.
        """
        return Polar(*(float(part[-1]) for part in self.predict_path(steps)))

    def predict_path(self, steps: int) -> Polar[FloatArray]:
        """Return the expected poses 0 to ``steps`` ahead: Polar of arrays [steps + 1]; as :meth:`predict`."""
        if self.conditions is not None and self._followed:
            check_whole(steps, "steps", 0)
            return foreseen_path(self.conditions, self._followed, steps)
        return Polar(*(np.array(part) for part in self._iterate(steps)))

    def sample_paths(self, steps: int, n: int, *, rng: np.random.Generator) -> Polar[FloatArray]:
        """Return ``n`` futures: Polar of arrays [n, steps + 1], in the prey's present frame.

        Every step is drawn from the counts, independently, at its cell's centre; index 0 is the
        present pose. Raises NothingObservedError before the first observation.
        """
        check_whole(steps, "steps", 0)
        check_whole(n, "n", 0)
        check_generator(rng)
        self._check_seen()
        cells, counts = self._table()
        reach = np.cumsum(counts)
        if counts.dtype.kind == "f":  # expected counts: draw among their whole parts
            reach = np.round(reach * PART).astype(np.int64)
        drawn = np.searchsorted(reach, rng.integers(0, reach[-1], size=(n, steps)), side="right")
        turns, strides = self._centres(cells)
        headings = np.zeros((n, steps + 1))
        np.cumsum(turns[drawn], axis=1, out=headings[:, 1:])
        places = np.zeros((n, steps + 1), dtype=complex)
        np.cumsum(strides[drawn] * np.exp(1j * headings[:, :-1]), axis=1, out=places[:, 1:])
        return Polar.from_cartesian(places.real, places.imag, headings)

    def cells(self) -> list[list[float]]:
        """Return [distance m, angle rad, heading rad (cell centres), count] of every cell seen, in table order."""
        axes = self.axes
        return [
            [(d + 0.5) * axes.distance.width, float(axes.angle.centres[a]), float(axes.heading.centres[h]), n / PART]
            for (d, a, h), n in sorted(self._counts.items())
        ]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PreyModel):
            return NotImplemented
        return self.axes == other.axes and self._counts == other._counts and self.conditions == other.conditions

    __hash__ = None  # type: ignore[assignment]  # mutable

    def __repr__(self) -> str:
        return f"<PreyModel: {self.observations} transitions in {len(self._counts)} cells>"

    # --- inside -------------------------------------------------------------------------------

    @property
    def _counts(self) -> dict[tuple[int, int, int], int]:
        """By cell [2**-10], all that was observed."""
        if self._waiting:
            self._count_waiting()
        return self._cells

    @property
    def _sums(self) -> tuple[int, int, int, int]:
        """Of forward, right, cos(heading), sin(heading) of the cells' centres [2**-60]."""
        if self._waiting:
            self._count_waiting()
        return self._moments

    def _count_waiting(self) -> None:
        """Count what was observed since somebody last asked: a hunt that a policy decides asks never."""
        axes, waiting = self.axes, self._waiting
        self._waiting = []
        for distance, angle, heading in waiting:
            self._count((axes.distance.index(distance), axes.angle.index(angle), axes.heading.index(heading)), PART)

    def _add(self, cell: tuple[int, int, int], count: int) -> None:
        """Take over ``count`` parts of 2**-10 of a cell."""
        self._observations += count
        self._count(cell, count)

    def _count(self, cell: tuple[int, int, int], count: int) -> None:
        self._cells[cell] = self._cells.get(cell, 0) + count
        distance = (cell[0] + 0.5) * self.axes.distance.width
        angle = self.axes.angle.centres[cell[1]]
        heading = self.axes.heading.centres[cell[2]]
        parts = (distance * math.cos(angle), distance * math.sin(angle), math.cos(heading), math.sin(heading))
        one, two, three, four = (s + count * round(p * _UNIT) for s, p in zip(self._moments, parts, strict=True))
        self._moments = (one, two, three, four)

    def _own_conditions(self) -> Conditions:
        """The conditions, made this model's own before they change."""
        assert self.conditions is not None
        if self._shares:
            self.conditions, self._shares = self.conditions.copy(), False
        return self.conditions

    def _check_seen(self) -> None:
        if not self._observations:
            raise NothingObservedError("no prey transition has been observed yet, so none can be predicted")

    def _mean(self) -> tuple[complex, float]:
        """Mean displacement [m] (forward + i right) and circular mean heading [rad]."""
        self._check_seen()
        forward, right, cosine, sine = self._sums
        scale = self._observations * _UNIT
        # Opposite headings that cancel exactly leave no mean direction; atan2(0, 0) = 0 keeps straight on.
        return complex(forward / scale, right / scale), math.atan2(sine / scale, cosine / scale)

    def _iterate(self, steps: int) -> tuple[list[float], list[float], list[float]]:
        """Distances, angles and headings 0 to ``steps`` ahead under the mean transition."""
        check_whole(steps, "steps", 0)
        stride, turn = self._mean()
        # With clockwise angles, x = forward and y = right, composing poses is complex multiplication.
        rotation = cmath.exp(1j * turn)
        place, distances, angles, headings = 0j, [0.0], [0.0], [0.0]
        for step in range(1, steps + 1):
            place += stride
            stride *= rotation
            distances.append(abs(place))
            angles.append(wrap(cmath.phase(place)))
            headings.append(wrap(step * turn))
        return distances, angles, headings

    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        """Cells seen, int64 [K, 3], sorted, and their counts [K]: int64, or float64 where some are not whole."""
        cells = sorted(self._counts)
        parts = np.array([self._counts[cell] for cell in cells], dtype=np.int64)
        counts = parts / PART if (parts % PART).any() else parts // PART
        return np.array(cells, dtype=np.int64).reshape(-1, 3), counts

    def _centres(self, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Headings [K] and displacements [K] (forward + i right, metres) of cells' centres."""
        distances = (cells[:, 0] + 0.5) * self.axes.distance.width
        return self.axes.heading.centres[cells[:, 2]], distances * np.exp(1j * self.axes.angle.centres[cells[:, 1]])

    def _index(self, cells: np.ndarray) -> pd.MultiIndex:
        import pandas as pd

        axes = self.axes.extended(int(cells[:, 0].max()) + 1 if len(cells) else 1)
        names = [[axis.labels[i] for i in column] for axis, column in zip(axes, cells.T, strict=True)]
        return pd.MultiIndex.from_arrays(names, names=list(EFFECTS))
