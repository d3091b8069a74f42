"""What a gait does, P(Distance, Angle, Heading | Gait), under the paper's structure or another.

Two classes with the same methods. :class:`IndependentEffects` is the paper's naive Bayes: three tables,
multiplied. :class:`JointEffects` compiles any other network into one table per gait, from which
marginals, evidence and samples follow by the chain rule
``P(D, A, H | G) = P(D | G) P(A | D, G) P(H | D, A, G)``, whatever its edges are.
Letters: G gaits, D, A, H bins of the effects, S bins of one of them, K cells.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from bayeshunt.core import statistics
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.errors import InputError, ZeroCountError
from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.models.counting.cells import MAX_TABLE_CELLS, CountedCells, conditional
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.tables import sampling
from bayeshunt.models.tables.structures import CAUSES, Structure

__all__ = ["IndependentEffects", "JointEffects", "check_size", "compile_effects", "local_tables", "multiply"]

_LETTERS = dict(zip((*CAUSES, *EFFECTS), "pgdah", strict=True))
#: Samples drawn at a time: each compares its uniform number with a whole column.
_CHUNK = 1 << 15


def local_tables(structure: Structure, table: CountedCells, prior: float) -> dict[str, np.ndarray]:
    """Return P(effect | parents) of every effect, [S, ...parents], parents in alphabetical order.

    Raises InputError, before anything is allocated, for a table of more than 2**24 cells.
    """
    check_size(structure, table)
    return {e: conditional(table.tabulate((e, *structure.parents(e))), prior) for e in EFFECTS}


def check_size(structure: Structure, table: CountedCells) -> None:
    """Raise InputError if a table of the structure would have more than 2**24 cells."""
    for effect in EFFECTS:
        _check_cells(structure, [table.size(v) for v in (effect, *structure.parents(effect))])


def _check_cells(structure: Structure, shape: Sequence[int]) -> None:
    cells = math.prod(shape)
    if cells > MAX_TABLE_CELLS:
        raise InputError(
            f"structure {structure.name!r} needs a table of {cells:,} cells; "
            f"the most is {MAX_TABLE_CELLS:,}: use fewer or wider bins"
        )


def multiply(
    structure: Structure,
    factors: Mapping[str, np.ndarray],
    keep: Sequence[str],
    sizes: Mapping[str, int],
    shares: Mapping[str, np.ndarray] | None = None,
) -> np.ndarray:
    """Return P(kept effects | kept causes) as one array over ``keep``, in that order.

    keep: causes and any effects; effects left out are summed over.
    sizes: number of states of each variable. A cause without an edge changes nothing along its axis.
    shares: P(cause) of each cause of the structure that is not kept: it is summed over.
    """
    operands = [factors[effect] for effect in EFFECTS]
    subscripts = ["".join(_LETTERS[v] for v in (effect, *structure.parents(effect))) for effect in EFFECTS]
    for cause in keep:
        if cause in CAUSES:
            operands.append(np.ones(sizes[cause]))
            subscripts.append(_LETTERS[cause])
    for cause, share in (shares or {}).items():
        operands.append(share)
        subscripts.append(_LETTERS[cause])
    expression = ",".join(subscripts) + "->" + "".join(_LETTERS[v] for v in keep)
    found: np.ndarray = np.einsum(expression, *operands, optimize="greedy")
    return found


def compile_effects(structure: Structure, joint: JointCounts, prior: float) -> IndependentEffects | JointEffects:
    """Return P(Distance, Angle, Heading | Gait) of a network without PreviousGait.

    Raises ZeroCountError where there is neither a count nor a prior, InputError for a huge table.
    """
    return IndependentEffects(joint, prior) if structure.is_naive else JointEffects(structure, joint.table, prior)


class IndependentEffects:
    """The paper's model: Distance, Angle and Heading independent given the gait; read-only."""

    def __init__(self, joint: JointCounts, prior: float) -> None:
        self.local = _read_only({e: statistics.normalise(joint.marginal(e), prior, name=e) for e in EFFECTS})

    @classmethod
    def of_tables(cls, local: dict[str, np.ndarray]) -> IndependentEffects:
        """Return the model of given tables P(effect | Gait) [S, G]."""
        effects = cls.__new__(cls)
        effects.local = local
        return effects

    def marginal(self, effect: str) -> np.ndarray:
        """Return P(effect | Gait), [S, G]."""
        return self.local[effect]

    def evidence(self, weights: np.ndarray, distances: Any, angles: Any, headings: Any = None) -> np.ndarray:
        """Return ``weights`` [G] times P(evidence | Gait), [..., G], for arrays of bin numbers."""
        joint = weights * self.local["Distance"][distances] * self.local["Angle"][angles]
        found: np.ndarray = joint if headings is None else joint * self.local["Heading"][headings]
        return found

    def log_probability(self, cells: np.ndarray) -> np.ndarray:
        """Return log P(Distance, Angle, Heading | Gait) [K] of cells [K, 4]; -inf where it is 0."""
        with np.errstate(divide="ignore"):
            found: np.ndarray = sum(np.log(self.local[e][cells[:, 1 + i], cells[:, 0]]) for i, e in enumerate(EFFECTS))
            return found

    def draw(self, axes: EffectAxes, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return the poses [...] that ``uniforms`` [..., 6] in [0, 1) choose for one gait."""
        return sampling.draw(axes, self._cumulative[gait], uniforms)

    @cached_property
    def _cumulative(self) -> list[tuple[np.ndarray, ...]]:
        """Per gait, the CDF [S] of Distance, of Angle and of Heading."""
        return list(zip(*(sampling.cumulative(self.local[effect]) for effect in EFFECTS), strict=True))


class JointEffects:
    """Any other network, compiled into P(Distance, Angle, Heading | Gait); read-only.

    structure: must not depend on the gait before (else :meth:`of_tables`, which sums over it).
    table: counts over (Gait, Distance, Angle, Heading).
    prior: Dirichlet pseudo-count per cell of the network's own tables, >= 0.

    Raises ZeroCountError if some parents of positive probability were never seen together and the
    prior is 0: no probability can be given for what follows. InputError for more than 2**24 cells.
    """

    def __init__(self, structure: Structure, table: CountedCells, prior: float) -> None:
        _check_cells(structure, table.sizes)
        self._compile(structure, local_tables(structure, table, prior), table.sizes)

    @classmethod
    def of_tables(
        cls,
        structure: Structure,
        local: dict[str, np.ndarray],
        sizes: Sequence[int],
        shares: Mapping[str, np.ndarray] | None = None,
    ) -> JointEffects:
        """Return the model of given tables; ``sizes``: states of Gait, Distance, Angle, Heading.

        shares: P(PreviousGait) under that name, where the structure depends on it; it is summed over.
        """
        _check_cells(structure, sizes)
        effects = cls.__new__(cls)
        effects._compile(structure, local, sizes, shares)
        return effects

    def _compile(
        self,
        structure: Structure,
        local: dict[str, np.ndarray],
        sizes: Sequence[int],
        shares: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        self.local, names = _read_only(local), ("Gait", *EFFECTS)
        self.joint = multiply(structure, local, names, dict(zip(names, sizes, strict=True)), shares)  # [G, D, A, H]
        if np.abs(self.joint.sum(axis=(1, 2, 3)) - 1.0).max() > 1e-9:
            raise ZeroCountError(
                f"structure {structure.name!r}: a combination of parents is possible that was never seen, "
                "and the prior is 0; fit with a prior > 0"
            )
        self.joint.setflags(write=False)

    def marginal(self, effect: str) -> np.ndarray:
        """Return P(effect | Gait), [S, G], the other effects summed over."""
        others = tuple(1 + i for i, name in enumerate(EFFECTS) if name != effect)
        values = self.joint.sum(axis=others).T
        found: np.ndarray = values / values.sum(axis=0)
        return found

    @cached_property
    def distance_angle(self) -> np.ndarray:
        """P(Distance, Angle | Gait), [G, D, A]."""
        found: np.ndarray = self.joint.sum(axis=3)
        return found

    def evidence(self, weights: np.ndarray, distances: Any, angles: Any, headings: Any = None) -> np.ndarray:
        """Return ``weights`` [G] times P(evidence | Gait), [..., G], for arrays of bin numbers."""
        chosen = self.distance_angle if headings is None else self.joint
        cell = (distances, angles) if headings is None else (distances, angles, headings)
        found: np.ndarray = weights * np.moveaxis(chosen[:, *cell], 0, -1)
        return found

    def log_probability(self, cells: np.ndarray) -> np.ndarray:
        """Return log P(Distance, Angle, Heading | Gait) [K] of cells [K, 4]; -inf where it is 0."""
        with np.errstate(divide="ignore"):
            found: np.ndarray = np.log(self.joint[tuple(cells.T)])
            return found

    def draw(self, axes: EffectAxes, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return the poses [...] that ``uniforms`` [..., 6] in [0, 1) choose for one gait.

        Distance by its CDF, then Angle given the distance, then Heading given both, each uniform
        within its bin; a bin of probability 0 is never chosen.
        """
        flat = uniforms.reshape(-1, uniforms.shape[-1])
        parts = [self._bins(gait, flat[start : start + _CHUNK]) for start in range(0, len(flat), _CHUNK)]
        bins = np.concatenate(parts) if parts else np.zeros((0, 3), dtype=np.int64)
        places = [
            (axis.edges[0] + (bins[:, i] + flat[:, 3 + i]) * axis.width).reshape(uniforms.shape[:-1])
            for i, axis in enumerate(axes)
        ]
        return Polar(places[0], np.asarray(wrap(places[1])), np.asarray(wrap(places[2])))

    def _bins(self, gait: int, uniforms: np.ndarray) -> np.ndarray:
        """Bins [N, 3] of Distance, Angle and Heading."""
        to_distance, to_angle, to_heading = self._cumulative
        distance = np.searchsorted(to_distance[gait], uniforms[:, 0], side="right")
        angle = _first_above(to_angle[gait, distance], uniforms[:, 1])
        return np.column_stack([distance, angle, _first_above(to_heading[gait, distance, angle], uniforms[:, 2])])

    @cached_property
    def _cumulative(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """CDFs of Distance [G, D], of Angle [G, D, A] and of Heading [G, D, A, H] given what precedes."""
        distance_angle = self.distance_angle
        return _cdf(distance_angle.sum(axis=2)), _cdf(distance_angle), _cdf(self.joint)


def _read_only(local: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The same tables, read-only."""
    for table in local.values():
        table.setflags(write=False)
    return local


def _cdf(probabilities: np.ndarray) -> np.ndarray:
    """Cumulative share along the last axis; ends at exactly 1, or is 0 throughout where there is no mass."""
    sums = np.cumsum(probabilities, axis=-1)
    totals = sums[..., -1:]
    found: np.ndarray = np.divide(sums, totals, out=np.zeros_like(sums), where=totals > 0)
    return found


def _first_above(columns: np.ndarray, uniforms: np.ndarray) -> np.ndarray:
    """Index [N] of the first entry of each CDF [N, S] that exceeds its uniform number [N]."""
    found: np.ndarray = np.argmax(columns > uniforms[:, None], axis=1)
    return found
