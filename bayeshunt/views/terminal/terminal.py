"""What people see in a terminal: tables, bars, progress. Messages go to stderr, results to stdout."""

from __future__ import annotations

import contextlib
import math
import textwrap
from collections.abc import Callable, Iterator, Mapping
from datetime import timedelta
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from bayeshunt.core.units import bounds, degrees, length, objective
from bayeshunt.views import reported
from bayeshunt.views.terminal.text_tables import TextTable, folding, toml_text, word

__all__ = [
    "episode_table",
    "explanation_table",
    "messages",
    "out",
    "posterior_bars",
    "progress_bar",
    "remark",
    "routes_table",
    "say",
    "settings_table",
    "status_table",
    "success_table",
    "sweep_table",
    "tradeoff_table",
]

out = Console(highlight=False, markup=False)  # units stand in square brackets
messages = Console(stderr=True, highlight=False, markup=False)

_BAR = 30  # characters of a full bar
_WORD = len("Ornstein-Uhlenbeck")  # the longest word of a meaning


@contextlib.contextmanager
def progress_bar(label: str, total: int | None, *, quiet: bool = False) -> Iterator[Callable[[int], None]]:
    """Show a progress bar on stderr while the block runs; yields the function that advances it.

    total: None if nobody knows how much there is: then the bar says only that work goes on, and for how long.
    """
    counted = () if total is None else (MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    columns = (TextColumn("{task.description}"), BarColumn(), *(counted or (TimeElapsedColumn(),)))
    with Progress(*columns, console=messages, transient=True, disable=quiet or not messages.is_terminal) as progress:
        task = progress.add_task(label, total=total)
        yield lambda count: progress.update(task, advance=count)


def say(line: str) -> None:
    """Print one message line on stderr; what has been done does not fail because nobody can be told."""
    with contextlib.suppress(OSError):
        messages.print(line, soft_wrap=True, markup=False)


def remark(line: str) -> None:
    """Print one line under a result."""
    out.print(line, style="dim", soft_wrap=True)


def success_table(facts: dict[str, Any], *, per_theta: bool = False) -> None:
    """Print the table of an evaluation: the totals, the paper's figures beside ours, p where its counts are known."""
    chosen = [row for row in facts["rows"] if per_theta or row["theta"] is None]
    compared = facts.get("reported", [])
    tested = reported.p_values(compared)
    # without counts the paper's shares are of all bearings: nothing that could stand beside one
    printed = any(row["paper_success"] is not None for row in chosen) and (tested or not per_theta)
    beside = ("paper %", "p" if tested else "diff") if printed else ()
    marked = facts.get("not_ab_initio", ())
    places = [folding("planner"), word("arena"), *([word("theta")] if per_theta else [])]
    measured = any("mean_energy_j" in row for row in chosen)
    spent = ("mean J", "changes", "falls") if measured else ()
    table = TextTable(
        *places, "caught", "success %", "95 % interval", "mean s", *beside, *spent,
        title=f"{facts['experiment']}, seed {facts['seed']}",
    )  # fmt: skip
    _scaled(facts)
    previous = None
    for row in chosen:
        total = row["theta"] is None
        place = (row["planner"], row["arena"]) if per_theta else row["arena"]
        if previous is not None and place != previous:
            table.section()
        previous = place
        cells = _cells(row)
        if tested:
            cells[-1] = tested.get((row["planner"], row["arena"], row["theta"]), "")
        cells[0] += " *" if row["planner"] in marked else ""
        shown = cells[:2] + cells[2 if per_theta else 3 : None if printed else -2]
        table.row(*shown, *(_spent(row) if measured else ()), style="bold" if total and per_theta else None)
    table.print(out)
    for line in reported.sentences(compared):
        out.print(line)
    if facts["note"]:
        out.print(Text(facts["note"], style="italic"))
    if tested:
        out.print(reported.TESTS, style="dim")
    if marked:
        out.print("* Not ab initio: given more than it learns within the run (a bound, or earlier runs).", style="dim")
    out.print("Intervals are 95 % Wilson. A miss counts as the time limit in the mean time.", style="dim")
    if measured:
        out.print("J, changes, falls: energy, changes of gait and falls, each the mean of a hunt.", style="dim")


def _scaled(facts: Mapping[str, Any]) -> None:
    """Say at the head of a table that arenas and prey were drawn to another hunter."""
    if facts.get("scaled"):
        out.print(Text(facts["scaled"]))


def _spent(row: dict[str, Any]) -> list[str]:
    return [f"{row['mean_energy_j']:.1f}", f"{row['mean_changes']:.1f}", f"{row['mean_falls']:.2f}"]


def status_table(found: Any) -> None:
    """Print how far an evaluation is."""
    table = TextTable(word("planner"), word("arena"), "ended", "of", "caught", ruled=False)
    for share in found.shares:
        table.row(share.planner, share.arena, f"{share.ended:,}", f"{share.planned:,}", f"{share.caught:,}")
    table.print(out)
    percent = 100 * found.ended / found.planned
    out.print(f"{found.experiment}: {found.ended:,} of {found.planned:,} hunts, {percent:.1f} %", style="bold")
    if found.running and found.rate:
        left = timedelta(seconds=round(found.seconds_left))
        out.print(f"running (process {found.process} on {found.host}), {found.rate:.0f} hunts/s, {left} left")
    elif found.running:
        out.print(f"running (process {found.process} on {found.host})")
    elif found.ended < found.planned:
        out.print("not running; the evaluate line that started it goes on from here")
    else:
        out.print("finished")


def episode_table(episode: Any) -> None:
    """Print one hunt: a row per decision, then how it ended."""
    from bayeshunt.views.grounds import value_within

    table = TextTable(
        "step", "time", "prey at", "bearing", "aims at", word("gait"), "value", "moves",
        title="{planner} in {arena}, theta {theta:g}, seed {seed}".format(**episode.provenance),
    )  # fmt: skip
    sures = value_within(episode)
    for row, within in zip(episode.frame.itertuples(), sures, strict=True):
        seen = length(row.seen_distance), degrees(row.seen_angle), length(row.target_distance)
        value, moves = objective(row.value, row.objective)[0], str(row.prey_observations)
        table.row(row.step, f"{row.time:.1f} s", *seen, row.gait, f"{value:.3g}{within}", moves)
    table.print(out)
    if len(episode.frame):
        what = objective(0.0, episode.frame["objective"].iloc[0])[1]
        sure = " (95 % interval)" if any(sures) else ""
        out.print(f"value: {what}{sure}. moves: prey transitions learned so far.", style="dim")
    else:
        out.print("no decision was made: the prey starts within the catch distance.", style="dim")
    if len(episode.frame) and episode.frame["target_distance"].notna().any():
        out.print(
            "aims at: distance of the place it makes for; who predicts makes for one some steps ahead.", style="dim"
        )
    ending = f"caught after {episode.time:.2f} s" if episode.caught else f"not caught in {episode.time:g} s"
    out.print(f"{ending}; {episode.spent}" if episode.spent else ending, style="bold")


def settings_table(rows: list[dict[str, Any]]) -> None:
    """Print every settings key with its range, default and meaning."""
    table = TextTable(word("key"), folding("range"), folding("default"), folding("meaning", _WORD), ruled=False)
    for row in rows:
        table.row(row["key"], row["range"], toml_text(row["default"]), row["meaning"])
    table.print(out)


def sweep_table(frame: Any) -> None:
    """Print a sweep: one row per point, planner and arena."""
    _scaled(frame.attrs)
    axes = frame.attrs["axes"]
    table = TextTable(
        *map(folding, axes), folding("planner", 15), word("arena"), "caught", "success %", "95 % interval", "mean s",
        title=f"{frame.attrs['experiment']}, seed {frame.attrs['seed']}",
    )  # fmt: skip
    previous = None
    for row in frame.to_dict("records"):
        point = [row[name] for name in axes]
        if previous is not None and point != previous:
            table.section()
        previous = point
        shown = [f"{v:g}" if isinstance(v, float) else str(v) for v in point]
        cells = _cells({**row, "theta": None, "paper_success": None})
        table.row(*shown, *cells[:2], *cells[3:7])
    table.print(out)
    if frame.attrs["note"]:
        out.print(Text(frame.attrs["note"], style="italic"))
    out.print("Intervals are 95 % Wilson. A miss counts as the time limit in the mean time.", style="dim")


def routes_table(frame: Any) -> None:
    """Print which side was chosen, against how well the arena was known."""
    _scaled(frame.attrs)
    table = TextTable(
        word("map"), "hunts", "chose", "right", "95 %", "reached", "mean s",
        title="{experiment}, seed {seed}, {maps} maps an arena".format(**frame.attrs),
    )  # fmt: skip
    for row in frame.to_dict("records"):
        interval = f"{100 * row['right_low']:.0f} to {100 * row['right_high']:.0f}" if row["chose"] else ""
        table.row(
            f"{row['amount']:,} {row['map']}", row["hunts"], row["chose"], row["right"], interval,
            f"{row['reached']}/{row['hunts']}", f"{row['time_s']:.1f}",
        )  # fmt: skip
    table.print(out)
    if frame.attrs["note"]:
        out.print(Text(frame.attrs["note"], style="italic"))
    out.print("chose: left the straight line for a side; right: for that of the shortest way (95 % Wilson, of those "
              "that chose). A miss counts as the time limit in the mean time.", style="dim")  # fmt: skip


def tradeoff_table(frame: Any) -> None:
    """Print a trade-off: one row per planner and weight."""
    _scaled(frame.attrs)
    table = TextTable(
        folding("planner", 10), folding("varied", 11), "caught", "95 %", "s", "m", "changes", "ms",
        *(["J"] if "mean_energy_j" in frame else []), "cost",
        title="{experiment} in {arena}, seed {seed}".format(**frame.attrs),
    )  # fmt: skip
    for row in frame.to_dict("records"):
        varied = f"{row['weight']} {row['value']:g}" if row["weight"] else ""
        caught, _, interval, mean = _cells({**row, "arena": "", "theta": None, "paper_success": None})[3:7]
        interval = interval.replace(" to ", "-")  # so that all fits into 80 columns
        table.row(
            row["planner"], varied, caught, interval, mean,
            f"{row['mean_distance_m']:.2f}", f"{row['mean_transitions']:.2f}",
            f"{row['planning_ms']:.2f}", *([f"{row['mean_energy_j']:.1f}"] if "mean_energy_j" in row else []),
            f"{row['cost']:.1f}",
        )  # fmt: skip
    table.print(out)
    weights = ", ".join(f"{name} {value:g}" for name, value in frame.attrs["weights"].items())
    out.print(f"Cost under the weights of the settings: {weights}.", style="dim")
    out.print("95 %: Wilson interval of the success in per cent. s, m, changes: mean time, distance and changes "
              "of gait of a hunt. ms: median time of one decision."
              + (" J: mean energy of a hunt." if "mean_energy_j" in frame else ""), style="dim")  # fmt: skip
    if frame.attrs["note"]:
        out.print(Text(frame.attrs["note"], style="italic"))


def _cells(row: dict[str, Any]) -> list[str]:
    paper = row["paper_success"]
    return [
        row["planner"],
        row["arena"],
        "all" if row["theta"] is None else f"{row['theta']:g}",
        f"{row['caught']}/{row['runs']}",
        f"{100 * row['success']:.1f}",
        f"{100 * row['ci_low']:.1f} to {100 * row['ci_high']:.1f}",
        f"{row['mean_time_s']:.1f}",
        "" if paper is None else f"{100 * paper:.1f}",
        "" if paper is None else f"{100 * (row['success'] - paper):+.1f}",
    ]


def posterior_bars(answer: Any) -> None:
    """Print a posterior over gaits as bars, with what it rests on."""
    from bayeshunt.views import grounds

    out.print(Text(f"P(Gait | {', '.join(answer.evidence)})", style="bold"))
    table = TextTable(word("gait"), word("bar"), "probability", ruled=False, head=False)
    found = grounds.interval(answer)
    within = {} if found is None else grounds.within(found)
    for gait, probability in answer.probabilities.items():
        style = "bold" if gait == answer.best else None
        said = f"{probability:.3f}" + (f" ({bounds(*within[str(gait)])})" if within else "")
        table.row(gait, f"{_bar(float(probability)):<{_BAR}}", said, style=style)
    table.print(out)
    for variable, state in answer.model.known.items():
        out.print(Text(f"{variable:<21}{state}"))
    out.print(f"asked                {answer.asked}")
    out.print(f"{grounds.coordinate_used(answer.model):<18}   {grounds.cell(answer)}")
    if answer.snapped:
        out.print(f"                     ({grounds.snapped(answer)})")
    out.print(f"P(evidence)          {answer.evidence_probability:.6g}")
    out.print(f"support              {grounds.support(answer)}")
    if answer.model.knows_energy:
        out.print(f"energy               {grounds.energy(answer)}")
    if found is not None:
        said = f"how sure             {grounds.how_sure(answer, found)}"
        out.print("\n".join(textwrap.wrap(said, out.width, subsequent_indent=" " * 21, break_long_words=False)))
    if answer.beyond:
        out.print(grounds.beyond(answer), style="italic")


def explanation_table(answer: Any) -> None:
    """Print what each variable said of each gait: log-odds against the best of the others, part by part."""
    frame = answer.explain()
    said = [*(["Heading"] if answer.heading is not None else []), *(["Energy"] if answer.energy is not None else [])]
    parts = ["prior", "Distance", "Angle", *said, "log_odds"]
    out.print()
    out.print(Text("What each variable said", style="bold"))
    table = TextTable(word("gait"), word("compared with"), *(part.replace("_", "-") for part in parts))
    for gait, row in frame.iterrows():
        style = "bold" if gait == answer.best else None
        numbers = ("never" if row[part] == -math.inf else f"{row[part]:+.2f}" for part in parts)
        table.row(gait, row["reference"], *numbers, style=style)
    table.print(out)
    never = "not seen there" if answer.model.has_counts else "of probability 0 there"
    out.print(f"Natural logarithms of ratios; the parts add up to the log-odds. never: {never}.", style="dim")


def _bar(share: float) -> str:
    if out.options.ascii_only:
        return "#" * round(share * _BAR)
    eighths = round(share * _BAR * 8)
    return "█" * (eighths // 8) + ("▏▎▍▌▋▊▉"[eighths % 8 - 1] if eighths % 8 else "")
