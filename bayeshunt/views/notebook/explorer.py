"""The explorer: drag a target around the robot and watch what its inverse model answers.

A notebook widget (anywidget). The picture lives in the browser, every number comes from
:class:`~bayeshunt.models.body.inverse.InverseModel` in Python.
"""

from __future__ import annotations

from typing import Any

from bayeshunt.core.errors import InputError

try:
    from bayeshunt.views.notebook.explorer_widget import Explorer
except ModuleNotFoundError as error:  # an extra: the rest of the package works without it
    if error.name not in ("anywidget", "ipywidgets", "traitlets"):
        raise

    class Explorer:  # type: ignore[no-redef]
        """Stands in for the widget where its libraries are not installed: it says how to get them."""

        def __init__(self, *_: Any, **__: Any) -> None:
            raise InputError("the explorer needs anywidget: pip install '.[notebook]' in bayeshunt's folder")


__all__ = ["Explorer"]
