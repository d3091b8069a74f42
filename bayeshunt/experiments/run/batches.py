"""What a worker does: a batch of hunts of one planner, each committed as it ends."""

from __future__ import annotations

import contextlib
import os
import uuid
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.episodes.loop import Result, run_hunt
from bayeshunt.experiments.preparation import prepare_planner
from bayeshunt.experiments.protocol import HuntTask
from bayeshunt.experiments.run import workers
from bayeshunt.experiments.run.plugins import Additions
from bayeshunt.experiments.store.database import Numbered, Sink
from bayeshunt.experiments.store.identity import versions
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Planner
from bayeshunt.planners.registry import explores

__all__ = ["Ticket", "batches", "run_batch"]

_BATCH = 20  # hunts handed to a worker at a time


def batches(hunts: Sequence[Numbered]) -> Iterator[list[Numbered]]:
    """Cut the hunts into batches that share a planner and an arena."""
    for _, group in groupby(hunts, key=lambda hunt: (hunt.task.planner, hunt.task.arena)):
        some = list(group)
        yield from (some[i : i + _BATCH] for i in range(0, len(some), _BATCH))


class Ticket(NamedTuple):
    """One evaluation: the process that asks, a name that no other has, what it has registered, where it stands."""

    process: int
    name: str
    additions: Additions
    folder: str

    @classmethod
    def new(cls) -> Ticket:
        """Return a ticket of this process."""
        return cls(os.getpid(), uuid.uuid4().hex, Additions.here(), str(Path.cwd()))


def run_batch(
    settings: ExperimentSettings, model: ForwardModel, rooms: dict[str, RoomModel], sink: Sink | None,
    expected: dict[str, str], ticket: Ticket, hunts: Sequence[Numbered],
) -> list[tuple[Numbered, Result]]:  # fmt: skip
    """Run hunts of one planner in one arena one after the other, each committed to ``sink`` as it ends.

    rooms: of the arenas, for planners that explore.
    expected: versions of the libraries that this worker must have. ticket: of the evaluation.
    """
    workers.guard_worker(ticket.process)
    workers.stand_in(ticket.folder, ticket.process)
    workers.check_worker_versions(expected, versions())
    ticket.additions.adopt()
    planner = _mind(ticket, hunts[0].task, model, settings, rooms)
    pairs = []
    with sink.opened() if sink is not None else contextlib.nullcontext() as writer:
        for hunt in hunts:
            result = run_hunt(settings, planner, hunt.task.arena, hunt.task.theta, hunt.task.seed)
            result = Result(bool(result.caught), *map(_plain, result[1:]))
            if writer is not None:
                writer.add(hunt, result)
            pairs.append((hunt, result))
    return pairs


_minds: dict[tuple[str, str, str], Planner] = {}


def _mind(
    ticket: Ticket, task: HuntTask, model: ForwardModel, settings: ExperimentSettings, rooms: dict[str, RoomModel]
) -> Planner:
    """Return the planner of an evaluation, made once per process: making one costs as much as some hunts."""
    arena = task.arena if explores(task.planner) else ""
    key = (ticket.name, task.planner, arena)
    if key not in _minds:
        for other in [known for known in _minds if known[0] != ticket.name]:
            del _minds[other]
        _minds[key] = prepare_planner(task.planner, model, settings, rooms, task.arena)
    return _minds[key]


def _plain(value: Any) -> Any:
    """A Python number, as the database gives it back."""
    return value.item() if isinstance(value, np.generic) else value
