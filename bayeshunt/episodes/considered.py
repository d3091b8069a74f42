"""Every alternative that a decision considered, as lists that an episode keeps: what its plan's trace says of each."""

from __future__ import annotations

from typing import Any

from bayeshunt.planners.api import Plan

__all__ = ["considered"]

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
