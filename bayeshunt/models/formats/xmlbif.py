"""Export to XMLBIF 0.3, which pgmpy, pyAgrum, JavaBayes, GeNIe and others read.

XMLBIF state names may hold only letters, digits and underscores; bin labels such as "-30 deg" do
not survive (they would collide with "30 deg"). States are therefore called wide_right, mm160_165,
deg_minus30, ... and ``<path>.labels.json`` says what each of them is.
"""

from __future__ import annotations

import json
import os
import re
import unicodedata
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Protocol
from xml.etree import ElementTree

import numpy as np

from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.errors import InputError
from bayeshunt.files.atomic import check_path, write_text
from bayeshunt.files.endings import check_ending
from bayeshunt.models.tables.structures import Structure

__all__ = ["Exported", "labels_path", "safe_labels", "write"]


class Exported(Protocol):
    """What an export is made of; a forward model has it."""

    @property
    def structure(self) -> Structure:
        """The edges."""

    @property
    def states(self) -> Mapping[str, list[str]]:
        """Names of the states of each variable, in table order."""

    @property
    def local_tables(self) -> Mapping[str, np.ndarray]:
        """P(variable | parents) [K, ...parents] of each variable."""


def safe_labels(model: Exported) -> dict[str, dict[str, str]]:
    """Return, per variable, safe state name -> the model's own label, both in table order."""
    return {variable: _safe(variable, labels) for variable, labels in model.states.items()}


def _safe(variable: str, labels: Iterable[str]) -> dict[str, str]:
    """Safe name -> label of the states of one variable; a name that is taken gets a number."""
    names: dict[str, str] = {}
    for label in labels:
        token = _bin_token(label) if variable in (*EFFECTS, ENERGY) else _token(label)
        number = 2
        name = token
        while name in names:
            name, number = f"{token}_{number}", number + 1
        names[name] = label
    return names


def _token(text: str) -> str:
    """Letters, digits and underscores that read like ``text`` and begin with a letter."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    token = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    return token if token[:1].isalpha() else f"gait_{token}".rstrip("_")


def _bin_token(label: str) -> str:
    """A bin: "160-165.3 mm" -> mm160_165p3, "-30 deg" -> deg_minus30."""
    values, _, unit = label.partition(" ")
    low = re.sub("^-", "_minus", values)
    return unit + low.replace("-", "_").replace(".", "p")


def labels_path(path: str | os.PathLike[str]) -> Path:
    """Return where the label map of an export at ``path`` lies."""
    return Path(check_path(path, "the name of a file", InputError) + ".labels.json")


def write(model: Exported, path: str | os.PathLike[str]) -> None:
    """Write the network at ``path`` and its label map at ``<path>.labels.json``, each atomically.

    Probabilities are written in full precision. A column whose parents were never seen together, so
    that it cannot be reached, is written as a uniform one, as pgmpy's own estimator gives it.

    Raises BayesHuntError if a file cannot be written.
    """
    check_ending(path, "networks", ".xmlbif")
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
