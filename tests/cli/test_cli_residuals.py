"""fit --residual-of and --auto-bins, on a real robot's windows."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import bayeshunt as bh
from bayeshunt.cli import main

HUSKY = Path(__file__).parents[2] / "data" / "husky_windows.csv"


def run(monkeypatch, *words) -> int:
    monkeypatch.setattr("sys.argv", ["bayeshunt", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    return left.value.code


def test_fit_residuals_of_a_log_and_ask_them(monkeypatch, capfd, tmp_path) -> None:
    monkeypatch.chdir(tmp_path)
    line = ["fit", HUSKY, "--time-step", 2, "--gaits", 9, "--prior", 0.03, "-q"]
    assert run(monkeypatch, *line, "--residual-of", "unicycle", "--out", "m.json", "--xmlbif", "m.xmlbif") == 0
    said = capfd.readouterr().out
    assert "603 rows, residuals of the unicycle, bins" in said
    assert run(monkeypatch, *said.split("next: bayeshunt ")[1].split()) == 0
    assert "P(Gait | Distance, Angle)" in capfd.readouterr().out
    model = bh.ForwardModel.load("m.json")
    assert model.source.residual_of == "unicycle"
    assert bh.import_network("m.xmlbif").axes.angle.bins == 36
    assert run(monkeypatch, *line, "--auto-bins", "--out", "a.json", "--json") == 0
    assert json.loads(capfd.readouterr().out)["bins"]["Angle"] < 36
    assert run(monkeypatch, *line, "--residual-of", "car", "--out", "b.json") == 2
    assert capfd.readouterr().err.splitlines()[-1].startswith("bayeshunt: residual_of: unknown motion 'car'")
