"""A table being learned as a notebook widget; importing it needs anywidget."""

from __future__ import annotations

from typing import Any

import anywidget
import traitlets

from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.models.comparison.learning import Learning
from bayeshunt.views import theme
from bayeshunt.views.pages.learning import learning_data
from bayeshunt.views.pages.page import asset

__all__ = ["LearningWidget"]


class LearningWidget(anywidget.AnyWidget):
    """A table being learned, with a slider over its rows.

    n: how many rows are learned from; setting it moves the slider. Raises InputError for a number out of range.
    """

    _esm = asset("dom.js") + asset("learning.js") + asset("learning_widget.js")
    _css = theme.palette(".bh-learning") + asset("learning.css")

    n = traitlets.Int().tag(sync=True)
    _data = traitlets.Dict().tag(sync=True)

    def __init__(self, learning: Learning) -> None:
        data = learning_data(learning)
        self._most = len(data["rows"]) // 4
        super().__init__(_data=data, n=self._most)

    @traitlets.validate("n")
    def _taken(self, proposal: Any) -> int:
        check_whole(proposal["value"], "n", 1)
        if proposal["value"] > self._most:
            raise InputError(f"n is {proposal['value']}, but there are {self._most} rows")
        return int(proposal["value"])
