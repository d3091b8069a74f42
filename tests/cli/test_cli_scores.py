"""score, assess and prey score on recordings: tables, CSV, figures."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from bayeshunt.cli import main

DATA = Path(__file__).parents[2] / "data"


def run(monkeypatch, *words) -> int:
    monkeypatch.setattr("sys.argv", ["bayeshunt", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    return left.value.code


def test_a_robots_motion_is_scored_from_its_log(monkeypatch, capfd, tmp_path) -> None:
    line = ["score", DATA / "husky_windows.csv", "--time-step", 2, "--gaits", 9, "--folds-by", "calib_step", "-q"]
    line += ["--model", "unicycle", "--model", "residual", "--model", "table"]
    files = ["--out", tmp_path / "s.csv", "--figure", tmp_path / "s.svg"]
    assert run(monkeypatch, *line, *files) == 0
    said = capfd.readouterr().out
    assert "603 windows, held out" in said
    assert "whole values of 'calib_step' are held out" in said
    assert said.endswith(f"written: {tmp_path / 's.csv'}, {tmp_path / 's.svg'}\n")
    table = pd.read_csv(tmp_path / "s.csv").set_index("model")
    assert table.loc["residual", "position_m"] < table.loc["unicycle", "position_m"] < table.loc["table", "position_m"]
    assert (tmp_path / "s.svg").read_text().startswith("<?xml")
    assert run(monkeypatch, *line[:9], "--model", "stay") == 2
    assert "did you mean 'stays'" in capfd.readouterr().err.splitlines()[-1]
    assert run(monkeypatch, *line[:7], "clib_step", "-q") == 2
    assert "column 'clib_step' is missing" in capfd.readouterr().err.splitlines()[-1]


@pytest.mark.slow
def test_a_table_without_commands_scores_what_it_can(monkeypatch, capfd) -> None:
    assert run(monkeypatch, "score", DATA / "khepera_babbling.parquet", "--json") == 0
    assert [row["model"] for row in json.loads(capfd.readouterr().out)] == ["stays", "table", "previous_gait"]


def test_assess_takes_logs_and_writes_its_tables(monkeypatch, capfd, tmp_path) -> None:
    line = ["assess", DATA / "husky_windows.csv", "--time-step", 2, "--permutations", 1, "--structure", "tan", "-q"]
    assert run(monkeypatch, *line, "--csv", tmp_path / "csv") == 0
    said = capfd.readouterr().out
    assert "WORSE than ignoring the gait" in said
    assert "nat per m or rad, less is better" in said
    assert sorted(path.stem for path in (tmp_path / "csv").iterdir()) == [
        "confusion", "independence", "reliability", "structures", "variables"
    ]  # fmt: skip
    assert pd.read_csv(tmp_path / "csv" / "variables.csv")["density"].notna().all()
    assert run(monkeypatch, *line, "--auto-bins") == 0
    assert "WORSE" not in capfd.readouterr().out


@pytest.mark.slow
def test_scores_of_prey_are_drawn(monkeypatch, capfd, tmp_path) -> None:
    line = ["prey", "score", "--on", DATA / "locusts.parquet", "--time-step", 1.2, "--split", "time", "--steps", 4]
    assert run(monkeypatch, *line, "--figure", tmp_path / "p.png") == 0
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")
    assert f"written: {tmp_path / 'p.png'}" in capfd.readouterr().out.replace("\n", "")
