"""A small network as BIF and as XMLBIF, and the one right answer of every valid way to write it."""

from __future__ import annotations

from pathlib import Path

import pytest

import bayeshunt as bh

BIF = """network small {
}
variable Gait {
  type discrete [ 2 ] { go, turn };
}
variable Distance {
  type discrete [ 2 ] { 0-10 mm, 10-20 mm };
}
variable Angle {
  type discrete [ 2 ] { 180 deg, 0 deg };
}
variable Heading {
  type discrete [ 2 ] { 180 deg, 0 deg };
}
probability ( Gait ) {
  table 0.25, 0.75;
}
probability ( Distance | Gait ) {
  (go) 0.2, 0.8;
  (turn) 0.9, 0.1;
}
probability ( Angle | Gait ) {
  (go) 0.3, 0.7;
  (turn) 0.6, 0.4;
}
probability ( Heading | Gait ) {
  (go) 0.5, 0.5;
  (turn) 0.1, 0.9;
}
"""


def _variable(name: str, *states: str) -> str:
    outcomes = "".join(f"<OUTCOME>{state}</OUTCOME>" for state in states)
    return f'<VARIABLE TYPE="nature"><NAME>{name}</NAME>{outcomes}</VARIABLE>\n'


def _definition(name: str, table: str, given: str = "<GIVEN>Gait</GIVEN>") -> str:
    return f"<DEFINITION><FOR>{name}</FOR>{given}<TABLE>{table}</TABLE></DEFINITION>\n"


XML = "".join(
    [
        '<?xml version="1.0"?>\n<BIF VERSION="0.3">\n<NETWORK>\n<NAME>small</NAME>\n',
        _variable("Gait", "go", "turn"),
        _variable("Distance", "0-10 mm", "10-20 mm"),
        _variable("Angle", "180 deg", "0 deg"),
        _variable("Heading", "180 deg", "0 deg"),
        _definition("Gait", "0.25 0.75", ""),
        _definition("Distance", "0.2 0.8 0.9 0.1"),
        _definition("Angle", "0.3 0.7 0.6 0.4"),
        _definition("Heading", "0.5 0.5 0.1 0.9"),
        "</NETWORK>\n</BIF>\n",
    ]
)

#: P(gait | 5 mm, 0 degrees): 0.25 x 0.2 x 0.7 = 0.035 against 0.75 x 0.9 x 0.4 = 0.27.
ANSWER = [0.035 / 0.305, 0.27 / 0.305]


def check_answer(path: Path, gaits: tuple[str, str] = ("go", "turn")) -> bh.ForwardModel:
    """Import a file and check the answer that every valid way to write the network has."""
    model = bh.import_network(path)
    answer = bh.InverseModel(model).posterior(0.005, 0.0)
    assert set(model.gaits.names) == set(gaits)
    assert [answer.probabilities[gait] for gait in gaits] == pytest.approx(ANSWER, abs=1e-12)
    # the heading's table takes no part in that answer
    assert model.cpt("Heading").loc["0 deg", list(gaits)].tolist() == pytest.approx([0.5, 0.9], abs=1e-12)
    return model


def refusal(path: Path) -> str:
    """The one line in which a file is refused; it begins with the file's name."""
    with pytest.raises(bh.InputError) as caught:
        bh.import_network(path)
    said = str(caught.value)
    assert said.startswith(str(path))
    assert "\n" not in said
    assert said.isprintable()
    return said.removeprefix(str(path))
