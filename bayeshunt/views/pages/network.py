"""The page of a network: every node with its distribution, asked and observed without a kernel."""

from __future__ import annotations

from itertools import groupby
from typing import Any

import numpy as np

from bayeshunt.core.units import label, true_minus
from bayeshunt.models.inference.network import Network
from bayeshunt.views.pages.page import embed, render

__all__ = ["network_data", "network_html"]


def network_html(network: Network) -> str:
    """Return a self-contained page that works the network out itself."""
    return render(
        "network.html.j2",
        ["page.css", "network.css"],
        ["dom.js", "network_engine.js", "network.js", "network_page.js"],
        title="Bayesian network: " + (", ".join(network.nodes) if len(network.nodes) < 6 else described(network)),
        subtitle=f"{described(network)}; click a state and every other node answers",
        data=embed(network_data(network)),
    )


def described(network: Network) -> str:
    """Return how large it is: "4 nodes, 3 edges"."""
    return f"{len(network.nodes)} nodes, {len(network.edges)} edges"


def network_data(network: Network) -> dict[str, Any]:
    """Return nodes with states, parents (numbers) and tables as plain values for JSON, and the node asked at first.

    A table is runs, [value, how often, ...], its own states running fastest: most cells of a column are alike.
    """
    at = {name: i for i, name in enumerate(network.nodes)}
    nodes = [
        {
            "name": name,
            "states": list(network.states[name]),
            "labels": [true_minus(label(state)) for state in network.states[name]],
            "parents": [at[parent] for parent in network.parents[name]],
            "runs": _runs(np.moveaxis(table, 0, -1).ravel()),
        }
        for name, table in network.tables.items()
    ]
    nearest = max(network.nodes, key=lambda name: len(network.markov_blanket(name)))
    return {"nodes": nodes, "asked": "Gait" if "Gait" in at else nearest}


def _runs(values: np.ndarray) -> list[float]:
    return [part for value, run in groupby(values.tolist()) for part in (value, len(list(run)))]
