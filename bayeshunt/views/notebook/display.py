"""What a model, an answer, a table, a plan and a hunt look like in a notebook and in a terminal."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

from bayeshunt.episodes.episode import Episode
from bayeshunt.models.assessment.assess import Assessment
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Plan
from bayeshunt.views.notebook import assessment, models, plans, settings, tables
from bayeshunt.views.terminal import assessment as assessment_texts
from bayeshunt.views.terminal import texts


def to_html(thing: Any) -> str:
    """Return ``thing`` as one piece of HTML with its style sheet: offline, without scripts, all text escaped."""
    return str(_to_html(thing))  # a plain str: marimo shows nothing for a subclass


@singledispatch
def _to_html(thing: Any) -> str:
    raise TypeError(f"nothing here draws a {type(thing).__name__}")


@singledispatch
def to_text(thing: Any) -> str:
    """Return ``thing`` as plain text of several lines, at most 100 columns where names allow it."""
    raise TypeError(f"nothing here prints a {type(thing).__name__}")


#: Class, its HTML, its text.
_DRAWN: tuple[tuple[type, Callable[..., str], Callable[..., str]], ...] = (
    (ForwardModel, models.forward_model, texts.forward_model),
    (InverseModel, models.inverse_model, texts.inverse_model),
    (Posterior, models.posterior, texts.posterior),
    (ProbabilityTable, tables.probability_table, texts.probability_table),
    (PreyModel, tables.prey_model, texts.prey_model),
    (Plan, plans.plan, texts.plan),
    (Episode, plans.episode, texts.episode),
    (Assessment, assessment.assessment, assessment_texts.assessment_text),
    *(
        (kind, lambda thing, draw=draw: draw(thing).html(), lambda thing, draw=draw: draw(thing).text())
        for kind, draw in settings.SHEETS.items()
    ),
)
for _kind, _html, _text in _DRAWN:
    _to_html.register(_kind, _html)
    to_text.register(_kind, _text)
