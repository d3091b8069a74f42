"""Every alternative that a decision considered, as lists that an episode keeps: what its plan's trace says of each."""

from __future__ import annotations

import re
from typing import Any

import pandas as pd

from bayeshunt.planners.api import Plan

__all__ = ["considered", "first_gaits"]

#: Names that traces give to the value of a node and to where it ends [m, m, rad clockwise], in order of preference.
_VALUES = ("value_m", "value_s", "value", "posterior")
_ENDS = ("hunter", "end")


def considered(plan: Plan) -> dict[str, list[Any] | None]:
    """Return the nodes of ``plan.trace`` in its order, as columns ``considered_*`` of lists [N]; None without gaits.

    gait: the last gait of a node that has a parent, "" for the root; the whole sequence where the trace is no tree.
    parent: number of the parent's node, -1 where there is none. value: as the trace has it.
    forward, right, heading: where the hunter then is expected, as it sees it now.
    value, forward, right, heading are None as a whole where the trace has no such column.
    chosen: whether the node is on the chosen branch.
    """
    trace = plan.trace
    names = ("gait", "parent", "value", "forward", "right", "heading", "chosen")
    if "gait" not in trace:
        return {f"considered_{name}": None for name in names}
    columns = set(trace.columns)
    tree = {"node", "parent"} <= columns
    place = {int(node): at for at, node in enumerate(trace["node"])} if tree else {}
    value = next((name for name in _VALUES if name in columns), None)
    chosen = trace["chosen"] if "chosen" in columns else trace["gait"] == plan.gait
    found: dict[str, list[Any] | None] = {
        "gait": [str(gait) for gait in trace["gaits" if "gaits" in columns and not tree else "gait"]],
        "parent": [place.get(int(parent), -1) for parent in trace["parent"]] if tree else [-1] * len(trace),
        "value": None if value is None else trace[value].to_numpy(dtype=float).tolist(),
        "chosen": [bool(flag) for flag in chosen],
    }
    for part in ("forward", "right", "heading"):
        name = next((f"{who}_{part}" for who in _ENDS if f"{who}_{part}" in columns), None)
        found[part] = None if name is None else trace[name].to_numpy(dtype=float).tolist()
    return {f"considered_{name}": found[name] for name in names}


def first_gaits(trace: pd.DataFrame) -> list[str | None]:
    """Return the first gait of the sequence in each row of a plan's trace; None for the empty sequence."""
    gaits = trace["gait"].tolist()
    if {"node", "parent", "T"} <= set(trace.columns):
        first: dict[int, str | None] = {}
        for node, parent, steps, gait in zip(trace["node"], trace["parent"], trace["T"], gaits, strict=True):
            first[node] = None if steps == 0 else gait if steps == 1 else first[parent]
        return list(first.values())
    if "gaits" in trace:  # sequences written run by run: "straight x3, wide left x1"
        return [re.split(r" x\d+(?:, |$)", text, maxsplit=1)[0] or None for text in trace["gaits"]]
    return gaits
