"""The moments of a run as plain numbers, read from Box2D as they come and told as poses when somebody asks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, overload

from bayeshunt.core.geometry import Pose, wrap
from bayeshunt.core.messages import Moment

__all__ = ["Trail"]


class Trail(Sequence[Moment]):
    """A sequence of moments, one for every :meth:`note`."""

    __slots__ = ("_last", "_names", "_rows", "_step", "_unit", "note")

    def __init__(self, names: Iterable[str], unit: float, step: float) -> None:
        """names: of the bodies. unit: metres per Box2D unit. step: seconds of a physics step."""
        self._names, self._unit, self._step = tuple(names), unit, step
        self._rows: list[tuple[int, list[float]]] = []
        self._last: tuple[Any, Any] = (None, None)  # a row that was asked for, and its moment
        #: Adds a moment: the physics steps since the reset, and x, y [Box2D units] and angle [rad, not wrapped] of one
        #: body after the other. A list's own method: it runs often.
        self.note: Callable[[tuple[int, list[float]]], None] = self._rows.append

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> Moment: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Moment]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self._moment(row) for row in self._rows[index]]
        row = self._rows[index]
        if row is not self._last[0]:  # the last moment is asked for by the hunt, the sensor and the record
            self._last = row, self._moment(row)
        return self._last[1]

    def _moment(self, row: tuple[int, list[float]]) -> Moment:
        steps, places = row
        unit = self._unit
        poses, at = {}, 0
        for name in self._names:
            poses[name] = Pose(places[at] * unit, places[at + 1] * unit, wrap(places[at + 2]))
            at += 3
        return Moment(steps * self._step, poses)
