"""What everything that shows itself looks like: one sheet for each, as HTML in a notebook, as text in a terminal."""

from __future__ import annotations

import os
from functools import singledispatch
from importlib.util import find_spec
from typing import Any

from bayeshunt.config.schema import ExperimentSettings, RobotSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.tracing import CellTrace, PlanTrace, Trace
from bayeshunt.files.atomic import write_text
from bayeshunt.files.endings import check_ending
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.assessment.assess import Assessment
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.comparison.compare import Comparison
from bayeshunt.models.comparison.learning import Learning
from bayeshunt.models.inference.network import Network
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.perception.trackers.particle_belief import ParticleBelief
from bayeshunt.planners.api import Plan, Shown
from bayeshunt.views.pages.learning import learning_html
from bayeshunt.views.pages.network import network_html
from bayeshunt.views.pages.sheet import sheet_html
from bayeshunt.views.sheets import (
    assessment,
    belief,
    comparison,
    learning,
    models,
    network,
    plans,
    prey,
    rooms,
    settings,
    tables,
    tracing,
)  # fmt: skip
from bayeshunt.views.sheets.sheet import Sheet

__all__ = ["bundle", "page", "save", "sheet", "to_html", "to_text", "widget"]


def to_html(thing: Any) -> str:
    """Return ``thing`` as one piece of HTML with its style sheet: offline, without scripts, all text escaped."""
    return sheet(thing).html()


def to_text(thing: Any) -> str:
    """Return ``thing`` as plain text of several lines, at most 100 columns where names allow it."""
    return sheet(thing).text()


def widget(thing: Any) -> Any:
    """Return a thing as a widget; InputError if anywidget is not installed, TypeError for one that has none."""
    if not isinstance(thing, (Network, Learning)):
        raise TypeError(f"a {type(thing).__name__} has no widget")
    if find_spec("anywidget") is None:
        raise InputError("a widget needs anywidget: pip install '.[notebook]' in bayeshunt's folder")
    from bayeshunt.views.notebook.learning_widget import LearningWidget
    from bayeshunt.views.notebook.network_widget import NetworkWidget

    return NetworkWidget(thing) if isinstance(thing, Network) else LearningWidget(thing)


def bundle(thing: Any, **options: Any) -> Any:
    """Return the widget of ``thing`` and, for who has no kernel or no anywidget, what it says now."""
    still = {"text/plain": to_text(thing), "text/html": to_html(thing)}
    if find_spec("anywidget") is None:
        return still
    shown = thing.widget._repr_mimebundle_(**options)
    data, metadata = shown if isinstance(shown, tuple) else (shown or {}, {})
    return {**data, **still}, metadata


def save(thing: Any, path: str | os.PathLike[str]) -> None:
    """Write the page of ``thing``, replaced atomically. Raises InputError if its name ends as another kind of file."""
    check_ending(path, "pages", ".html")
    write_text(path, page(thing))


@singledispatch
def page(thing: Any) -> str:
    """Return the self-contained page of anything that has one; TypeError for anything else."""
    raise TypeError(f"a {type(thing).__name__} has no page")


page.register(Network, network_html)
page.register(Learning, learning_html)
page.register(Comparison, lambda found: sheet_html(comparison.comparison(found)))
page.register(RoomModel, lambda found: sheet_html(rooms.room(found)))
page.register(FreeSpace, lambda found: sheet_html(rooms.free_space(found)))


@singledispatch
def sheet(thing: Any) -> Sheet:
    """Return the sheet of anything that shows itself; TypeError for anything else."""
    raise TypeError(f"nothing here draws or prints a {type(thing).__name__}")


for _kind, _sheet in (
    (ForwardModel, models.forward_model),
    (InverseModel, models.inverse_model),
    (Posterior, models.posterior),
    (ProbabilityTable, tables.probability_table),
    (PreyModel, prey.prey_model),
    (RoomModel, rooms.room),
    (FreeSpace, rooms.free_space),
    (ParticleBelief, belief.particle_belief),
    (Plan, plans.plan),
    (Episode, plans.episode),
    (Network, network.network),
    (Learning, learning.learning),
    (Comparison, comparison.comparison),
    (Trace, tracing.trace),
    (CellTrace, tracing.cell),
    (PlanTrace, tracing.plan),
    (Assessment, assessment.assessment),
    (RobotSettings, settings.robot),
    (GaitRepertoire, settings.gaits),
    (ExperimentSettings, settings.experiment),
    (Shown, settings.planner),
):
    sheet.register(_kind, _sheet)
