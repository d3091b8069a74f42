"""The sheet of a whole network: what each node is likely to be, and what its edges say."""

from __future__ import annotations

from bayeshunt.core import statistics
from bayeshunt.core.units import label
from bayeshunt.models.inference.network import Network
from bayeshunt.views.sheets.sheet import Note, Sheet, Table

__all__ = ["network"]


def network(shown: Network) -> Sheet:
    """Return every node with its most probable state and its doubt, and the edges with the bits their ends share."""
    rows = []
    for node in shown.nodes:
        shares = shown.posterior(node)
        best, parents = str(shares.idxmax()), ", ".join(shown.parents[node])
        doubt = f"{float(statistics.entropy(shares.to_numpy())):.2f} bits"
        rows.append([node, parents, len(shares), label(best), f"{shares.max():.3f}", doubt])
    edges = [[r["parent"], r["child"], f"{r['bits']:.3f} bits"] for r in shown.mutual_information().to_dict("records")]
    heads = ["node", "parents", "states", "most probable", "P", "doubt"]
    parts = [
        Table(heads, rows, words=frozenset({0, 1, 3})),
        Table(["from", "to", "in common"], edges, words=frozenset({0, 1})) if edges else None,
        Note("network.widget, or network.save('network.html'): set evidence on any node with a click."),
    ]
    return Sheet("Bayesian network", f"{len(shown.nodes)} nodes, {len(shown.edges)} edges", (), parts)
