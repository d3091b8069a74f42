"""The moments of a run as plain numbers, read from Box2D as they come and told as poses when somebody asks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, overload

from bayeshunt.core.geometry import Pose, wrap
from bayeshunt.core.messages import Moment

__all__ = ["Trail"]


class Trail(Sequence[Moment]):
    """A sequence of moments, one for every number in ``steps``; whoever runs the bodies fills the two lists.

    steps: physics steps since the reset. places: x, y [Box2D units] and angle [rad, not wrapped] of one body after the
    other, moment after moment. Two lists of numbers and nothing else: a run is kept until somebody looks at it, and
    Python's garbage collector looks at every list there is.
    """

    __slots__ = ("_last", "_names", "_step", "_unit", "places", "steps")

    def __init__(self, names: Iterable[str], unit: float, step: float) -> None:
        """names: of the bodies. unit: metres per Box2D unit. step: seconds of a physics step."""
        self._names, self._unit, self._step = tuple(names), unit, step
        self.steps: list[int] = []
        self.places: list[float] = []
        self._last: tuple[int, Any] = (-1, None)  # the steps of a moment that was asked for, and it

    def __len__(self) -> int:
        return len(self.steps)

    @overload
    def __getitem__(self, index: int) -> Moment: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Moment]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self._moment(number) for number in range(len(self.steps))[index]]
        steps = self.steps[index]
        if steps != self._last[0]:  # the last moment is asked for by the hunt, the sensor and the record
            self._last = steps, self._moment(index % len(self.steps))
        return self._last[1]

    def _moment(self, number: int) -> Moment:
        unit, places = self._unit, self.places
        poses, at = {}, 3 * len(self._names) * number
        for name in self._names:
            poses[name] = Pose(places[at] * unit, places[at + 1] * unit, wrap(places[at + 2]))
            at += 3
        return Moment(self.steps[number] * self._step, poses)
