"""What everything that shows itself looks like: one sheet for each, as HTML in a notebook, as text in a terminal."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from bayeshunt.config.schema import ExperimentSettings, RobotSettings
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.tracing import Trace
from bayeshunt.models.assessment.assess import Assessment
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.comparison.compare import Comparison
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Plan, Shown
from bayeshunt.views.sheets import assessment, comparison, models, plans, settings, tables, tracing
from bayeshunt.views.sheets.sheet import Sheet

__all__ = ["sheet", "to_html", "to_text"]


def to_html(thing: Any) -> str:
    """Return ``thing`` as one piece of HTML with its style sheet: offline, without scripts, all text escaped."""
    return sheet(thing).html()


def to_text(thing: Any) -> str:
    """Return ``thing`` as plain text of several lines, at most 100 columns where names allow it."""
    return sheet(thing).text()


@singledispatch
def sheet(thing: Any) -> Sheet:
    """Return the sheet of anything that shows itself; TypeError for anything else."""
    raise TypeError(f"nothing here draws or prints a {type(thing).__name__}")


for _kind, _sheet in (
    (ForwardModel, models.forward_model),
    (InverseModel, models.inverse_model),
    (Posterior, models.posterior),
    (ProbabilityTable, tables.probability_table),
    (PreyModel, tables.prey_model),
    (Plan, plans.plan),
    (Episode, plans.episode),
    (Comparison, comparison.comparison),
    (Trace, tracing.trace),
    (Assessment, assessment.assessment),
    (RobotSettings, settings.robot),
    (GaitRepertoire, settings.gaits),
    (ExperimentSettings, settings.experiment),
    (Shown, settings.planner),
):
    sheet.register(_kind, _sheet)
