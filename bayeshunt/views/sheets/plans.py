"""Sheets of a plan, as a tree that can be walked, and of a whole hunt."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.units import degrees, objective
from bayeshunt.episodes.episode import Episode
from bayeshunt.planners.api import Plan
from bayeshunt.views import grounds
from bayeshunt.views.drawings import maps
from bayeshunt.views.notebook.html import Html, number, tag
from bayeshunt.views.sheets.models import bars
from bayeshunt.views.sheets.sheet import Drawn, Note, Part, Printed, Sheet, Table
from bayeshunt.views.terminal.text_tables import clean

__all__ = ["MOST_CHILDREN", "MOST_NODES", "alternatives", "episode", "frame_table", "plan", "tree", "value_column"]

#: At most so many children of a node and so many nodes of a tree are shown.
MOST_CHILDREN = 12
MOST_NODES = 1500
_MOST_ROWS = 200
#: Names that traces give to the value of a node, the unit that people read, and how many of it one is.
_VALUES = (("value_m", "mm", 1000.0), ("value_s", "s", 1.0), ("value", "", 1.0))


def plan(shown: Plan) -> Sheet:
    """Return a decision, what it expects, and the alternatives considered with the chosen branch lit."""
    value, what = objective(shown.value, shown.objective)
    opened = f", {shown.expansions} expanded" if shown.expansions else ""
    pairs: list[tuple[str, Any]] = [
        ("sequence", _runs(shown.gaits)),
        ("value", f"{value:.4g}, {what}"),
        ("nodes", f"{shown.nodes} considered{opened}"),
    ]
    if shown.evidence_probability is not None:
        rests_on = f"P = {shown.evidence_probability:.4g}, support {grounds.rows(shown.support)}"
        pairs.append(("evidence", rests_on))
    known = "the prey model was used" if shown.prey_known else "the prey model was not used"
    considered, printed = alternatives(shown)
    return Sheet(
        f"Plan: {shown.gait}", known, pairs, [Drawn(lambda: maps.plan_map(shown), considered, beside=True), printed]
    )


def alternatives(shown: Plan) -> tuple[Part, Part | None]:
    """Return what was considered, a tree, a bar per gait, or the trace as it is; and its form in text, if any."""
    trace = shown.trace
    if {"node", "parent"} <= set(trace.columns):
        return Drawn(lambda: tree(trace), title="The search tree", opened=True), Printed(lambda: _branch_lines(trace))
    if shown.posterior is not None and "gait" in trace.columns and len(trace) == len(shown.posterior):
        shares = dict(zip(map(str, trace["gait"]), np.asarray(shown.posterior).tolist(), strict=True))
        found = bars(shown.answer, shares, shown.gait, _within(shown, trace))
        return Drawn(found), Printed(found.lines)
    return frame_table(trace), None


def _within(shown: Plan, trace: pd.DataFrame) -> dict[str, tuple[float, float]] | None:
    """The interval of each gait's posterior: as the trace has it, or of the answer that the plan carries."""
    if {"low", "high"} <= set(trace.columns):
        return grounds.within(trace.set_index("gait"))
    found = None if shown.answer is None else grounds.interval(shown.answer)
    return None if found is None else grounds.within(found)


def _branch_lines(trace: pd.DataFrame, most: int = 3) -> list[str]:
    """The chosen branch, and beside each of its nodes the next best alternatives."""
    value, unit, factor = value_column(trace.columns)
    if value is None or not {"chosen", "T"} <= set(trace.columns):
        return []
    lines = []
    for record in trace[trace["chosen"]].sort_values("T").to_dict("records"):
        indent = "  " * int(record["T"])
        lines.append(f"{indent}* {clean(record['gait']) or 'now'}  {factor * record[value]:.2f} {unit}".rstrip())
        rivals = trace[(trace["parent"] == record["parent"]) & ~trace["chosen"]]
        for rival in rivals.nsmallest(most, value).to_dict("records"):
            lines.append(f"{indent}  {clean(rival['gait'])}  {factor * rival[value]:.2f}")
    return lines


def tree(trace: pd.DataFrame) -> Html:
    """Return a search tree as nested folds, best children first, the chosen branch open and lit.

    trace: a Plan's, with columns node and parent.
    """
    records: list[Any] = trace.to_dict("records")
    children: dict[int, list[dict[str, Any]]] = {}
    for record in records:
        children.setdefault(int(record["parent"]), []).append(record)
    for family in children.values():
        family.sort(key=lambda r: (not r.get("chosen", False), _value(r)))
    budget = [MOST_NODES]
    roots = [_branch(record, children, budget) for record in children.get(-1, [])]
    note = None if len(records) <= MOST_NODES else f"{len(records)} nodes; the best of each family are shown."
    return tag("div", *roots, tag("div", note, class_="bh-note") if note else None, class_="bh-tree")


def _branch(record: dict[str, Any], children: dict[int, list[dict[str, Any]]], budget: list[int]) -> Html:
    budget[0] -= 1
    family = children.get(int(record["node"]), [])
    lit = "bh-lit" if record.get("chosen") else None
    if not family:
        return tag("div", tag("span", *_node(record), class_=lit), class_="bh-leaf")
    shown = [_branch(child, children, budget) for child in family[:MOST_CHILDREN] if budget[0] > 0]
    rest = len(family) - len(shown)
    more = tag("div", f"and {rest} worse", class_="bh-leaf bh-zero") if rest else None
    return tag("details", tag("summary", tag("span", *_node(record), class_=lit)), *shown, more, open=lit and True)


def _node(record: dict[str, Any]) -> list[Any]:
    """What one node says: its last gait, how deep, its value, when it was expanded."""
    gait = record.get("gait") or "now"
    words = []
    name, unit, factor = value_column(record)
    if name is not None:
        words.append(f"{number(factor * record[name])} {unit}".rstrip())
    if record.get("transition_cost"):
        words.append(f"{record['transition_cost']} change{'s' if record['transition_cost'] != 1 else ''} of gait")
    if record.get("expansion", -1) >= 0:
        words.append(f"expanded {record['expansion'] + 1}.")
    step = f"{record['T']}. " if record.get("T") else ""
    return [f"{step}{gait}", tag("span", ", ".join(words), class_="bh-value")]


def _value(record: dict[str, Any]) -> float:
    name, _, _ = value_column(record)
    value = 0.0 if name is None else float(record[name])
    return math.inf if math.isnan(value) else value


def value_column(columns: Any) -> tuple[str | None, str, float]:
    """Return which column of a trace holds the value of a node, the unit to show it in, and how many of it one is.

    (None, "", 1.0) if no column does.
    """
    return next((found for found in _VALUES if found[0] in columns), (None, "", 1.0))


def episode(shown: Episode) -> Sheet:
    """Return how a hunt went: its outcome, both paths, a row per decision."""
    origin = shown.provenance
    ending = f"caught after {shown.time:.2f} s" if shown.caught else f"not caught in {shown.time:g} s"
    ending += f"; {shown.spent}" if shown.spent else ""
    pairs: list[tuple[str, Any]] = [
        (name, _plain(origin[name])) for name in ("planner", "arena", "theta", "seed") if name in origin
    ]
    changes = int((shown.frame["gait"].to_numpy()[1:] != shown.frame["gait"].to_numpy()[:-1]).sum())
    pairs += [("decisions", len(shown.frame)), ("changes of gait", changes)]
    what = objective(0.0, shown.frame["objective"].iloc[0])[1] if len(shown.frame) else ""
    decisions = _decisions(shown)
    sure = " (95 % interval)" if any(" (" in row[5] for row in decisions.rows) else ""
    note = Note(f"value: {what}{sure}; moves: prey transitions learned before the decision")
    where = f"settings {origin.get('settings', {}).get('name', 'unknown')!r}"
    return Sheet(
        f"Hunt: {ending}",
        where,
        pairs,
        [Drawn(lambda: maps.episode_map(shown), decisions, beside=True), Printed(decisions.lines), note],
    )


def _decisions(shown: Episode) -> Table:
    rows = [
        [
            r["step"], f"{r['time']:.1f}", f"{r['seen_distance'] * 1000:.0f}", degrees(r["seen_angle"]), r["gait"],
            f"{objective(r['value'], r['objective'])[0]:.3g}{within}", r["prey_observations"],
        ]
        for r, within in zip(shown.frame.to_dict("records"), grounds.value_within(shown), strict=True)
    ]  # fmt: skip
    columns = ["step", "time [s]", "prey at [mm]", "bearing", "gait", "value", "moves"]
    return Table(columns, rows, words=frozenset({4}), most=len(rows))


def frame_table(frame: pd.DataFrame) -> Table:
    """Return a table as it is, its chosen rows on top and lit; at most 200 rows."""
    columns = [str(c) for c in frame.columns]
    if "chosen" in columns:
        frame = frame.sort_values("chosen", ascending=False, kind="stable")
    records = frame.head(_MOST_ROWS).to_dict("records")
    rows = [["-" if v is pd.NA else number(v) if isinstance(v, float) else str(v) for v in r.values()] for r in records]
    rest = len(frame) - len(rows)
    lit = frozenset(i for i, record in enumerate(records) if record.get("chosen", False))
    return Table(columns, rows, lit, left_out=f"and {rest} more rows" if rest else "")


def _runs(gaits: tuple[str, ...]) -> str:
    """A gait sequence, run by run: "left x3, straight x2"."""
    runs: list[tuple[str, int]] = []
    for gait in gaits:
        if runs and runs[-1][0] == gait:
            runs[-1] = (gait, runs[-1][1] + 1)
        else:
            runs.append((gait, 1))
    return ", ".join(f"{gait} x{count}" for gait, count in runs)


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
