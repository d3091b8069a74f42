"""The paper's network in pgmpy: edges Gait->Distance, Gait->Angle, Gait->Heading.

pgmpy takes seconds to import, so it is imported inside the functions that need it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.axes import EFFECTS, EffectAxes
from bayeshunt.errors import BayesHuntError
from bayeshunt.gaits import GaitRepertoire
from bayeshunt.models.counts import JointCounts

#: The variables of the network, parent first.
VARIABLES = ("Gait", *EFFECTS)
#: pgmpy's tables and ours may differ by this much, no more.
TOLERANCE = 1e-12


def state_names(gaits: GaitRepertoire, axes: EffectAxes) -> dict[str, list[str]]:
    """Return the states of every variable in table order: gait names and bin labels."""
    return {"Gait": list(gaits.names), **{axis.name: list(axis.labels) for axis in axes}}


def structure() -> Any:
    """Return the network without tables (a pgmpy DiscreteBayesianNetwork)."""
    from pgmpy.models import DiscreteBayesianNetwork

    return DiscreteBayesianNetwork([("Gait", effect) for effect in EFFECTS])


def build(tables: dict[str, np.ndarray], states: dict[str, list[str]]) -> Any:
    """Return the pgmpy network that holds ``tables``: "Gait" [G], each effect [K, G]."""
    from pgmpy.factors.discrete import TabularCPD

    network = structure()
    network.add_cpds(TabularCPD("Gait", len(states["Gait"]), tables["Gait"][:, None], state_names=states))
    for effect in EFFECTS:
        names = {v: states[v] for v in (effect, "Gait")}
        table = TabularCPD(
            effect, len(states[effect]), tables[effect], ["Gait"], [len(states["Gait"])], state_names=names
        )
        network.add_cpds(table)
    network.check_model()
    return network


def fit(joint: JointCounts, prior: float) -> Any:
    """Return the network as pgmpy's own estimators fit it to the counted cells.

    Every cell is one row weighted by its count, which is all that the estimators use of the rows.
    P(Gait) comes out as the frequency of each gait in the rows.
    """
    from pgmpy.parameter_estimator import DiscreteBayesianEstimator, DiscreteMLE

    # State names are always given: pgmpy would drop unseen states and count what it saw.
    states = state_names(joint.gaits, joint.axes)
    if prior > 0:
        estimator = DiscreteBayesianEstimator(prior_type="dirichlet", pseudo_counts=prior, state_names=states)
    else:
        estimator = DiscreteMLE(state_names=states)
    rows = pd.DataFrame(
        {
            name: pd.Categorical.from_codes(joint.cells[:, column], categories=pd.Index(states[name]))
            for column, name in enumerate(VARIABLES)
        }
    )
    return structure().fit(rows, estimator=estimator, sample_weight=joint.counts)


def tables_of(network: Any) -> dict[str, np.ndarray]:
    """Return the CPT values of a pgmpy network: "Gait" [G], each effect [K, G]."""
    values = {name: np.asarray(network.get_cpds(name).get_values()) for name in VARIABLES}
    return {**values, "Gait": values["Gait"][:, 0]}


def check_equal(network: Any, tables: dict[str, np.ndarray]) -> None:
    """Raise BayesHuntError if pgmpy's tables differ from ``tables`` anywhere by more than 1e-12."""
    for name, theirs in tables_of(network).items():
        ours = tables[name]
        if theirs.shape != ours.shape or np.abs(theirs - ours).max() > TOLERANCE:
            raise BayesHuntError(f"pgmpy and the counts disagree on the table of {name}; this is a bug")
