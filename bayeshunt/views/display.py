"""What a model, an answer, a table, a plan and a hunt look like in a notebook and in a terminal."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

from bayeshunt.episode import Episode
from bayeshunt.models.assess import Assessment
from bayeshunt.models.forward import ForwardModel
from bayeshunt.models.inverse import InverseModel
from bayeshunt.models.posterior import Posterior
from bayeshunt.models.prey import PreyModel
from bayeshunt.models.table import ProbabilityTable
from bayeshunt.planners.base import Plan
from bayeshunt.views import (
    assess,
    assess_html,
    display_models,
    display_plans,
    display_settings,
    display_tables,
    display_text,
)


@singledispatch
def to_html(thing: Any) -> str:
    """Return ``thing`` as one piece of HTML with its style sheet: offline, without scripts, all text escaped."""
    raise TypeError(f"nothing here draws a {type(thing).__name__}")


@singledispatch
def to_text(thing: Any) -> str:
    """Return ``thing`` as plain text of several lines, at most 100 columns where names allow it."""
    raise TypeError(f"nothing here prints a {type(thing).__name__}")


#: Class, its HTML, its text.
_DRAWN: tuple[tuple[type, Callable[..., str], Callable[..., str]], ...] = (
    (ForwardModel, display_models.forward_model, display_text.forward_model),
    (InverseModel, display_models.inverse_model, display_text.inverse_model),
    (Posterior, display_models.posterior, display_text.posterior),
    (ProbabilityTable, display_tables.probability_table, display_text.probability_table),
    (PreyModel, display_tables.prey_model, display_text.prey_model),
    (Plan, display_plans.plan, display_text.plan),
    (Episode, display_plans.episode, display_text.episode),
    (Assessment, assess_html.assessment, assess.assessment_text),
    *(
        (kind, lambda thing, draw=draw: draw(thing).html(), lambda thing, draw=draw: draw(thing).text())
        for kind, draw in display_settings.SHEETS.items()
    ),
)
for _kind, _html, _text in _DRAWN:
    to_html.register(_kind, _html)
    to_text.register(_kind, _text)
