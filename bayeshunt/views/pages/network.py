"""The page of a network: every node with its distribution, asked and observed without a kernel."""

from __future__ import annotations

from itertools import groupby
from typing import Any

import numpy as np

from bayeshunt.core.units import label, true_minus
from bayeshunt.models.inference.network import Network
from bayeshunt.views.pages.page import embed, render

__all__ = ["SCRIPTS", "described", "network_data", "network_html"]

#: The instrument, for a page and for a widget.
SCRIPTS = ("dom.js", "network_engine.js", "network_draws.js", "network_certainty.js", "network.js")


def network_html(network: Network) -> str:
    """Return a self-contained page that works the network out itself."""
    return render(
        "network.html.j2",
        ["page.css", "network.css"],
        [*SCRIPTS, "network_page.js"],
        title="Bayesian network: " + (", ".join(network.nodes) if len(network.nodes) < 6 else described(network)),
        subtitle=f"{described(network)}; click a state and every other node answers",
        data=embed(network_data(network)),
    )


def described(network: Network) -> str:
    """Return how large it is: "4 nodes, 3 edges"."""
    return f"{len(network.nodes)} nodes, {len(network.edges)} edges"


def network_data(network: Network) -> dict[str, Any]:
    """Return nodes with states, parents (numbers) and tables as plain values for JSON, and the node asked at first.

    A table is runs, [value, how often, ...], its own states running fastest: most cells of a column are alike. weights:
    the same of its Dirichlet parameters, absent where nobody counted it. pseudo: which pseudo-counts are in them.
    """
    at = {name: i for i, name in enumerate(network.nodes)}
    nodes = [
        {
            "name": name,
            "states": list(network.states[name]),
            "labels": [true_minus(label(state)) for state in network.states[name]],
            "parents": [at[parent] for parent in network.parents[name]],
            "runs": _runs(table),
            **({"weights": _runs(network.weights[name])} if name in network.weights else {}),
        }
        for name, table in network.tables.items()
    ]
    nearest = max(network.nodes, key=lambda name: len(network.markov_blanket(name)))
    return {"nodes": nodes, "asked": "Gait" if "Gait" in at else nearest, "pseudo": network.pseudo}


def _runs(table: np.ndarray) -> list[float]:
    values = np.moveaxis(table, 0, -1).ravel().tolist()
    return [part for value, run in groupby(values) for part in (value, len(list(run)))]
