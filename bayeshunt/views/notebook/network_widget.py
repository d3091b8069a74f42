"""The network as a notebook widget; importing it needs anywidget."""

from __future__ import annotations

from typing import Any

import anywidget
import traitlets

from bayeshunt.models.inference.network import Network
from bayeshunt.views import theme
from bayeshunt.views.pages.network import SCRIPTS, network_data
from bayeshunt.views.pages.page import asset

__all__ = ["NetworkWidget"]


class NetworkWidget(anywidget.AnyWidget):
    """A network whose nodes are asked and observed in the picture.

    evidence: node -> the state it is known to be in. likelihood: node -> a number >= 0 for each of its states.
    asked: the node whose Markov blanket and separated nodes are marked. Setting them changes the picture.
    Raises ImpossibleEvidenceError or InputError for what the network cannot take.
    """

    _esm = "".join(asset(name) for name in (*SCRIPTS, "network_widget.js"))
    _css = theme.palette(".bh-network") + asset("network.css")

    evidence = traitlets.Dict().tag(sync=True)
    likelihood = traitlets.Dict().tag(sync=True)
    asked = traitlets.Unicode().tag(sync=True)
    _data = traitlets.Dict().tag(sync=True)

    def __init__(self, network: Network) -> None:
        data = network_data(network)
        self.network = network
        super().__init__(_data=data, asked=data["asked"])

    @traitlets.validate("evidence", "likelihood", "asked")
    def _taken(self, proposal: Any) -> Any:
        value, name = proposal["value"], proposal["trait"].name
        if name == "asked":
            self.network.markov_blanket(value)
            return value
        return self.network.named(**{name: value})[name]
