"""The whole network as an instrument: ask any node, given evidence or a likelihood on any other.

Letters: K states of a node.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays, statistics
from bayeshunt.core.checks import check_number, check_radians
from bayeshunt.core.errors import ImpossibleEvidenceError, InputError, did_you_mean, shown
from bayeshunt.core.gaits import Gait
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.certainty.factors import pseudo_words, weights
from bayeshunt.models.formats.interchange import is_network, read_tables
from bayeshunt.models.inference.elimination import Factor, ancestors, joint, restrict

__all__ = ["Network"]

#: Most nodes of a network, and of one whose every combination of states is looked at.
_MOST_NODES, _MOST_EXPLAINED = 40, 10
_MOST_CELLS = 1 << 24

#: A value of evidence: the name of a state, or a number in SI units.
Value = Any


class Network(displays.Instrument):
    """A model's Bayesian network, every node of which can be asked and observed.

    model: a forward or inverse model of any structure, learned or imported; or a network over any nodes, at most 40: a
        pgmpy DiscreteBayesianNetwork, or the name of a BIF or XMLBIF file.
    nodes: names, in the order of the tables. states: node -> names of its states, in table order.
    parents: node -> its parents. tables: node -> P(node | parents) [K, ...parents].
    weights: node -> the Dirichlet parameters of its table, rows and pseudo-counts [K, ...parents]; of counted tables
        only, and not of one that was set, as a uniform P(Gait) is. pseudo: those pseudo-counts in words, "" without.

    Evidence is a state's name as in ``states`` or, for Distance [m], Angle and Heading [rad clockwise]
    and Energy [J], a number.
    A likelihood (virtual evidence) is a number >= 0 for every state: how probable what was perceived is in that state.

    A notebook shows it as a widget (:attr:`widget`; its ``evidence``, ``likelihood`` and ``asked`` follow the picture),
    :meth:`save` as a page: there a click on a state is evidence.

    Raises InputError for another model.
    """

    def __init__(self, model: Any) -> None:
        model = model.model if isinstance(model, InverseModel) else model
        model = model.binned if isinstance(model, ForwardModel) else model
        self._axes = model.axes if isinstance(model, ForwardModel) else None
        self.weights: dict[str, np.ndarray] = weights(model.source) if isinstance(model, ForwardModel) else {}
        self.pseudo = pseudo_words(model.source, None) if self.weights else ""
        if isinstance(model, ForwardModel):
            tables = model.local_tables
            self.states = {node: tuple(model.states[node]) for node in tables}
            self.parents = {node: model.structure.parents(node) for node in tables}
        elif hasattr(model, "get_cpds"):
            self.states, self.parents, tables = _of_pgmpy(model)
        elif isinstance(model, (str, os.PathLike)) and is_network(model):
            found = read_tables(model)
            self.states, self.parents, tables = dict(found.states), dict(found.parents), dict(found.tables)
        else:
            expected = "a ForwardModel, an InverseModel, a pgmpy network or the name of a BIF or XMLBIF file"
            raise InputError(f"model: expected {expected}, got {shown(model)}")
        self.nodes = tuple(self.states)
        if len(self.nodes) > _MOST_NODES:
            raise InputError(f"the network has {len(self.nodes)} nodes; at most {_MOST_NODES} can be asked")
        self._factors = {n: Factor((n, *self.parents[n]), np.asarray(tables[n], dtype=float)) for n in self.nodes}

    @property
    def tables(self) -> dict[str, np.ndarray]:
        """Node -> P(node | parents) [K, ...parents], the parents in their order."""
        return {node: factor.values for node, factor in self._factors.items()}

    @property
    def edges(self) -> list[tuple[str, str]]:
        """(parent, child) of each edge."""
        return [(parent, child) for child in self.nodes for parent in self.parents[child]]

    def posterior(
        self, node: str, evidence: Mapping[str, Value] | None = None, likelihood: Mapping[str, Any] | None = None
    ) -> pd.Series:
        """Return P(node | evidence, likelihood) by state, in table order.

        Raises InputError for an unknown node, state or likelihood, ImpossibleEvidenceError for evidence of
        probability 0.
        """
        self._check(node)
        known, soft = self._read(evidence, likelihood)
        if node in known:
            self._total(self._joint((), known, soft))
            values = np.eye(len(self.states[node]))[known[node]]
        else:
            values = self._joint((node,), known, soft)
            values = values / self._total(values.sum())
        return pd.Series(values, index=pd.Index(self.states[node], name=node), name="probability")

    def probability(
        self, evidence: Mapping[str, Value] | None = None, likelihood: Mapping[str, Any] | None = None
    ) -> float:
        """Return P(evidence); with a likelihood, its expected value together with the evidence. 0 if impossible."""
        return float(self._joint((), *self._read(evidence, likelihood)))

    def mutual_information(
        self, evidence: Mapping[str, Value] | None = None, likelihood: Mapping[str, Any] | None = None
    ) -> pd.DataFrame:
        """Return what the two ends of each edge say of each other given the evidence: parent, child, bits >= 0."""
        known, soft = self._read(evidence, likelihood)
        rows = [(parent, child, self._shared(parent, child, known, soft)) for parent, child in self.edges]
        return pd.DataFrame(rows, columns=["parent", "child", "bits"])

    def markov_blanket(self, node: str) -> tuple[str, ...]:
        """Return parents, children and the children's other parents: given these, the rest says nothing of the node."""
        self._check(node)
        children = [child for child in self.nodes if node in self.parents[child]]
        near = {*self.parents[node], *children, *(p for child in children for p in self.parents[child])} - {node}
        return tuple(name for name in self.nodes if name in near)

    def separated(self, one: str, other: str, given: Sequence[str] = ()) -> bool:
        """Return whether the edges alone say that two nodes are independent given others (d-separation)."""
        for name in (one, other, *given):
            self._check(name)
        if one in given or other in given:
            return True
        # In the moral graph of the ancestors every path passes through what is given (Koller and Friedman, 4.5.3).
        kept = ancestors(self.parents, [one, other, *given])
        cliques = [{name, *self.parents[name]} for name in kept]
        reached, left = {one}, [one]
        while left:
            here = left.pop()
            for name in set().union(*(clique for clique in cliques if here in clique)) - reached - set(given):
                reached.add(name)
                left.append(name)
        return other not in reached

    def most_probable(
        self, evidence: Mapping[str, Value] | None = None, likelihood: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, str], float]:
        """Return the most probable states of all nodes given the evidence, and their probability P(all | evidence).

        Of equals the first in table order. Raises InputError for more than 10 nodes.
        """
        if len(self.nodes) > _MOST_EXPLAINED:
            raise InputError(f"the most probable explanation is found for up to {_MOST_EXPLAINED} nodes")
        known, soft = self._read(evidence, likelihood)
        free = [name for name in self.nodes if name not in known]
        if math.prod(len(self.states[name]) for name in free) > _MOST_CELLS:
            raise InputError("there are too many combinations of states to look at; give more evidence")
        table = self._joint(free, known, soft)
        total = self._total(table.sum())
        at = np.unravel_index(int(np.argmax(table)), table.shape)
        found = {**known, **{name: int(i) for name, i in zip(free, at, strict=True)}}
        return {name: self.states[name][found[name]] for name in self.nodes}, float(table[at] / total)

    def value_of_information(
        self, node: str, evidence: Mapping[str, Value] | None = None, likelihood: Mapping[str, Any] | None = None
    ) -> pd.Series:
        """Return how many bits of doubt about ``node`` observing each open node would remove, on average; most first.

        Raises InputError for more than 10 nodes.
        """
        self._check(node)
        if len(self.nodes) > _MOST_EXPLAINED:
            raise InputError(f"the value of information is worked out for up to {_MOST_EXPLAINED} nodes")
        known, soft = self._read(evidence, likelihood)
        open_nodes = [name for name in self.nodes if name != node and name not in known]
        bits = [0.0 if node in known else self._shared(node, name, known, soft) for name in open_nodes]
        series = pd.Series(bits, index=pd.Index(open_nodes, name="node"), name="bits", dtype=float)
        return series.sort_values(ascending=False, kind="stable")

    def named(
        self, evidence: Mapping[str, Value] | None = None, likelihood: Mapping[str, Any] | None = None
    ) -> dict[str, dict[str, Any]]:
        """Return evidence by the names of states and likelihoods as lists. Raises InputError as :meth:`posterior`."""
        known, soft = self._read(evidence, likelihood)
        return {
            "evidence": {node: self.states[node][state] for node, state in known.items()},
            "likelihood": {node: values.tolist() for node, values in soft.items()},
        }

    def __repr__(self) -> str:
        return f"<Network: {len(self.nodes)} nodes, {len(self.edges)} edges>"

    # --- inside -------------------------------------------------------------------------------

    def _joint(self, query: Sequence[str], known: Mapping[str, int], soft: Mapping[str, np.ndarray]) -> np.ndarray:
        """P(query, evidence) [K, ...]."""
        needed = ancestors(self.parents, [*query, *known, *soft])
        factors = [restrict(self._factors[name], known) for name in self.nodes if name in needed]
        factors += [restrict(Factor((name,), values), known) for name, values in soft.items()]
        return joint(factors, query) if factors else np.ones(())

    def _shared(self, one: str, other: str, known: Mapping[str, int], soft: Mapping[str, np.ndarray]) -> float:
        """I(one; other | evidence) [bit]."""
        if one in known or other in known:
            return 0.0
        table = self._joint((one, other), known, soft)
        table = table / self._total(table.sum())
        apart = statistics.entropy(table.sum(axis=1)) + statistics.entropy(table.sum(axis=0))
        return max(float(apart - statistics.entropy(table.ravel())), 0.0)

    def _total(self, value: Any) -> float:
        if not (total := float(value)) > 0:
            raise ImpossibleEvidenceError("the evidence has probability 0 under this network; leave some of it out")
        return total

    def _check(self, node: str) -> None:
        if node not in self.states:
            raise InputError(f"unknown node {node!r}{did_you_mean(str(node), self.nodes)}")

    def _read(
        self, evidence: Mapping[str, Value] | None, likelihood: Mapping[str, Any] | None
    ) -> tuple[dict[str, int], dict[str, np.ndarray]]:
        """State numbers and likelihoods [K] by node."""
        for name in (*(evidence or {}), *(likelihood or {})):
            self._check(name)
        known = {name: self._state(name, value) for name, value in (evidence or {}).items()}
        return known, {name: self._likelihood(name, values) for name, values in (likelihood or {}).items()}

    def _state(self, node: str, value: Value) -> int:
        states = self.states[node]
        value = value.name if isinstance(value, Gait) else value
        if isinstance(value, str):
            if value not in states:
                raise InputError(f"{node} has no state {value!r}{did_you_mean(value, states)}")
            return states.index(value)
        if self._axes is None or node not in {axis.name for axis in self._axes.all}:
            raise InputError(f"{node}: expected the name of one of its states, got {shown(value)}")
        number = check_number(value, node, "the name of a state, or a number in metres, radians or joules")
        axis = self._axes[node]
        index = int(axis.index(check_radians(number, node, 2) if axis.circular else number))
        if not 0 <= index < len(states):
            raise InputError(f"{node} = {number:g} lies outside its bins, {states[0]!r} to {states[-1]!r}")
        return index

    def _likelihood(self, node: str, values: Any) -> np.ndarray:
        states = self.states[node]
        if isinstance(values, (Mapping, pd.Series)):
            values = [values.get(state, math.nan) for state in states]
        try:
            numbers = np.asarray(values, dtype=float)
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.shape != (len(states),) or not (np.isfinite(numbers).all() and numbers.min() >= 0):
            raise InputError(f"likelihood of {node}: expected {len(states)} numbers >= 0, one a state")
        return numbers


def _of_pgmpy(model: Any) -> tuple[dict[str, tuple[str, ...]], dict[str, tuple[str, ...]], dict[str, np.ndarray]]:
    """States, parents and tables [K, ...parents] of a pgmpy network."""
    states, parents, tables = {}, {}, {}
    for cpd in model.get_cpds():
        node, *others = map(str, cpd.variables)
        states[node] = tuple(map(str, cpd.state_names[cpd.variables[0]]))
        parents[node], tables[node] = tuple(others), np.asarray(cpd.values)
    return states, parents, tables
