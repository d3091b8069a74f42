"""Tables out as CSV; networks in from XMLBIF 0.3 or BIF, as other programs write them."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, Axis, EffectAxes
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.files.atomic import check_path, write_text
from bayeshunt.models.body.imported import ImportedModel
from bayeshunt.models.formats import xmlbif
from bayeshunt.models.tables import network
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, PREVIOUS_GAIT, Structure, depends_on_previous

if TYPE_CHECKING:
    from bayeshunt.models.body.forward import ForwardModel

#: Endings of the files that :func:`read_network` reads.
KINDS = (".xml", ".xmlbif", ".bifxml", ".bif")
#: Columns of a file may miss 1 by this much, since programs round what they write; they are rescaled.
_ROUNDING = 1e-3


def write_csv(model: ForwardModel, folder: str | os.PathLike[str]) -> list[Path]:
    """Write gait.csv, distance.csv, angle.csv and heading.csv into ``folder``; returns the paths.

    One row per cell: gait, bin, low and high (edges of the bin, m or rad; not in gait.csv),
    probability, count, ci_low and ci_high (95 % credible interval). An imported model has no counts:
    those three columns are empty; so are the intervals of a P(Gait) that is set to uniform. Numbers are
    written in full. Where the gait before is a cause, the
    effects' tables start with a column previous_gait.
    """
    place, paths = Path(check_path(folder, "the name of a folder", InputError)), []
    for variable in network.VARIABLES:
        path = place / f"{variable.lower()}.csv"
        write_text(path, cells(model, variable).to_csv(index=False, lineterminator="\n"))
        paths.append(path)
    return paths


def cells(model: ForwardModel, variable: str) -> pd.DataFrame:
    """Return a table as one row per cell, the columns of :func:`write_csv`; gaits vary slowest."""
    if depends_on_previous(model.structure) and variable != "Gait":
        parts = {name: _cells(model.after(name), variable) for name in model.gaits.names}
        return pd.concat(parts, names=["previous_gait"]).reset_index("previous_gait").reset_index(drop=True)
    return _cells(model, variable)


def _cells(model: ForwardModel, variable: str) -> pd.DataFrame:
    shown = model.table(variable)
    values = shown.probability.to_numpy()
    bins, columns = values.shape
    if variable == "Gait":
        frame = pd.DataFrame({"gait": shown.probability.index})
    else:
        axis = model.axes[variable]
        frame = pd.DataFrame({"gait": np.repeat(list(model.gaits.names), bins)})
        for name, part in (("bin", axis.labels), ("low", axis.edges[:-1]), ("high", axis.edges[1:])):
            frame[name] = np.tile(np.asarray(part), columns)
    frame["probability"] = values.T.ravel()
    counted = {"count": shown.count, "ci_low": shown.low, "ci_high": shown.high}
    for name, table in counted.items():
        frame[name] = None if table is None else table.to_numpy().T.ravel()
    return frame


def read_network(path: str | os.PathLike[str], gaits: Any = None, axes: EffectAxes | None = None) -> ImportedModel:
    """Read a network over Gait, Distance, Angle, Heading and perhaps PreviousGait from a file of another program.

    path: XMLBIF (``.xml``, ``.xmlbif``, ``.bifxml``) or BIF (``.bif``).
    gaits: the repertoire, names in the file's order or the same names; default: the file's names.
    axes: the bins, in the file's order of states; default: from the bin labels. State names are
        translated by ``<path>.labels.json`` if it is there, as our own exports have it.

    Any edges into Distance, Angle and Heading will do; from PreviousGait to all of them or none.

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
        from bayeshunt.models.body.forward import ForwardModel

        return ForwardModel.load(path)
    found, labels = _open(path)
    same = gaits is not None and set(gaits.names) == set(labels["Gait"])
    return _model(found, labels, gaits if same else None, None, os.fspath(path))


def is_network(path: str | os.PathLike[str]) -> bool:
    """Return whether a file's name ends as those of networks do."""
    return Path(check_path(path, "the name of a model file or of a network", InputError)).suffix.lower() in KINDS


def _open(path: str | os.PathLike[str]) -> tuple[Any, dict[str, list[str]]]:
    """The pgmpy network in a file, and the labels of its states in the file's order."""
    name = check_path(path, f"the name of a network ({', '.join(KINDS)})", InputError)
    found = _read(Path(path), name)
    _check_variables(found, name)
    return found, _labels(found, Path(path), name)


def _model(found: Any, labels: dict[str, list[str]], gaits: Any, axes: EffectAxes | None, name: str) -> ImportedModel:
    repertoire = GaitRepertoire.of(labels["Gait"] if gaits is None else gaits)
    grid = axes if axes is not None else _axes(labels, name)
    order = {"Gait": _positions(labels["Gait"], repertoire.names, "Gait", name)}
    order |= {axis.name: _positions(labels[axis.name], axis.labels, axis.name, name) for axis in grid}
    structure = Structure("learned", tuple(found.edges()))
    structure = next((s for s in (NAIVE, PREVIOUS_GAIT) if s.edges == structure.edges), structure)
    if depends_on_previous(structure) and structure is not PREVIOUS_GAIT:
        raise InputError(
            f"{name}: with {PREVIOUS} among the causes, it and Gait must be the parents of each of "
            f"{', '.join(EFFECTS)}, and nothing else"
        )
    if PREVIOUS in labels:
        order[PREVIOUS] = _positions(labels[PREVIOUS], repertoire.names, PREVIOUS, name)
    variables = (*structure.causes, *EFFECTS)
    given = {variable: _table(found, variable, structure, order, name) for variable in variables}
    return ImportedModel.of(repertoire, grid, structure, given)


def _read(path: Path, name: str) -> Any:
    """The pgmpy network in a file."""
    if not path.is_file():
        raise InputError(f"{name}: no such file")
    kind = path.suffix.lower()
    if kind not in KINDS:
        raise InputError(f"{name}: unknown kind of network {kind!r}; expected one of {', '.join(KINDS)}")
    from pgmpy.readwrite import BIFReader, XMLBIFReader

    try:
        reader = (BIFReader if kind == ".bif" else XMLBIFReader)(str(path))
        return reader.get_model()
    except Exception as error:  # a parser's many ways to fail are one fact to the user
        reason = (str(error).splitlines() or [type(error).__name__])[0][:120]
        raise InputError(f"{name}: not a readable {kind[1:].upper()} network ({reason})") from None


def _check_variables(found: Any, name: str) -> None:
    variables = set(found.nodes())
    if variables - {PREVIOUS} != set(network.VARIABLES):
        got = ", ".join(sorted(map(str, variables)))
        expected = ", ".join(network.VARIABLES)
        raise InputError(f"{name}: the variables are {got}; expected exactly {expected} (and perhaps {PREVIOUS})")


def _labels(found: Any, path: Path, name: str) -> dict[str, list[str]]:
    """The states of every variable in the file's order, translated by the label map if there is one."""
    states = {v: [str(s) for s in found.get_cpds(v).state_names[v]] for v in sorted(found.nodes())}
    beside = xmlbif.labels_path(path)
    if not beside.is_file():
        return states
    try:
        known = json.loads(beside.read_text(encoding="utf-8"))
        return {v: [str(known[v].get(s, s)) for s in names] for v, names in states.items()}
    except (OSError, ValueError, KeyError, AttributeError, TypeError):
        raise InputError(f"{beside}: not a label map of {name}; export again or remove it") from None


def _axes(labels: dict[str, list[str]], name: str) -> EffectAxes:
    """The bins that the labels name."""
    distance = Axis.linear("Distance", _width(labels["Distance"], name), len(labels["Distance"]))
    turns = (Axis.full_turn(v, len(labels[v])) for v in ("Angle", "Heading"))
    axes = EffectAxes(distance, *turns)
    for axis in axes:
        if set(axis.labels) != set(labels[axis.name]):
            raise InputError(
                f"{name}: the states of {axis.name} ({labels[axis.name][0]!r}, ...) are not bin labels such as "
                f"{axis.labels[0]!r}; {_mend(name)}"
            )
    return axes


def _mend(name: str) -> str:
    """What to do where the states of a file are no bins."""
    return f"name them in a label map, {xmlbif.labels_path(name)}, or give axes= in Python"


def _width(labels: list[str], name: str) -> float:
    """Bin width [m] from labels such as "0-5.7 mm", "5.7-11.4 mm"."""
    try:
        reach = max(float(label.removesuffix(" mm").split("-")[1]) for label in labels)
        return round(reach / len(labels), 9) / 1000  # labels are in millimetres, rounded
    except (IndexError, ValueError):
        raise InputError(
            f"{name}: the states of Distance ({labels[0]!r}, ...) are not bins such as '0-5.7 mm'; {_mend(name)}"
        ) from None


def _positions(labels: list[str], wanted: tuple[str, ...], variable: str, name: str) -> list[int]:
    """Where each wanted state stands in the file: by name, or in order if the names are others.

    Names that are only partly ours must stand where ours do: a misspelt one would give them all other tables.
    """
    if len(labels) != len(wanted):
        raise InputError(f"{name}: {variable} has {len(labels)} states; expected {len(wanted)}")
    if set(labels) == set(wanted):
        return [labels.index(label) for label in wanted]
    if any(label in wanted and wanted.index(label) != place for place, label in enumerate(labels)):
        ours, theirs = (next(s for s in one if s not in other) for one, other in ((wanted, labels), (labels, wanted)))
        raise InputError(
            f"{name}: {variable}: the state {ours!r} is not in the file, which has {theirs!r}, and the others stand "
            f"in another order there; give the names of the file"
        )
    return list(range(len(wanted)))


def _table(found: Any, variable: str, structure: Structure, order: dict[str, list[int]], name: str) -> np.ndarray:
    """P(variable | parents) with states in our order and parents in alphabetical order."""
    cpd = found.get_cpds(variable)
    axes = [variable, *structure.parents(variable)]
    values = np.transpose(cpd.values, [cpd.variables.index(v) for v in axes])
    values = np.array(values[np.ix_(*(order[v] for v in axes))], dtype=float)
    totals = values.sum(axis=0)
    if not np.all(values >= 0) or not np.all(np.abs(totals - 1) <= _ROUNDING):
        raise InputError(f"{name}: the table of {variable} has a column that is not a distribution")
    return values / totals
