"""Export to XMLBIF 0.3, which pgmpy, pyAgrum, JavaBayes, GeNIe and others read.

XMLBIF state names may hold only letters, digits and underscores; bin labels such as "-30 deg" do
not survive (they would collide with "30 deg"). States are therefore called g00, d000, a00, h00, ...
and ``<path>.labels.json`` says what each of them is.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.files.atomic import check_path, write_text

if TYPE_CHECKING:
    from bayeshunt.models.body.forward import ForwardModel

#: First letter of the states of each variable.
LETTERS = {"PreviousGait": "p", "Gait": "g", "Distance": "d", "Angle": "a", "Heading": "h"}


def safe_labels(model: ForwardModel) -> dict[str, dict[str, str]]:
    """Return, per variable, safe state name -> the model's own label, both in table order."""
    return {
        variable: {f"{LETTERS[variable]}{i:0{len(str(len(labels) - 1))}d}": label for i, label in enumerate(labels)}
        for variable, labels in model.states.items()
    }


def labels_path(path: str | os.PathLike[str]) -> Path:
    """Return where the label map of an export at ``path`` lies."""
    return Path(check_path(path, "the name of a file", InputError) + ".labels.json")


def write(model: ForwardModel, path: str | os.PathLike[str]) -> None:
    """Write the network at ``path`` and its label map at ``<path>.labels.json``, each atomically.

    Probabilities are written in full precision. A column whose parents were never seen together, so
    that it cannot be reached, is written as a uniform one, as pgmpy's own estimator gives it.

    Raises BayesHuntError if a file cannot be written.
    """
    labels = safe_labels(model)
    root = ElementTree.Element("BIF", VERSION="0.3")
    body = ElementTree.SubElement(root, "NETWORK")
    ElementTree.SubElement(body, "NAME").text = "bayeshunt"
    for variable, names in labels.items():
        _add_variable(body, variable, names)
    for variable, table in model.local_tables.items():
        _add_table(body, variable, model.structure.parents(variable), table)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    write_text(labels_path(path), json.dumps(labels, indent=1) + "\n")
    write_text(path, f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n')


def _add_variable(body: ElementTree.Element, variable: str, names: Iterable[str]) -> None:
    element = ElementTree.SubElement(body, "VARIABLE", TYPE="nature")
    ElementTree.SubElement(element, "NAME").text = variable
    for name in names:
        ElementTree.SubElement(element, "OUTCOME").text = name


def _add_table(body: ElementTree.Element, variable: str, parents: tuple[str, ...], table: np.ndarray) -> None:
    """Add P(variable | parents) [K, ...parents]: the variable itself varies fastest, as XMLBIF has it."""
    element = ElementTree.SubElement(body, "DEFINITION")
    ElementTree.SubElement(element, "FOR").text = variable
    for parent in parents:
        ElementTree.SubElement(element, "GIVEN").text = parent
    filled = np.where(table.any(axis=0), table, 1.0 / len(table))
    values = np.moveaxis(filled, 0, -1).ravel().tolist()
    ElementTree.SubElement(element, "TABLE").text = " ".join(map(repr, values))
