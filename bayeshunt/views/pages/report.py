"""The report of an evaluation: one page with the table, the figures, hunts to play, and how to make it again."""

from __future__ import annotations

import base64
import os
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import parse
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.errors import DataError
from bayeshunt.core.units import theta
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.experiments.reported import compare
from bayeshunt.experiments.scores import as_evaluated, paired_differences, summarise
from bayeshunt.experiments.store.export import NOT_AB_INITIO, another_model
from bayeshunt.files.atomic import write_text
from bayeshunt.files.endings import check_ending
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.registry import is_ab_initio
from bayeshunt.views import reported
from bayeshunt.views.pages.commands import SETTINGS_FILE, evaluate_command, model_option, preset_of, to_toml
from bayeshunt.views.pages.page import embed, render
from bayeshunt.views.pages.replay import SCRIPTS, STYLES
from bayeshunt.views.pages.report_charts import styles, success_charts, time_charts
from bayeshunt.views.pages.report_gallery import Shelf, build_shelf

__all__ = ["Progress", "report_facts", "report_html", "write_report"]

_MOST_PAIRS = 60  # of planners, in the table of differences
#: Called with the number of rows of the gallery that have just been made.
Progress = Callable[[int], None]


@checked
def write_report(
    results: pd.DataFrame,
    path: str | os.PathLike[str],
    *,
    model: ForwardModel | None = None,
    model_path: str | None = None,
    progress: Progress | None = None,
) -> list[str]:
    """Write the report of an evaluation as one HTML file, replaced atomically; return its warnings.

    results: one row per hunt, from ``bayeshunt.evaluate`` or ``bayeshunt.load_results``.
    model: the model the hunts were made with; by default it is learned again from settings and seed.
    model_path: what the commands on the page call the model file.

    Raises DataError if the results are empty or do not say their settings.
    """
    facts = report_facts(results, model=model, model_path=model_path, progress=progress)
    check_ending(path, "pages", ".html")
    write_text(path, report_html(facts))
    told = [f"{shelf.planner}, {shelf.arena}: {shelf.problem}" for shelf in facts["shelves"] if shelf.problem]
    return [*([facts["another_model"]] if facts["another_model"] else []), *told]


def report_html(facts: dict[str, Any]) -> str:
    """Return the page for what :func:`report_facts` gathered."""
    hunts = [{k: v for k, v in hunt.items() if k != "thumbnail"} for s in facts["shelves"] for hunt in s.hunts]
    return render(
        "report.html.j2", ["page.css", *STYLES, "report.css"], [*SCRIPTS, "report.js"],
        data=[embed(hunt) for hunt in hunts], theta_words=theta, **facts,
    )  # fmt: skip


def report_facts(
    results: pd.DataFrame,
    *,
    model: ForwardModel | None = None,
    model_path: str | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Return everything that the page shows."""
    settings, seed = _origin(results)
    shown = as_evaluated(results, settings)
    learned = model if model is not None else learn_model(settings, seed)
    rows, compared = summarise(results, settings), compare(results, settings)
    pairs = list(dict.fromkeys(zip(results["planner"], results["arena"], strict=True)))
    planners, arenas = (list(dict.fromkeys(part)) for part in zip(*pairs, strict=True))
    shelves = []
    for planner, arena in pairs:
        source = model_option(model_path, seed)
        shelves.append(build_shelf(results, settings, learned, planner, arena, seed, source=source))
        if progress is not None:
            progress(1)
    looks = styles(planners)
    text = to_toml(settings)
    return {
        "title": settings.name, "note": shown.note, "scaled": settings.scaled, "seed": seed, "hunts": len(results),
        "runs": settings.protocol.runs, "limit": settings.protocol.time_limit,
        "evaluated_with": results.attrs.get("version", version("bayeshunt")),
        "totals": [row for row in rows if row["theta"] is None],
        "bearings": [row for row in rows if row["theta"] is not None],
        "looks": list(looks.values()),
        "marked": [name for name in planners if not is_ab_initio(name, settings.planner.get(name, {}))],
        "mark": NOT_AB_INITIO,
        "published": list(shown.published),
        "reported": reported.sentences(compared), "tests": reported.TESTS, "tested": reported.p_values(compared),
        "by_theta": any(row["paper_success"] is not None for row in rows if row["theta"] is not None),
        "paired": paired_differences(results)[:_MOST_PAIRS],
        "success": success_charts(rows, looks),
        "times": time_charts(results, settings, looks),
        "pace": [_pace(results, shelf) for shelf in shelves],
        "measured": "energy" in results,
        "shelves": shelves,
        "command": evaluate_command(settings, planners, arenas, seed, model=model_path),
        "settings_file": SETTINGS_FILE if preset_of(settings) is None else None,
        "toml": text,
        "toml_link": "data:application/toml;base64," + base64.b64encode(text.encode()).decode(),
        "learned": model is None, "another_model": another_model(results.attrs.get("model"), learned),
        "babbling_steps": settings.model.babbling_steps,
    }  # fmt: skip


def _origin(results: pd.DataFrame) -> tuple[ExperimentSettings, int]:
    """The settings and the seed that the results carry."""
    recorded = results.attrs
    if "settings" not in recorded or "seed" not in recorded:
        raise DataError("these results do not say their settings and seed; use those of bayeshunt evaluate --out")
    if results.empty:
        raise DataError("these results hold no hunt; there is nothing to report")
    return parse(ExperimentSettings, recorded["settings"], "the results' settings"), int(recorded["seed"])


def _pace(results: pd.DataFrame, shelf: Shelf) -> dict[str, Any]:
    """How one planner hunts in one arena: catch times, way, decisions."""
    hunts = results[(results["planner"] == shelf.planner) & (results["arena"] == shelf.arena)]
    times = hunts.loc[hunts["caught"], "time"]
    seconds = shelf.decision_seconds
    return {
        "planner": shelf.planner, "arena": shelf.arena,
        "quartiles": [float(q) for q in np.quantile(times, [0.25, 0.5, 0.75])] if len(times) else None,
        "distance": float(hunts["distance"].mean()),
        "speed": float(hunts["distance"].sum() / hunts["time"].sum()) if hunts["time"].sum() > 0 else None,
        "decisions": float(hunts["decisions"].mean()),
        "transitions": float(hunts["transitions"].mean()),
        "energy": float(hunts["energy"].mean()) if "energy" in hunts else None,
        "falls": float(hunts["falls"].mean()) if "falls" in hunts else None,
        "decision_ms": 1000 * float(np.median(seconds)) if seconds else None,
        "measured": len(seconds),
    }  # fmt: skip
