"""The figures of the paper, each one function that returns a matplotlib Figure, and all of them by name."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.episodes.episode import Episode
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Plan
from bayeshunt.views.figures.alt import described
from bayeshunt.views.figures.assessment import reliability
from bayeshunt.views.figures.experiments import experiment, setup, success
from bayeshunt.views.figures.models import gait_outcomes, network, prey, prey_table, prey_transition
from bayeshunt.views.figures.plans import planning_step, search_tree
from bayeshunt.views.figures.scores import forward_scores, prey_scores
from bayeshunt.views.figures.space import free_space
from bayeshunt.views.figures.style import save

__all__ = [
    "described",
    "experiment",
    "forward_scores",
    "free_space",
    "gait_outcomes",
    "instructive_plan",
    "network",
    "paper_figures",
    "planning_step",
    "prey",
    "prey_scores",
    "prey_table",
    "prey_transition",
    "reliability",
    "save",
    "save_all",
    "search_tree",
    "setup",
    "success",
]

#: The paper's figure of each experiment; other combinations are called after planner and arena only.
_NUMBERS = {("reactive", "walled"): "3", ("prediction", "walled"): "4", ("prediction", "open"): "4",
            ("planning", "open"): "6b"}  # fmt: skip


def paper_figures(
    model: ForwardModel,
    planned: Episode,
    learned: Episode,
    results: pd.DataFrame,
    settings: ExperimentSettings,
) -> Iterator[tuple[str, Figure]]:
    """Yield file name and figure of every figure of the paper.

    planned: a hunt of the planner "planning", for the search tree and the planning iteration.
    learned: a hunt whose prey turned, for the prey table. Both just made, not read from a file.
    results: one row per hunt; every planner and arena in it gets a figure.

    Raises InputError if a hunt holds no plans or no prey transition.
    """
    yield "fig1b_network", network(model)
    yield "fig1c_gait_outcomes", gait_outcomes(model)
    transition, table = _prey_seen(learned)
    yield "fig2_prey", prey(transition, table, settings.prey.body.diameter)
    for planner, arena in results[["planner", "arena"]].drop_duplicates().itertuples(index=False):
        number = _NUMBERS.get((planner, arena))
        name = f"fig{number}_{planner}_{arena}" if number else f"results_{planner}_{arena}"
        yield _file_name(name), experiment(results, settings, planner, arena)
    plan = instructive_plan(planned)
    yield "fig5_search_tree", search_tree(plan)
    yield "fig6a_planning_step", planning_step(plan)


def save_all(figures: Iterator[tuple[str, Figure]], folder: str | os.PathLike[str]) -> list[Path]:
    """Write every figure as PNG and SVG into ``folder``; returns the paths written."""
    return [path for name, figure in figures for path in save(figure, folder, name)]


def instructive_plan(episode: Episode) -> Plan:
    """Return a plan that shows how planning works: the longest one with a change of gait and a known prey."""
    if not episode.plans:
        raise InputError("the episode holds no plans (a file has none): make it with bayeshunt.hunt")
    known = [plan for plan in episode.plans if plan.prey_known] or list(episode.plans)
    return max(known, key=lambda plan: (len(set(plan.gaits)), len(plan.gaits)))


def _prey_seen(episode: Episode) -> tuple[Polar, PreyModel]:
    """The transition that turned most, and what had been learned by the last decision."""
    if not episode.situations or not episode.situations[-1].transitions:
        raise InputError("the prey was not seen to move in this hunt: it needs two decisions at least")
    last = episode.situations[-1]
    if not isinstance(last.prey_model, PreyModel):
        raise InputError("the prey model of this hunt has no table to draw")
    return max(last.transitions, key=lambda t: abs(t.heading) + abs(t.angle)), last.prey_model


def _file_name(name: str) -> str:
    """A name that any file system takes."""
    return "".join(c if c.isalnum() or c in "._-" else "_" for c in name)
