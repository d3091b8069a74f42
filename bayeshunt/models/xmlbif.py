"""Export to XMLBIF 0.3, which pgmpy, pyAgrum, JavaBayes, GeNIe and others read.

XMLBIF state names may hold only letters, digits and underscores; bin labels such as "-30 deg" do
not survive (they would collide with "30 deg"). States are therefore called g00, d000, a00, h00, ...
and ``<path>.labels.json`` says what each of them is.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

from bayeshunt.files import write_text
from bayeshunt.models import network

if TYPE_CHECKING:
    from bayeshunt.models.forward import ForwardModel

#: First letter of the states of each variable.
LETTERS = {"Gait": "g", "Distance": "d", "Angle": "a", "Heading": "h"}


def safe_labels(model: ForwardModel) -> dict[str, dict[str, str]]:
    """Return, per variable, safe state name -> the model's own label, both in table order."""
    return {
        variable: {f"{LETTERS[variable]}{i:0{len(str(len(labels) - 1))}d}": label for i, label in enumerate(labels)}
        for variable, labels in network.state_names(model.gaits, model.axes).items()
    }


def labels_path(path: str | os.PathLike[str]) -> Path:
    """Return where the label map of an export at ``path`` lies."""
    return Path(f"{os.fspath(path)}.labels.json")


def write(model: ForwardModel, path: str | os.PathLike[str]) -> None:
    """Write the network at ``path`` and its label map at ``<path>.labels.json``, each atomically.

    Probabilities are written in full precision. Raises BayesHuntError if a file cannot be written.
    """
    from pgmpy.readwrite import XMLBIFWriter

    labels = safe_labels(model)
    states = {variable: list(names) for variable, names in labels.items()}
    safe = network.build(model.local_tables, states, model.structure)
    text = str(XMLBIFWriter(safe))
    write_text(labels_path(path), json.dumps(labels, indent=1) + "\n")
    write_text(path, text)
