"""The moments of a run as plain numbers, read from Box2D as they come and told as poses when somebody asks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, overload

from bayeshunt.core.geometry import Pose, wrap
from bayeshunt.core.messages import Moment

__all__ = ["Place", "Trail"]

#: x, y [Box2D units] and angle [rad, not wrapped] of a body.
Place = tuple[float, float, float]


class Trail(Sequence[Moment]):
    """A sequence of moments, one for every :meth:`note`."""

    __slots__ = ("_add", "_names", "_rows", "_step", "_unit")

    def __init__(self, names: Iterable[str], unit: float, step: float) -> None:
        """names: of the bodies. unit: metres per Box2D unit. step: seconds of a physics step."""
        self._names, self._unit, self._step = tuple(names), unit, step
        self._rows: list[tuple[int, list[Place]]] = []
        self._add = self._rows.append

    def note(self, steps: int, places: list[Place]) -> None:
        """Add the moment of ``steps`` physics steps after the reset."""
        self._add((steps, places))

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> Moment: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Moment]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self._moment(row) for row in self._rows[index]]
        return self._moment(self._rows[index])

    def _moment(self, row: tuple[int, list[Place]]) -> Moment:
        steps, places = row
        unit = self._unit
        poses = {
            name: Pose(x * unit, y * unit, wrap(float(angle)))
            for name, (x, y, angle) in zip(self._names, places, strict=True)
        }
        return Moment(steps * self._step, poses)
