"""Results on disk: every hunt as Parquet, the summary as JSON and Markdown."""

from __future__ import annotations

import json
import os
import shlex
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import DataError, InputError, ResultsError
from bayeshunt.experiments.reported import compare
from bayeshunt.experiments.scores import as_evaluated, summarise
from bayeshunt.experiments.store.identity import Identity, model_fingerprint
from bayeshunt.files import parquet
from bayeshunt.files.atomic import write_text
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.registry import is_ab_initio

__all__ = [
    "HUNTS_FILE",
    "NOT_AB_INITIO",
    "SUMMARY_JSON",
    "SUMMARY_MARKDOWN",
    "another_model",
    "check_output_folder",
    "check_same_export",
    "load_results",
    "save_results",
    "summary",
    "to_markdown",
]

HUNTS_FILE = "hunts.parquet"
SUMMARY_JSON = "summary.json"
SUMMARY_MARKDOWN = "summary.md"
#: What the mark * beside a planner says.
NOT_AB_INITIO = "Not ab initio: it was given more than it learns within the run (a bound, or earlier experience)."
_KIND = "results"
_NAMED = ("planner", "arena")  # columns that say what was evaluated


def summary(results: pd.DataFrame, settings: ExperimentSettings, seed: int) -> dict[str, Any]:
    """Return the summary that ``bayeshunt evaluate --json`` prints."""
    return {
        "rows": summarise(results, settings),
        "reported": compare(results, settings),
        "experiment": settings.name,
        "note": as_evaluated(results, settings).note,
        "scaled": settings.scaled,
        "seed": int(seed),
        "version": version("bayeshunt"),
        "model": results.attrs.get("model"),
        "structure": results.attrs.get("structure"),
        "not_ab_initio": sorted(
            name for name in set(results["planner"]) if not is_ab_initio(name, settings.planner.get(name, {}))
        ),
    }


def check_output_folder(folder: str | os.PathLike[str]) -> Path:
    """Create the output folder if need be; InputError in one line if that cannot be."""
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be used as an output folder ({error.strerror or error})") from None
    if not os.access(path, os.W_OK):
        raise InputError(f"{path}: the output folder is not writable")
    return path


@checked
def save_results(
    results: pd.DataFrame, settings: ExperimentSettings, seed: int, folder: str | os.PathLike[str]
) -> None:
    """Write hunts.parquet, summary.json and summary.md into ``folder``, each replaced atomically."""
    import pyarrow as pa

    check_whole(seed, "seed", 0)
    path = check_output_folder(folder)
    record = {"kind": _KIND, "seed": int(seed), "settings": settings.model_dump(mode="json")}
    record |= {"version": version("bayeshunt"), "model": results.attrs.get("model")}
    record["structure"] = results.attrs.get("structure")
    plain = results.copy(deep=False)
    plain.attrs = {}
    parquet.write(pa.Table.from_pandas(plain, preserve_index=False), record, path / HUNTS_FILE)
    facts = summary(results, settings, seed)
    write_text(path / SUMMARY_JSON, json.dumps(facts, indent=1) + "\n")
    write_text(path / SUMMARY_MARKDOWN, to_markdown(facts))


@checked
def load_results(folder: str | os.PathLike[str]) -> pd.DataFrame:
    """Read the hunts of a results folder; settings, seed and fingerprint of the model in ``frame.attrs``.

    Raises DataError in one line if there are none or the file is damaged.
    """
    path = Path(folder) / HUNTS_FILE
    if not path.is_file():
        raise DataError(_missing(Path(folder)))
    fix = "move it away and give the evaluate line again, or give another results folder"
    table, record = parquet.read(path, what="results", fix=fix)
    if record is None or record.get("kind") != _KIND:
        raise DataError(f"{path}: cannot be read as results (another kind of file); {fix}")
    frame = table.to_pandas()
    frame.attrs = record
    found: pd.DataFrame = frame
    return found


def _missing(folder: Path) -> str:
    """What to do about a folder without results: begin an evaluation, or let the one begun end."""
    from bayeshunt.experiments.store.database import DATABASE_FILE
    from bayeshunt.experiments.store.status import status

    if not (folder / DATABASE_FILE).is_file():
        return f"{folder}: no {HUNTS_FILE} here; make one with: bayeshunt evaluate --out {shlex.quote(str(folder))}"
    found = status(folder)
    done = f"{folder}: {found.ended} of {found.planned} hunts are done"
    return f"{done}, and it is running" if found.running else f"{done}; give the same evaluate line again to go on"


def another_model(there: str | None, model: ForwardModel, what: str = "the hunts were") -> str | None:
    """Return one line if ``what`` made with another model than ``model``; None if not, or if nobody noted it.

    there: the fingerprint that results (``frame.attrs["model"]``) or an episode's provenance note.
    """
    here = model_fingerprint(model)
    if there is None or here == there:
        return None
    found = "an imported network" if here is None else f"one of fingerprint {here[:12]}"
    return f"{what} made with a model of fingerprint {there[:12]}, this is {found}; give theirs with --model"


def check_same_export(folder: Path, settings: ExperimentSettings, asked: Identity) -> None:
    """Raise ResultsError if ``folder`` holds exported results of another experiment, which would be replaced."""
    if not (folder / HUNTS_FILE).exists():
        return
    frame = load_results(folder)
    there = [frame.attrs.get("settings"), frame.attrs.get("seed"), *(list(frame[k].unique()) for k in _NAMED)]
    here = [json.loads(settings.model_dump_json()), asked.seed, list(asked.planners), list(asked.arenas)]
    models = {frame.attrs.get("model"), asked.model} - {None, ""}  # earlier files do not say theirs
    if there != here or len(models) > 1:
        raise ResultsError(f"{folder / HUNTS_FILE} holds results of another experiment; choose another --out")


def to_markdown(facts: dict[str, Any]) -> str:
    """Return the summary as a Markdown document: totals, then per bearing."""
    measured = any("mean_energy_j" in row for row in facts["rows"])
    lines = [f"# {facts['experiment']}: success and catch time", ""]
    lines += [line for text in (facts["scaled"], facts["note"]) if text for line in (text, "")]
    lines += [
        f"Seed {facts['seed']}, bayeshunt {facts['version']}. "
        "Intervals are 95 % Wilson; a miss counts as the time limit.",
        "",
        "| planner | arena | theta [rad] | runs | caught | success | 95 % interval | mean time [s] | paper |"
        + (" energy [J] | changes | falls |" if measured else ""),
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |" + (" --- | --- | --- |" if measured else ""),
    ]
    totals = [row for row in facts["rows"] if row["theta"] is None]
    bearings = [row for row in facts["rows"] if row["theta"] is not None]
    lines += [_markdown_row(row, facts) for row in [*totals, *bearings]]
    lines += _compared(facts["reported"])
    if facts.get("not_ab_initio"):
        lines += ["", f"\\* {NOT_AB_INITIO}"]
    return "\n".join(lines) + "\n"


def _compared(rows: list[dict[str, Any]]) -> list[str]:
    """What was published, beside what came out, as a Markdown table; nothing where no counts were published."""
    tested = [row for row in rows if row["p_success"] is not None]
    if not tested:
        return []
    lines = ["", "| reported | arena | theta [rad] | paper | here | p (Fisher) | paper, mean time [s] | here | p (z) |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    for row in tested:
        theta = "all" if row["theta"] is None else f"{row['theta']:g}"
        times = ["", "", ""]
        if row["p_time"] is not None:
            times = [f"{row['paper_mean_time_s']:g}", f"{row['mean_time_s']:.2f}", f"{row['p_time']:.3g}"]
        counts = [f"{row['paper_caught']}/{row['paper_runs']}", f"{row['caught']}/{row['runs']}"]
        cells = [row["planner"], row["arena"], theta, *counts, f"{row['p_success']:.3g}", *times]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _markdown_row(row: dict[str, Any], facts: dict[str, Any]) -> str:
    mark = " \\*" if row["planner"] in facts.get("not_ab_initio", ()) else ""
    theta = "all" if row["theta"] is None else f"{row['theta']:g}"
    paper = "" if row["paper_success"] is None else f"{row['paper_success']:.2%}"
    return (
        f"| {row['planner']}{mark} | {row['arena']} | {theta} | {row['runs']} | {row['caught']} | {row['success']:.2%} "
        f"| {row['ci_low']:.2%} to {row['ci_high']:.2%} | {row['mean_time_s']:.2f} | {paper} |"
    ) + (
        f" {row['mean_energy_j']:.2f} | {row['mean_changes']:.2f} | {row['mean_falls']:.2f} |"
        if "mean_energy_j" in row
        else ""
    )
