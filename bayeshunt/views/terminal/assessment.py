"""An assessment as text: five short tables that fit 80 columns."""

from __future__ import annotations

import math
from typing import Any

from rich.console import Console
from rich.text import Text

from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.models.assessment.assess import Assessment
from bayeshunt.models.assessment.warnings import is_grave
from bayeshunt.models.tables.structures import PREVIOUS
from bayeshunt.views.terminal import terminal
from bayeshunt.views.terminal.text_tables import TextTable, string_console, word

__all__ = ["assessment_tables", "assessment_text"]


def assessment_text(assessment: Assessment) -> str:
    """Return what :func:`assessment_tables` prints, without colours, at most 100 columns wide."""
    page = string_console(100)
    assessment_tables(assessment, page)
    return str(page.file.getvalue().rstrip())  # type: ignore[attr-defined]


def assessment_tables(assessment: Assessment, out: Console = terminal.out) -> None:
    """Print an assessment: predictions, gaits, independence, other structures, what to know."""
    facts = assessment.settings
    bins = ", ".join(f"{name} {number}" for name, number in facts["bins"].items())
    out.print(
        f"{facts['rows']} rows, {facts['folds']} folds, seed {facts['seed']}; bins {bins}; "
        f"Dirichlet prior {facts['prior']:g} per cell", style="dim",
    )  # fmt: skip
    _variables(assessment, out)
    _gaits(assessment, out)
    _independence(assessment, out)
    _structures(assessment, out)
    if assessment.given is not None:
        _given(assessment.given, out)
    for note in assessment.notes:
        out.print(Text(note, style="bold red" if is_grave(note) else "italic"))


def _variables(assessment: Assessment, out: Console) -> None:
    name = assessment.settings["structure"]
    heads = ("variable", "log-loss", "no gait", "density", "Brier", "no gait")
    table = _table(f"Held-out predictions, structure {name}", *heads)
    for variable, row in assessment.variables.iterrows():
        columns = ("log_loss", "log_loss_without_gait", "density", "brier", "brier_without_gait")
        table.row(str(variable), *(_number(row[column]) for column in columns))
    table.print(out)
    total, blind = (float(assessment.variables[c].sum()) for c in ("density", "density_without_gait"))
    out.print(
        "Nat per row, less is better; 'no gait': one forecast for every gait.\n"
        "Density: log-loss of a density, nat per m or rad, less is better; it compares over bins: "
        f"{total:.2f} in all, without the gait {blind:.2f}.",
        style="dim",
    )  # fmt: skip


def _gaits(assessment: Assessment, out: Console) -> None:
    rows, accuracy = assessment.settings["rows"], assessment.gaits["accuracy"]
    right = round(accuracy * rows)
    low, high = wilson_interval(right, rows)
    out.print(Text("\nWhich gait was it? P(Gait | Distance, Angle)", style="bold"))
    out.print(f"{right}/{rows} right = {accuracy:.2%} (95 % Wilson {low:.2%} to {high:.2%}),", end=" ")
    out.print(f"with Heading {assessment.gaits['accuracy_with_heading']:.2%}")
    names, counts = list(assessment.confusion.index), assessment.confusion.to_numpy()
    wrong = [(counts[i, j], i, j) for i in range(len(names)) for j in range(len(names)) if i != j and counts[i, j]]
    for count, executed, inferred in sorted(wrong, key=lambda item: -item[0])[:5]:
        out.print(f"  {names[executed]} taken for {names[inferred]}: {count}", markup=False)


def _independence(assessment: Assessment, out: Console) -> None:
    shuffles = assessment.settings["permutations"]
    table = _table("Independent given the gait?", "pair", "G", "df", "p", "p chi2", "bits", "by chance")
    for row in assessment.independence.itertuples():
        table.row(
            f"{row.x}, {row.y}", f"{row.g:.1f}", str(row.degrees), f"{row.p_permutation:.3f}",
            f"{row.p_chi2:.2g}", f"{row.information_bits:.4f}", f"{row.information_chance_bits:.4f}",
        )  # fmt: skip
    table.print(out)
    out.print(
        f"p: {shuffles} shuffles within each gait: go by it. p chi2 does not hold in sparse tables.\n"
        "bits: I(X; Y | Gait) in the rows, and its mean over the shuffles.", style="dim",
    )  # fmt: skip


def _structures(assessment: Assessment, out: Console) -> None:
    table = _table(
        "What the paper's assumption costs", "structure", "log-loss", "gain", "95 % interval", "BIC", "params"
    )
    best = assessment.structures["log_loss"].idxmin()
    for name, row in assessment.structures.iterrows():
        interval = "" if name == "naive" else f"{_number(row['gain_low'], '+')} to {_number(row['gain_high'], '+')}"
        gain = "" if name == "naive" else _number(row["gain"], "+")
        table.row(
            str(name), _number(row["log_loss"]), gain, interval, f"{row['bic']:,.0f}", f"{row['parameters']:,}",
            style="bold" if name == best else None,
        )  # fmt: skip
    table.print(out)
    for name, row in assessment.structures.iterrows():
        leans = assessment.settings["backoff"] if PREVIOUS in row["factors"] else None
        leant = "" if leans is None else f", each leaning on the gait's own table as on {leans:g} rows"
        out.print(Text(f"{name}: {row['factors']}{leant}"), style="dim")
    out.print(
        "Log-loss of Distance, Angle and Heading together, held out, nat per row; gain over naive.\n"
        "BIC on all rows, more is better: it charges every parameter, seen or not.", style="dim",
    )  # fmt: skip


def _given(given: dict[str, Any], out: Console) -> None:
    held = {
        True: "it counted these very rows: not held out",
        False: "its own tables on these rows",
        None: "imported, so it may have been made from these very rows",
    }[given["same_rows"]]
    prior = "" if given["prior"] is None else f", prior {given['prior']:g}"
    out.print(Text(f"\nThe model given ({given['structure']}{prior}): {held}", style="bold"))
    out.print(f"log-loss {_number(given['log_loss'])}; {given['impossible']} rows have probability 0;", end=" ")
    out.print(f"log-loss of the others {_number(given['log_loss_of_possible'])}")


def _table(title: str, first: str, *columns: str) -> TextTable:
    return TextTable(word(first), *columns, title=f"\n{title}", style="bold")


def _number(value: float, sign: str = "") -> str:
    if math.isnan(value):
        return "-"
    return "infinite" if math.isinf(value) else f"{value:{sign}.4f}"
