"""Networks in from XMLBIF 0.3 or BIF, as other programs write them."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.core.arguments import checked_but
from bayeshunt.core.bins import EFFECTS, ENERGY, Axis, EffectAxes
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.files.atomic import check_path
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.formats import bif, xmlbif, xmlbif_reader
from bayeshunt.models.formats.network_tables import NetworkTables, duplicate, few
from bayeshunt.models.tables import network
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, PREVIOUS_GAIT, Structure, depends_on_previous

__all__ = ["KINDS", "is_network", "open_model", "read_network", "read_tables"]

#: Endings of the files that :func:`read_network` reads.
KINDS = (".xml", ".xmlbif", ".bifxml", ".bif")


@checked_but("path")
def read_network(path: str | os.PathLike[str], gaits: Any = None, axes: EffectAxes | None = None) -> ForwardModel:
    """Read a network over Gait, Distance, Angle, Heading and perhaps PreviousGait from a file of another program.

    path: XMLBIF (``.xml``, ``.xmlbif``, ``.bifxml``) or BIF (``.bif``).
    gaits: the repertoire, names in the file's order or the same names; default: the file's names.
    axes: the bins, in the file's order of states; default: from the bin labels. State names are
        translated by ``<path>.labels.json`` if it is there, as our own exports have it.

    Any edges into Distance, Angle and Heading will do; from PreviousGait to all of them or none. There may be Energy,
    which depends on what causes the others.

    Raises InputError in one line for an unreadable file, other variables or edges, states that do not
    fit, or columns that do not sum to 1.
    """
    found, labels = _open(path)
    return _model(found, labels, gaits, axes, os.fspath(path))


def open_model(path: str | os.PathLike[str], gaits: GaitRepertoire | None = None) -> ForwardModel:
    """Read a forward model: a model file or, by its ending, a network of another program.

    gaits: the robot's; a network whose gaits have the same names takes their order and commands from it.

    Raises ModelFileError or InputError in one line.
    """
    if not is_network(path):
        return ForwardModel.load(path)
    found, labels = _open(path)
    same = gaits is not None and set(gaits.names) == set(labels["Gait"])
    return _model(found, labels, gaits if same else None, None, os.fspath(path))


def is_network(path: str | os.PathLike[str]) -> bool:
    """Return whether a file's name ends as those of networks do."""
    return Path(check_path(path, "the name of a model file or of a network", InputError)).suffix.lower() in KINDS


def _open(path: str | os.PathLike[str]) -> tuple[NetworkTables, dict[str, list[str]]]:
    """The network in a file, and the labels of its states in the file's order."""
    found, name = read_tables(path), os.fspath(path)
    _check_variables(found, name)
    return found, _labels(found, Path(path), name)


def _model(
    found: NetworkTables, labels: dict[str, list[str]], gaits: Any, axes: EffectAxes | None, name: str
) -> ForwardModel:
    repertoire = GaitRepertoire.of(labels["Gait"] if gaits is None else gaits)
    grid = axes if axes is not None else _axes(labels, name)
    order = {"Gait": _positions(labels["Gait"], repertoire.names, "Gait", name)}
    if (grid.energy is not None) != (ENERGY in labels):
        raise InputError(f"{name}: axes= and the file must both have {ENERGY}, or neither")
    order |= {axis.name: _positions(labels[axis.name], axis.labels, axis.name, name) for axis in grid.all}
    try:
        structure = Structure("learned", found.edges)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    known = (NAIVE, PREVIOUS_GAIT, NAIVE.with_energy(), PREVIOUS_GAIT.with_energy())
    structure = next((s for s in known if s.edges == structure.edges), structure)
    if depends_on_previous(structure) and structure.poses != PREVIOUS_GAIT:
        raise InputError(
            f"{name}: with {PREVIOUS} among the causes, it and Gait must be the parents of each of "
            f"{', '.join(EFFECTS)}, and nothing else"
        )
    if PREVIOUS in labels:
        order[PREVIOUS] = _positions(labels[PREVIOUS], repertoire.names, PREVIOUS, name)
    variables = (*structure.causes, *structure.effects)
    given = {variable: _table(found, variable, structure, order) for variable in variables}
    return ForwardModel.of_tables(repertoire, grid, structure, given)


def read_tables(path: str | os.PathLike[str]) -> NetworkTables:
    """Read a network over any variables, as its file has them. Raises InputError in one line."""
    name = check_path(path, f"the name of a network ({', '.join(KINDS)})", InputError)
    path = Path(path)
    kind = path.suffix.lower()
    if not path.is_file():
        raise InputError(f"{name}: {'is a folder' if path.is_dir() else 'no such file'}")
    if kind not in KINDS:
        raise InputError(f"{name}: unknown kind of network {kind!r}; expected one of {', '.join(KINDS)}")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{name}: cannot be read ({error.strerror or error})") from None
    return bif.read(data, name) if kind == ".bif" else xmlbif_reader.read(data, name)


def _check_variables(found: NetworkTables, name: str) -> None:
    variables = set(found.states)
    if variables - {PREVIOUS, ENERGY} != set(network.VARIABLES):
        expected = ", ".join(network.VARIABLES)
        raise InputError(
            f"{name}: the variables are {few(sorted(variables))}; expected exactly {expected} (and perhaps {PREVIOUS}, "
            f"{ENERGY})"
        )


def _labels(found: NetworkTables, path: Path, name: str) -> dict[str, list[str]]:
    """The states of every variable in the file's order, translated by the label map if there is one."""
    beside = xmlbif.labels_path(path)
    if not beside.is_file():
        return {variable: list(states) for variable, states in found.states.items()}
    try:
        known = json.loads(beside.read_text(encoding="utf-8-sig"), object_pairs_hook=_unambiguous)
        labels = {v: [str(known[v].get(s, s)) for s in states] for v, states in found.states.items()}
    except _TwiceError as error:
        raise InputError(f"{beside}: contradicts itself: {few([str(error)])} is there twice") from None
    except (OSError, ValueError, KeyError, AttributeError, TypeError, RecursionError):
        raise InputError(f"{beside}: not a label map of {name}; export again or remove it") from None
    for variable, names in labels.items():
        twice = duplicate(names)
        if twice is not None:
            both = [state for state, label in zip(found.states[variable], names, strict=True) if label == twice]
            raise InputError(f"{beside}: contradicts itself: {variable}: {few(both)} are all called {few([twice])!r}")
    return labels


class _TwiceError(Exception):
    """A name that stands twice in one object of a label map."""


def _unambiguous(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON whose names differ."""
    twice = duplicate(name for name, _ in pairs)
    if twice is not None:
        raise _TwiceError(twice)
    return dict(pairs)


def _axes(labels: dict[str, list[str]], name: str) -> EffectAxes:
    """The bins that the labels name."""
    distance = Axis.linear("Distance", _width(labels["Distance"], name), len(labels["Distance"]))
    turns = (Axis.full_turn(v, len(labels[v])) for v in ("Angle", "Heading"))
    energy = None
    if ENERGY in labels:
        energy = Axis.linear(ENERGY, _width(labels[ENERGY], name, "J"), len(labels[ENERGY]))
    axes = EffectAxes(distance, *turns, energy=energy)
    for axis in axes.all:
        if set(axis.labels) != set(labels[axis.name]):
            raise InputError(
                f"{name}: the states of {axis.name} ({labels[axis.name][0]!r}, ...) are not bin labels such as "
                f"{axis.labels[0]!r}; {_fix(name)}"
            )
    return axes


def _fix(name: str) -> str:
    """What to do where the states of a file are no bins."""
    return f"name them in a label map, {xmlbif.labels_path(name)}, or give axes= in Python"


def _width(labels: list[str], name: str, unit: str = "mm") -> float:
    """Bin width [m; J] from labels such as "0-5.7 mm", "5.7-11.4 mm"."""
    try:
        reach = max(float(label.removesuffix(f" {unit}").split("-")[1]) for label in labels)
        width = round(reach / len(labels), 9)  # labels are rounded
        return width if unit == "J" else width / 1000
    except (IndexError, ValueError):
        which = ENERGY if unit == "J" else "Distance"
        raise InputError(
            f"{name}: the states of {which} ({labels[0]!r}, ...) are not bins such as '0-5.7 {unit}'; {_fix(name)}"
        ) from None


def _positions(labels: list[str], wanted: tuple[str, ...], variable: str, name: str) -> list[int]:
    """Where each wanted state stands in the file: by name, or in order if the names are others.

    Names that are only partly ours must stand where ours do: a misspelt one would give them all other tables.
    """
    if len(labels) != len(wanted):
        raise InputError(f"{name}: {variable} has {len(labels)} states; expected {len(wanted)}")
    found, ours = ({label: place for place, label in enumerate(names)} for names in (labels, wanted))
    if found.keys() == ours.keys():
        return [found[label] for label in wanted]
    if any(ours.get(label, place) != place for place, label in enumerate(labels)):
        missing, extra = next(s for s in wanted if s not in found), next(s for s in labels if s not in ours)
        raise InputError(
            f"{name}: {variable}: the state {missing!r} is not in the file, which has {extra!r}, and the others stand "
            f"in another order there; give the names of the file"
        )
    return list(range(len(wanted)))


def _table(found: NetworkTables, variable: str, structure: Structure, order: dict[str, list[int]]) -> np.ndarray:
    """P(variable | parents) with states in our order and parents in alphabetical order; columns sum to 1."""
    axes, written = [variable, *structure.parents(variable)], [variable, *found.parents[variable]]
    values = np.transpose(found.tables[variable], [written.index(v) for v in axes])
    values = values[np.ix_(*(order[v] for v in axes))].copy()
    columns: np.ndarray = values / values.sum(axis=0)
    return columns
