"""Exact inference in a discrete Bayesian network by variable elimination.

``P(query, e) = sum over the rest of prod_v P(v | parents) L_v(v)``; variables are summed out one by one, the one whose
new table is smallest first. Source: D. Koller and N. Friedman, Probabilistic Graphical Models, 2009, chapter 9.
Letters: K states of a variable.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bayeshunt.core.errors import InputError

__all__ = ["Factor", "ancestors", "joint", "restrict"]

#: Tables larger than this are refused rather than allocated.
_MOST_CELLS = 1 << 24


class Factor(NamedTuple):
    """A table over some variables: one axis each, in their order."""

    variables: tuple[str, ...]
    values: np.ndarray


def ancestors(parents: Mapping[str, Sequence[str]], nodes: Sequence[str]) -> set[str]:
    """Return the nodes and all that they descend from."""
    found: set[str] = set()
    left = list(nodes)
    while left:
        if (node := left.pop()) not in found:
            found.add(node)
            left += parents[node]
    return found


def restrict(factor: Factor, evidence: Mapping[str, int]) -> Factor:
    """Return the factor at the evidence (state numbers), those axes gone."""
    cut = tuple(evidence.get(v, slice(None)) for v in factor.variables)
    return Factor(tuple(v for v in factor.variables if v not in evidence), factor.values[cut])


def joint(factors: Sequence[Factor], query: Sequence[str]) -> np.ndarray:
    """Return the product of the factors over ``query`` [K, ...], in that order, everything else summed out."""
    left = list(factors)
    sizes = {v: n for f in left for v, n in zip(f.variables, f.values.shape, strict=True)}
    hidden = [v for v in sizes if v not in query]
    while hidden:
        scopes = {v: {w for f in left if v in f.variables for w in f.variables} - {v} for v in hidden}
        chosen = min(hidden, key=lambda v: math.prod(sizes[w] for w in scopes[v]))
        hidden.remove(chosen)
        touched = [f for f in left if chosen in f.variables]
        left = [f for f in left if chosen not in f.variables]
        left.append(_product(touched, sorted(scopes[chosen]), sizes))
    return _product(left, list(query), sizes).values


def _product(factors: Sequence[Factor], keep: Sequence[str], sizes: Mapping[str, int]) -> Factor:
    """The product of the factors, summed over what is not kept."""
    if math.prod(sizes[v] for v in keep) > _MOST_CELLS:
        raise InputError(f"inference in this network needs a table of more than {_MOST_CELLS:,} cells")
    numbers = {v: i for i, v in enumerate(dict.fromkeys(v for f in factors for v in f.variables))}
    operands = [part for f in factors for part in (f.values, [numbers[v] for v in f.variables])]
    values = np.einsum(*operands, [numbers[v] for v in keep], optimize="greedy")
    return Factor(tuple(keep), np.asarray(values))
