"""Scores on recordings in a terminal: of prey models, and of one's own motion."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bayeshunt.core.units import in_unit
from bayeshunt.views.terminal.terminal import out
from bayeshunt.views.terminal.text_tables import TextTable, folding

__all__ = ["following_table", "forward_table", "scores_table"]


def following_table(summary: pd.DataFrame, band: tuple[float, float]) -> None:
    """Print the summary of ``follow``, a row a prey model. band: distances [m] that are company."""
    number = int(summary["n"].max())
    table = TextTable(
        folding("model", 18), "caught", "95 % Wilson", "time s", f"{band[0]:g}-{band[1]:g} m",
        title=f"{number} recorded walkers followed",
    )  # fmt: skip
    for row in summary.to_dict("records"):
        table.row(
            str(row["model"]), f"{row['caught']}/{row['n']}", f"{row['share_low']:.1%} to {row['share_high']:.1%}",
            f"{row['mean_time']:.2f}", f"{row['company']:.1%}",
        )  # fmt: skip
    table.print(out)
    out.print(
        "Time: of the catch, the end of the walker's track if missed. Last column: share of the track at these "
        "distances.", style="dim",
    )  # fmt: skip
    if "time_differs" not in summary:
        return
    apart = TextTable(
        folding("less constant velocity", 22), "caught", "time s", "company", title="Differences, paired over walkers"
    )
    for row in summary[summary["model"] != "constant_velocity"].to_dict("records"):
        cells = (
            f"{row[f'{name}_differs']:+.2f} [{row[f'{name}_low']:+.2f}, {row[f'{name}_high']:+.2f}]"
            for name in ("caught", "time", "company")
        )
        apart.row(str(row["model"]), *cells)
    apart.print(out)
    out.print("Shares of walkers, seconds, shares of time; 95 % bootstrap intervals over walkers.", style="dim")


def forward_table(scores: pd.DataFrame, folds_by: str | None) -> None:
    """Print the table of ``score_forward``, a row a model."""
    times, unit = in_unit(float(scores["position_high"].max()))
    table = TextTable(
        folding("model", 20), f"position {unit}", "95 % interval", "heading °", "95 % interval",
        title=f"{int(scores['n'].max())} windows, held out",
    )  # fmt: skip
    for row in scores.to_dict("records"):
        if not row["n"]:
            table.row(str(row["model"]), "not known", "", "", "")
            continue
        table.row(
            str(row["model"]), _short(times * row["position_m"]),
            f"{_short(times * row['position_low'])} to {_short(times * row['position_high'])}",
            f"{row['heading_deg']:.1f}", f"{row['heading_low']:.1f} to {row['heading_high']:.1f}",
        )  # fmt: skip
    table.print(out)
    kept = f"whole values of {folds_by!r} are held out and resampled" if folds_by else (
        "blocks of ten rows are resampled; rows that follow each other are alike: hold out whole runs with --folds-by"
    )  # fmt: skip
    out.print(f"Intervals: {kept}.", style="dim", markup=False)


def scores_table(scores: pd.DataFrame, unit: str) -> None:
    """Print the table of ``score_prey``, a row a model; lengths in ``unit``."""
    lengths = ["ade", "ade_low", "ade_high", "fde", "best20_ade", "best20_fde", "energy"]
    times, shown = in_unit(float(np.nanmax(scores[lengths].to_numpy(dtype=float))), unit)
    scores = scores.assign(**{name: times * scores[name] for name in lengths})
    table = TextTable(
        folding("model", 23), f"ADE {shown}", "95 % interval", f"FDE {shown}", "best of 20", "energy", "nats",
        "covers %",
        title=f"{int(scores['n'].max())} windows of {int(scores['individuals'].max())} individuals",
    )  # fmt: skip
    for row in scores.to_dict("records"):
        sampled = not pd.isna(row["nll"])
        cover = f"{100 * row['cover50']:.0f}/{100 * row['cover90']:.0f}" if sampled else ""
        interval = f"{_short(row['ade_low'])} to {_short(row['ade_high'])}"
        table.row(
            str(row["model"]), _short(row['ade']), interval, _short(row['fde']),
            f"{_short(row['best20_ade'])}/{_short(row['best20_fde'])}", _short(row['energy']),
            f"{row['nll']:.2f}" if sampled else "", cover,
        )  # fmt: skip
    table.print(out)
    resampled = scores["resampled"].iloc[0]
    out.print(
        f"Windows overlap and frames depend on each other: intervals resample {resampled}, not windows.",
        style="dim",
    )
    out.print(
        "The point of a sampled forecast is its spatial median; covers: of the 50 and 90 % regions; "
        f"nats: less the log of the density per {unit}².", style="dim",
    )  # fmt: skip


def _short(value: float) -> str:
    """Three digits, and whole numbers from 100 on."""
    return f"{value:.0f}" if abs(value) >= 99.95 else f"{value:.3g}"
