"""doctor: what is installed, whether it works, and what a bug report needs."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json
from bayeshunt.core.errors import BayesHuntError

__all__ = ["Need", "doctor", "needs", "self_test"]

_REQUIREMENT = re.compile(
    r"^(?P<name>[\w.-]+)(?:\[[^\]]*\])?\s*(?P<range>[^;]*?)\s*(?:;.*extra\s*==\s*['\"](?P<extra>\w+)['\"].*)?$"
)
#: Extras for those who work on the project itself.
_OWN = ("test", "docs")
_REPORT = "A bug report: this page, the line that you typed, what it printed, and the smallest file that shows it."


class Need(NamedTuple):
    """A package that is needed: by an extra, or always ("").

    range: versions that may serve. version: the one installed, None where there is none.
    """

    name: str
    range: str
    extra: str
    version: str | None


def needs() -> Iterator[Need]:
    """Yield every package that the installed bayeshunt names, extras for its own developers left out."""
    from importlib import metadata

    for line in metadata.requires("bayeshunt") or ():
        found = _REQUIREMENT.match(line)
        if found is None or (found["extra"] or "") in _OWN:
            continue
        try:
            version = metadata.version(found["name"])
        except metadata.PackageNotFoundError:
            version = None
        yield Need(found["name"], found["range"].strip("() "), found["extra"] or "", version)


def self_test() -> Iterator[tuple[str, float, str | None]]:
    """Yield what was tried, the seconds that it took, and what went wrong, None if nothing did."""
    made: dict[str, Any] = {}
    for name, step in _STEPS:
        began = time.perf_counter()
        wrong = None
        try:
            step(made)
        except Exception as error:  # whatever it is: this is what the doctor is asked about
            wrong = f"{type(error).__name__}: {' '.join(str(error).split())}"
        yield name, time.perf_counter() - began, wrong
        if wrong is not None:
            return


def _babble(made: dict[str, Any]) -> None:
    from bayeshunt.config.loading import load_robot
    from bayeshunt.worlds.babbling import babble

    made["robot"] = load_robot("khepera")
    made["frame"] = babble(made["robot"], 400, seed=0)


def _fit(made: dict[str, Any]) -> None:
    from bayeshunt.models.body.forward import ForwardModel

    made["model"] = ForwardModel.fit(made["frame"], made["robot"].gaits)
    columns = made["model"].cpt("Distance").sum()
    if abs(columns - 1).max() > 1e-9:
        raise ArithmeticError(f"columns of P(Distance | Gait) sum to {columns.min()} to {columns.max()}")


def _ask(made: dict[str, Any]) -> None:
    from bayeshunt.models.body.inverse import InverseModel

    best = InverseModel(made["model"]).posterior(distance=0.16, angle=0.5).best
    if best != "wide right":
        raise ArithmeticError(f"160 mm away, 29° to the right: expected 'wide right', got {best!r}")


def _hunt(made: dict[str, Any]) -> None:
    from bayeshunt.episodes.loop import hunt
    from bayeshunt.planners.registry import make_planner

    episode = hunt("paper", make_planner("planning", made["model"]), arena="walled", theta=1.0, seed=0)
    if not episode.caught:
        raise ArithmeticError("a hunt that should end with a catch did not")


#: What the self-test does, in order; each step finds what those before have made.
_STEPS: tuple[tuple[str, Callable[[dict[str, Any]], None]], ...] = (
    ("babble 400 gaits (Box2D)", _babble),
    ("fit the network (pgmpy)", _fit),
    ("ask it backwards", _ask),
    ("one hunt", _hunt),
)


@app.command(short_help="Check the installation; what to send with a bug report.")
def doctor(as_json: Json = False) -> None:
    """Say which versions and extras are installed, try the whole way in some five seconds, and say what a bug report
    needs.

    Exits with 1 if something needed is missing or a step fails.

    Example:  bayeshunt doctor;  bayeshunt doctor --json > doctor.json
    """
    import platform
    from importlib import metadata

    found = list(needs())
    tried = list(self_test())
    missing = [need.name for need in found if not need.extra and need.version is None]
    failed = [f"{name}: {wrong}" for name, _, wrong in tried if wrong is not None]
    facts = {
        "bayeshunt": metadata.version("bayeshunt"), "python": platform.python_version(),
        "system": platform.platform(), "packages": {n.name: n.version for n in found if not n.extra},
        "extras": _extras(found), "self_test": [{"step": s, "seconds": round(t, 2), "error": w} for s, t, w in tried],
    }  # fmt: skip
    typer.echo(json.dumps(facts) if as_json else _page(facts, {need.name: need.range for need in found}))
    if missing or failed:
        raise BayesHuntError("; ".join([*(f"{name} is not installed" for name in missing), *failed]))


def _extras(found: list[Need]) -> dict[str, list[str]]:
    """Packages that each extra lacks."""
    extras: dict[str, list[str]] = {need.extra: [] for need in found if need.extra}
    for need in found:
        if need.extra and need.version is None:
            extras[need.extra].append(need.name)
    return extras


def _page(facts: dict[str, Any], ranges: dict[str, str]) -> str:
    """The facts as a page of text; ranges: versions that may serve, by package."""
    lines = [f"bayeshunt {facts['bayeshunt']}, Python {facts['python']}, {facts['system']}", ""]
    lines += [f"  {name:<18} {version or 'MISSING':<12} {ranges[name]}" for name, version in facts["packages"].items()]
    lines += ["", 'Extras, each installed by  pip install ".[NAME]"  in the project\'s folder']
    lines += [
        f"  {name:<18} {'lacks ' + ', '.join(lacks) if lacks else 'ready'}" for name, lacks in facts["extras"].items()
    ]
    lines += ["", "Self-test"]
    for step in facts["self_test"]:
        lines.append(f"  {step['step']:<26} {step['seconds']:5.2f} s  {step['error'] or 'ok'}")
    return "\n".join([*lines, "", _REPORT])
