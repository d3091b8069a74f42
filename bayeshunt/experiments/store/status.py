"""How far an evaluation is, read from its results folder while it runs or afterwards."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from typing import Any, NamedTuple

from bayeshunt.core.errors import ResultsError
from bayeshunt.experiments.store.database import DATABASE_FILE, HuntDatabase
from bayeshunt.files.locks import is_locked

__all__ = ["Share", "Status", "status"]

_RECENT = 500  # hunts over which the rate is taken


class Share(NamedTuple):
    """One planner in one arena: hunts ended, hunts planned, prey caught."""

    planner: str
    arena: str
    ended: int
    planned: int
    caught: int


class Status(NamedTuple):
    """Progress of one evaluation.

    running: a process is at work in the folder now; process, host: the last one that was.
    rate: hunts per second over the last hunts, None if nobody is at work or it is too early to say.
    seconds_left: at that rate, None likewise. hash: the experiment's settings hash.
    """

    experiment: str
    ended: int
    planned: int
    running: bool
    process: int | None
    host: str | None
    rate: float | None
    seconds_left: float | None
    hash: str
    shares: tuple[Share, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        return {**self._asdict(), "shares": [share._asdict() for share in self.shares]}


def status(folder: str | os.PathLike[str]) -> Status:
    """Return how far the evaluation in ``folder`` is.

    Raises ResultsError if there is none or its database is damaged.
    """
    path = Path(folder)
    running = is_locked(path)
    database = HuntDatabase.open(path, read_only=True)
    if database is None:
        line = f"bayeshunt evaluate --out {shlex.quote(str(path))}"
        raise ResultsError(f"{path}: no {DATABASE_FILE} here; start one with: {line}")
    with database:
        identity = database.identity
        protocol = identity.settings["protocol"]
        each = len(protocol["thetas"]) * protocol["runs"]
        found = {(planner, arena): (ended, caught) for planner, arena, ended, caught in database.counts()}
        shares = tuple(
            Share(planner, arena, ended, each, caught)
            for arena in identity.arenas
            for planner in identity.planners
            for ended, caught in [found.get((planner, arena), (0, 0))]
        )
        ended, planned = sum(share.ended for share in shares), each * len(shares)
        rate = _rate(database.recent(_RECENT)) if running else None
        session = database.session()
        return Status(
            identity.settings["name"], ended, planned, running,
            session.process if session else None, session.host if session else None,
            rate, (planned - ended) / rate if rate else None, identity.hash, shares,
        )  # fmt: skip


def _rate(moments: list[float]) -> float | None:
    """Hunts per second from the moments [s] at which hunts ended."""
    span = moments[-1] - moments[0] if len(moments) > 1 else 0.0
    return (len(moments) - 1) / span if span > 0 else None
