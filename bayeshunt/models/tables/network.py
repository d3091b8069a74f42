"""The paper's network in pgmpy: edges Gait->Distance, Gait->Angle, Gait->Heading.

pgmpy takes seconds to import, so it is imported inside the functions that need it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY, EffectAxes
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.tables.structures import NAIVE, Structure

__all__ = ["TOLERANCE", "VARIABLES", "build", "check_equal", "fit_cells", "fit_energy", "state_names", "structure"]

#: The variables of the network, parent first.
VARIABLES = ("Gait", *EFFECTS)
#: pgmpy's tables and ours may differ by this much, no more.
TOLERANCE = 1e-12


def state_names(gaits: GaitRepertoire, axes: EffectAxes) -> dict[str, list[str]]:
    """Return the states of every variable in table order: gait names and bin labels."""
    return {"Gait": list(gaits.names), **{axis.name: list(axis.labels) for axis in axes.all}}


def build(tables: dict[str, np.ndarray], states: dict[str, list[str]], edges: Structure = NAIVE) -> Any:
    """Return the pgmpy network that holds ``tables``: each cause [G], each effect [K, ...parents].

    pgmpy wants every column to sum to 1: a column of zeros (parents never seen together, so that it
    cannot be reached) is handed over as a uniform one, as pgmpy's own estimator does.
    """
    from pgmpy.factors.discrete import TabularCPD

    network = structure(edges)
    for cause in edges.causes:
        names = {cause: states[cause]}
        network.add_cpds(TabularCPD(cause, len(states[cause]), tables[cause][:, None], state_names=names))
    for effect in edges.effects:
        parents = edges.parents(effect)
        names = {v: states[v] for v in (effect, *parents)}
        values = tables[effect].reshape(len(states[effect]), -1)
        filled = np.where(values.any(axis=0), values, 1.0 / len(values))
        cards = [len(states[p]) for p in parents]
        network.add_cpds(TabularCPD(effect, len(values), filled, list(parents), cards, state_names=names))
    network.check_model()
    return network


def structure(edges: Structure = NAIVE) -> Any:
    """Return the network without tables (a pgmpy DiscreteBayesianNetwork)."""
    from pgmpy.models import DiscreteBayesianNetwork

    network = DiscreteBayesianNetwork(list(edges.edges))
    network.add_nodes_from(("Gait", *edges.effects))
    return network


def fit_cells(table: CountedCells, states: dict[str, list[str]], prior: float, edges: Structure) -> Any:
    """Return the network of ``edges`` as pgmpy's own estimators fit it to the counts of ``table``.

    Every cell is one row weighted by its count, which is all that the estimators use of the rows.
    """
    # State names are always given: pgmpy would drop unseen states and count what it saw. While it
    # counts they are plain numbers, which pandas groups twice as fast as labels.
    names = [name for name in table.names if name in (*VARIABLES, *edges.causes)]
    return _fit(structure(edges.poses), names, table, states, prior)


def fit_energy(counts: np.ndarray, causes: tuple[str, ...], states: dict[str, list[str]], prior: float) -> Any:
    """Return the network causes -> Energy as pgmpy fits it to counts [E, ...causes]."""
    from pgmpy.models import DiscreteBayesianNetwork

    names = (ENERGY, *causes)
    cells = np.argwhere(counts)
    table = CountedCells(names, counts.shape, cells, counts[tuple(cells.T)])
    return _fit(DiscreteBayesianNetwork([(cause, ENERGY) for cause in causes]), names, table, states, prior)


def _fit(empty: Any, names: Sequence[str], table: CountedCells, states: dict[str, list[str]], prior: float) -> Any:
    """A network as pgmpy's own estimators fit it to counted cells."""
    from pgmpy.parameter_estimator import DiscreteBayesianEstimator, DiscreteMLE

    numbers = {name: list(range(table.size(name))) for name in names}
    if prior > 0:
        estimator = DiscreteBayesianEstimator(prior_type="dirichlet", pseudo_counts=prior, state_names=numbers)
    else:
        estimator = DiscreteMLE(state_names=numbers)
    rows = pd.DataFrame({name: table.indices([name])[0] for name in names})
    network = empty.fit(rows, estimator=estimator, sample_weight=table.counts)
    for cpd in network.get_cpds():
        cpd.store_state_names(cpd.variables, cpd.cardinality, {name: states[name] for name in cpd.variables})
    return network


def check_equal(network: Any, tables: dict[str, np.ndarray]) -> None:
    """Raise BayesHuntError if pgmpy's tables differ from ``tables`` anywhere by more than 1e-12.

    Columns of zeros in ``tables`` are left out: nothing was counted there, so there is nothing to compare.
    """
    for name, values in tables.items():
        theirs = np.asarray(network.get_cpds(name).get_values())
        ours = values.reshape(theirs.shape)
        known = ours.any(axis=0)
        if np.abs(theirs - ours)[..., known].max(initial=0.0) > TOLERANCE:
            raise BayesHuntError(f"pgmpy and the counts disagree on the table of {name}; this is a bug")
