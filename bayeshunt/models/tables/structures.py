"""Which variable depends on which: the paper's network and its alternatives.

The paper assumes that Distance, Angle and Heading are independent given the gait (naive Bayes). The
other structures drop that assumption in part or whole. In all of them the gait has no parent, because
the robot chooses it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from itertools import combinations

import pandas as pd

from bayeshunt.core.arguments import check_fields, checked
from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.models.counting.backoff import STRENGTH, BackOff, check_strength
from bayeshunt.models.counting.cells import (
    MAX_TABLE_CELLS,
    CountedCells,
    log_likelihood,
    mutual_information,
    parameters,
)

__all__ = [
    "CAUSES",
    "JOINT",
    "NAIVE",
    "PREVIOUS",
    "PREVIOUS_GAIT",
    "SEARCHED",
    "STRUCTURES",
    "Edge",
    "Structure",
    "bic",
    "check_hunting",
    "depends_on_previous",
    "find_structure",
    "search_structure",
    "strength_of",
    "tree_augmented",
]

#: The gait executed just before: a second cause, because momentum carries over.
PREVIOUS = "PreviousGait"
#: Variables that the robot chooses: they have no parents.
CAUSES = (PREVIOUS, "Gait")
#: What ``structure=`` and ``--structure`` accept.
STRUCTURES = ("naive", "tan", "joint", "previous_gait", "learned")
#: Those whose edges are found in the rows.
SEARCHED = ("tan", "learned")

Edge = tuple[str, str]
#: A structure of one's own as a command line takes it.
_EXAMPLE = "arc: Gait->Distance, Gait->Angle, Gait->Heading, Angle->Heading"
#: Letters of a name that are as those of a structure's, at least: it is one misspelt.
_MISSPELT = 0.8


@dataclass(frozen=True)
class Structure:
    """The edges of a network over Gait, the effects and perhaps the gait before.

    name: one of ``STRUCTURES``, or a name of your own, which model files and tables then show.
    edges: (parent, child); children are effects, and there is no cycle. Energy may be one: it depends on what all
        the others depend on, Gait and perhaps PreviousGait, and nothing depends on it.
    Raises InputError for one of ``STRUCTURES`` misspelt, an edge that is not allowed, or a cycle.
    """

    name: str
    edges: tuple[Edge, ...]

    def __post_init__(self) -> None:
        check_fields(self)
        for edge in self.edges:
            if not (isinstance(edge, (tuple, list)) and len(edge) == 2 and all(isinstance(end, str) for end in edge)):
                raise InputError(f"Structure: edges: expected pairs (parent, child) of names, got {shown(edge)}")
        _check_name(self.name, self.edges)
        for parent, child in self.edges:
            if parent not in (*CAUSES, *EFFECTS) or child not in (*EFFECTS, ENERGY):
                raise InputError(f"structure {self.name}: the edge {parent} -> {child} is not allowed")
        # Sorted and unique, so that equal networks are equal values and equal bytes in a model file.
        object.__setattr__(self, "edges", tuple(sorted({(a, b) for a, b in self.edges}, key=_position)))
        try:
            tuple(TopologicalSorter({effect: self.parents(effect) for effect in EFFECTS}).static_order())
        except CycleError:
            raise InputError(f"structure {self.name}: the edges run in a circle") from None
        if self.has_energy and self.parents(ENERGY) != self.with_energy().parents(ENERGY):
            causes = " and ".join(self.poses.causes)
            raise InputError(f"structure {self.name}: Energy depends on {causes} here, and on nothing else")

    @checked
    def parents(self, variable: str) -> tuple[str, ...]:
        """Return the parents of a variable in alphabetical order, the order of pgmpy's tables."""
        return tuple(sorted(parent for parent, child in self.edges if child == variable))

    @classmethod
    def read(cls, text: str) -> Structure:
        """Return the structure that ``"arc: Gait->Distance, Gait->Angle, Gait->Heading, Angle->Heading"`` describes.

        Raises InputError for other texts, and as the class does.
        """
        name, colon, listed = text.partition(":")
        ends = [[end.strip() for end in edge.split("->")] for edge in listed.split(",") if edge.strip()]
        if not (colon and ends and all(len(edge) == 2 for edge in ends)):
            raise InputError(f"structure {text!r}: expected a name and edges, {_EXAMPLE!r}")
        return cls(name.strip(), tuple((parent, child) for parent, child in ends))

    @property
    def has_energy(self) -> bool:
        """Whether Energy is a node."""
        return bool(self.parents(ENERGY))

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects: the three and, where it is a node, Energy."""
        return (*EFFECTS, ENERGY) if self.has_energy else EFFECTS

    @property
    def poses(self) -> Structure:
        """The same edges without Energy's."""
        edges = tuple(edge for edge in self.edges if edge[1] != ENERGY)
        return self if edges == self.edges else Structure(self.name, edges)

    def with_energy(self) -> Structure:
        """Return the same edges with Energy as a node: it depends on the gait, and on the gait before if others do."""
        edges = self.poses.edges
        causes = [cause for cause in CAUSES if cause == "Gait" or any(parent == cause for parent, _ in edges)]
        made = object.__new__(Structure)  # its edges are right: the check of a new one would ask for them again
        object.__setattr__(made, "name", self.name)
        object.__setattr__(made, "edges", tuple(sorted((*edges, *((c, ENERGY) for c in causes)), key=_position)))
        return made

    @cached_property
    def is_naive(self) -> bool:
        """True for the paper's network: every effect depends on the gait alone."""
        return all(self.parents(effect) == ("Gait",) for effect in EFFECTS)

    @property
    def causes(self) -> tuple[str, ...]:
        """The variables that must be known before the effects: Gait, and PreviousGait if it has an edge."""
        return CAUSES if any(parent == PREVIOUS for parent, _ in self.edges) else ("Gait",)

    def describe(self) -> str:
        """Return the factors on one line: "P(Distance | Gait) P(Angle | Distance, Gait) ..."."""
        factors = [(effect, ", ".join(self.parents(effect))) for effect in self.effects]
        return " ".join(f"P({effect} | {given})" if given else f"P({effect})" for effect, given in factors)


def _check_name(name: str, edges: tuple[Edge, ...]) -> None:
    """Raise InputError for a name that is empty, one of ``STRUCTURES`` misspelt, or neither shipped nor with edges."""
    if name in STRUCTURES:
        return
    if not name.strip() or name != name.strip() or not name.isprintable():
        raise InputError(
            f"Structure: name: expected a word of your own, or one of {', '.join(STRUCTURES)}, got {name!r}"
        )
    if not edges or get_close_matches(name, STRUCTURES, n=1, cutoff=_MISSPELT):
        raise InputError(f"unknown structure {name!r}{did_you_mean(name, STRUCTURES)}")


def _position(edge: Edge) -> tuple[int, int]:
    order = (*CAUSES, *EFFECTS, ENERGY)
    return order.index(edge[1]), order.index(edge[0])


_FROM_GAIT: tuple[Edge, ...] = tuple(("Gait", effect) for effect in EFFECTS)
_PAIRS: tuple[Edge, ...] = tuple(combinations(EFFECTS, 2))

#: The paper's network.
NAIVE = Structure("naive", _FROM_GAIT)
#: No assumption about the effects of one gait.
JOINT = Structure("joint", (*_FROM_GAIT, *_PAIRS))
#: The paper's network with the gait before as a second cause of every effect.
PREVIOUS_GAIT = Structure("previous_gait", (*_FROM_GAIT, *((PREVIOUS, effect) for effect in EFFECTS)))


def find_structure(name: str, table: CountedCells) -> Structure:
    """Return the structure called ``name``; "tan" and "learned" are found in the counts of ``table``.

    Raises InputError for an unknown name.
    """
    if name == "tan":
        return tree_augmented(table)
    if name == "learned":
        return search_structure(table)
    for structure in (NAIVE, JOINT, PREVIOUS_GAIT):
        if structure.name == name:
            return structure
    raise InputError(f"unknown structure {name!r}{did_you_mean(name, STRUCTURES)}")


def depends_on_previous(structure: str | Structure) -> bool:
    """Return whether a structure, or one of ``STRUCTURES`` by name, has the gait before as a cause."""
    return structure == PREVIOUS_GAIT.name if isinstance(structure, str) else PREVIOUS in structure.causes


def strength_of(backoff: BackOff, structure: str | Structure) -> float | None:
    """Return the rows of back-off that tables of a structure have; None: none. InputError for another word."""
    if isinstance(backoff, str):
        return check_strength(backoff) if backoff != "auto" else STRENGTH if depends_on_previous(structure) else None
    return backoff


def check_hunting(structure: str | Structure) -> None:
    """Raise InputError unless a forward model can hold the structure.

    With the gait before as a cause that is ``PREVIOUS_GAIT`` alone.
    """
    if isinstance(structure, Structure) and depends_on_previous(structure) and structure.poses != PREVIOUS_GAIT:
        raise InputError(
            f"structure {structure.name!r}: with {PREVIOUS} among the causes a forward model can be 'previous_gait' "
            "alone; choose that, or edges without it"
        )


def tree_augmented(table: CountedCells) -> Structure:
    """Return tree-augmented naive Bayes: besides the gait, the strongest tree of effects, rooted at Distance.

    The strength of a link is I(X; Y | Gait). A tree of three effects leaves out one of the three
    links, the weakest (of equals the last). Source: Friedman, Geiger and Goldszmidt, "Bayesian
    network classifiers", Machine Learning 29 (1997), section 4.
    """
    strengths = {pair: mutual_information(table.tabulate((*pair, "Gait"))) for pair in _PAIRS}
    weakest = min(reversed(_PAIRS), key=lambda pair: strengths[pair])
    trees: dict[Edge, tuple[Edge, ...]] = {
        ("Distance", "Angle"): (("Distance", "Heading"), ("Heading", "Angle")),
        ("Distance", "Heading"): (("Distance", "Angle"), ("Angle", "Heading")),
        ("Angle", "Heading"): (("Distance", "Angle"), ("Distance", "Heading")),
    }
    return Structure("tan", (*_FROM_GAIT, *trees[weakest]))


def search_structure(table: CountedCells) -> Structure:
    """Return what pgmpy's hill climbing finds: single edges added, removed or turned while BIC grows.

    The candidates for parents are all variables of ``table``; Gait and PreviousGait may have none.
    """
    if len(table.counts) < 2:  # all rows alike: nothing depends on anything, and pgmpy refuses a single sample
        return Structure("learned", ())
    from pgmpy.causal_discovery import ExpertKnowledge, HillClimbSearch

    # Variables go by number: pgmpy walks through sets, and the order of strings in a set is random.
    numbers = list(range(len(table.names)))
    causes = [n for n in numbers if table.names[n] in CAUSES]
    cells = pd.DataFrame(table.cells, columns=numbers).astype("category")
    search = HillClimbSearch(
        scoring_method=_counted_bic(table, cells),
        expert_knowledge=ExpertKnowledge(forbidden_edges=[(a, b) for b in causes for a in numbers if a != b]),
        return_type="dag",
        show_progress=False,
    )
    found = search.fit(cells).causal_graph_
    return Structure("learned", tuple((table.names[a], table.names[b]) for a, b in found.edges()))


def bic(table: CountedCells, variable: str, parents: tuple[str, ...]) -> float:
    """Return the BIC [nat] of one variable's table: log-likelihood - parameters / 2 log N; more is better."""
    counts = table.tabulate((variable, *parents))
    return log_likelihood(counts) - 0.5 * math.log(table.total) * parameters(counts)


def _counted_bic(table: CountedCells, cells: pd.DataFrame) -> object:
    """pgmpy's score interface over counted cells: one row per cell instead of one per babbled step."""
    from pgmpy.structure_score import BaseStructureScore

    class CountedBIC(BaseStructureScore):  # type: ignore[misc]
        """BIC from counts."""

        def __init__(self) -> None:
            super().__init__(cells)

        def _local_score(self, variable: int, parents: tuple[int, ...]) -> float:
            if math.prod(table.sizes[v] for v in (variable, *parents)) > MAX_TABLE_CELLS:
                return -math.inf  # a table that nobody could hold is never chosen
            return bic(table, table.names[variable], tuple(table.names[p] for p in parents))

    return CountedBIC()
