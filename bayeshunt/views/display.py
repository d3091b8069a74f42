"""What a model, an answer, a table, a plan and a hunt look like in a notebook and in a terminal."""

from __future__ import annotations

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
from bayeshunt.views import assess, assess_html, display_models, display_plans, display_tables, display_text


@singledispatch
def to_html(thing: Any) -> str:
    """Return ``thing`` as one piece of HTML with its style sheet: offline, without scripts, all text escaped."""
    raise TypeError(f"nothing here draws a {type(thing).__name__}")


to_html.register(ForwardModel, display_models.forward_model)
to_html.register(InverseModel, display_models.inverse_model)
to_html.register(Posterior, display_models.posterior)
to_html.register(ProbabilityTable, display_tables.probability_table)
to_html.register(PreyModel, display_tables.prey_model)
to_html.register(Plan, display_plans.plan)
to_html.register(Episode, display_plans.episode)
to_html.register(Assessment, assess_html.assessment)


@singledispatch
def to_text(thing: Any) -> str:
    """Return ``thing`` as plain text of several lines, at most 100 columns where names allow it."""
    raise TypeError(f"nothing here prints a {type(thing).__name__}")


to_text.register(ForwardModel, display_text.forward_model)
to_text.register(InverseModel, display_text.inverse_model)
to_text.register(Posterior, display_text.posterior)
to_text.register(ProbabilityTable, display_text.probability_table)
to_text.register(PreyModel, display_text.prey_model)
to_text.register(Plan, display_text.plan)
to_text.register(Episode, display_text.episode)
to_text.register(Assessment, assess.assessment_text)
