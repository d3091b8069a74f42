"""One search for every planner: a frontier, an order, a budget.

The search knows nothing of robots. A *space* hands it a root, and for a node its children with
their values; smaller values are better. Best-first and breadth-first differ only in the frontier's key.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from bayeshunt.core.errors import InputError

__all__ = ["ORDERS", "Search", "SearchTree", "Space"]

#: A frontier's orders.
ORDERS = ("best-first", "breadth-first")


class Space(Protocol):
    """What a search walks over. A handle is whatever the space uses to name a node."""

    def root(self) -> tuple[Any, float]:
        """Return the root's handle and value."""

    def expand(self, handle: Any) -> tuple[Sequence[Any], list[float]]:
        """Return the handles of a node's children, in tie-breaking order, and their values."""


@dataclass(frozen=True)
class SearchTree:
    """Every node generated, numbered in the order of generation; node 0 is the root.

    handles, parents, values, depths: one entry per node (the root's parent is -1).
    expanded: node numbers in order of expansion.
    best: the node of least value at depth >= 1, the earliest of equals.
    """

    handles: list[Any]
    parents: list[int]
    values: list[float]
    depths: list[int]
    expanded: list[int]
    best: int

    def branch(self, node: int) -> list[int]:
        """Return the node numbers from the root to ``node``."""
        path = [node]
        while (node := self.parents[node]) >= 0:
            path.append(node)
        return path[::-1]


@dataclass(frozen=True)
class Search:
    """A search's rules.

    order: "best-first" expands the node of least value (ties: least depth, then first generated);
        "breadth-first" the shallowest, first generated first.
    depth: nodes at this depth are never expanded, >= 1.
    expansions: most nodes expanded, >= 1; None: no limit.
    stop: no more nodes are expanded once one of value <= stop has been generated.
    """

    order: str
    depth: int
    expansions: int | None
    stop: float

    def __post_init__(self) -> None:
        if self.order not in ORDERS:
            raise InputError(f"unknown search order {self.order!r}: expected one of {', '.join(ORDERS)}")

    def run(self, space: Space) -> SearchTree:
        """Search ``space`` and return every node generated. Raises InputError if the root has no child."""
        handle, value = space.root()
        handles, parents, values, depths = [handle], [-1], [value], [0]
        expanded: list[int] = []
        best, best_value = 0, math.inf
        greedy = self.order == "best-first"
        budget = math.inf if self.expansions is None else self.expansions
        frontier = [(value, 0, 0)]  # (priority, depth, node): a total order, so no tie is left to chance
        while frontier:
            if len(expanded) >= budget:
                break
            _, depth, node = heapq.heappop(frontier)
            expanded.append(node)
            children, costs = space.expand(handles[node])
            if not costs:
                continue
            depth += 1
            first = len(handles)
            handles += children
            values += costs
            parents += [node] * len(costs)
            depths += [depth] * len(costs)
            least = min(costs)
            if least < best_value:
                best, best_value = first + costs.index(least), least
                if least <= self.stop:
                    break
            if depth < self.depth:
                for number, cost in enumerate(costs, first):
                    heapq.heappush(frontier, (cost if greedy else 0.0, depth, number))
        if not best:
            raise InputError("the search found no node with a finite value")
        return SearchTree(handles, parents, values, depths, expanded, best)
