"""The commands as a user types them, start to end, in one folder."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from bayeshunt.cli.app import app
from bayeshunt.views.terminal import terminal

README = (Path(__file__).parents[2] / "README.md").read_text()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("work")


def test_the_whole_way(bayeshunt, folder):
    out, err = bayeshunt("babble", "--steps", "400", "--out", "b.parquet", "--quiet")
    assert "400 rows of 10 gaits" in out
    assert err == ""
    out, _ = bayeshunt("fit", "b.parquet", "--out", "m.json", "--xmlbif", "m.xmlbif", "--json")
    assert json.loads(out)["rows"] == 400
    assert (folder / "m.xmlbif").exists()
    out, _ = bayeshunt("query", "m.json", "--distance", "0.19", "--angle", "0", "--json")
    answer = json.loads(out)
    assert answer["best"] == "straight"
    assert sum(answer["probabilities"].values()) == pytest.approx(1)
    assert answer["support"] > 0
    out, _ = bayeshunt("query", "m.json", "--distance", "0.19", "--angle", "0")
    assert "P(evidence)" in out
    assert "babbling rows" in out
    assert "asked                190 mm, 0°" in out
    assert "nearest" not in out
    assert "out of reach" not in out
    out, _ = bayeshunt("query", "m.json", "--distance", "16", "--angle", "0.5")
    assert "asked                16 m, 28.6°" in out
    assert "(nearest, 15.8 m away; " in out
    assert "out of reach: no gait ever went farther than" in " ".join(out.split())
    out, _ = bayeshunt("query", "m.json", "--distance", "16", "--angle", "0.5", "--heading", "-3", "--json")
    answer = json.loads(out)
    assert answer["asked"] == {"distance": 16.0, "angle": 0.5, "heading": -3.0}
    assert answer["beyond"] is True
    assert 15.7 < answer["gap"] < 16
    assert 0.19 < answer["farthest"] < 0.22
    assert answer["heading_gap"] > 1
    out, _ = bayeshunt("hunt", "--model", "m.json", "--arena", "walled", "--theta", "3", "--out", "h.parquet", "--json")
    assert json.loads(out)["caught"] is True
    assert (folder / "h.parquet").exists()
    out, _ = bayeshunt("evaluate", "--model", "m.json", "--runs", "1", "--jobs", "1", "--out", "r", "--quiet")
    assert "not in the paper" in " ".join(out.split())
    for name in ("hunts.parquet", "summary.json", "summary.md"):
        assert (folder / "r" / name).exists()
    assert "not in the paper" in (folder / "r" / "summary.md").read_text()


def test_evaluate_json_is_the_contract(bayeshunt):
    out, err = bayeshunt("evaluate", "--runs", "1", "--planner", "reactive", "--arena", "open", "--jobs", "1", "--json")
    facts = json.loads(out)
    assert err == ""
    assert {"rows", "seed", "version"} <= set(facts)
    assert [row["theta"] for row in facts["rows"]] == [0, 1, 2, 3, 4, 5, 6, None]
    assert facts["rows"][-1]["runs"] == 7


def test_version(bayeshunt):
    assert re.fullmatch(r"bayeshunt \d+\.\d+\.\d+\n", bayeshunt("--version")[0])


def test_settings_lists_every_key(bayeshunt):
    assert "prey.speed" in bayeshunt("settings")[0]
    assert any(row["key"] == "body.diameter" for row in json.loads(bayeshunt("settings", "robot", "--json")[0]))


def test_no_arguments_show_the_help(bayeshunt):
    assert bayeshunt() == bayeshunt("--help")


@pytest.mark.parametrize("name", ["experiment", "robot"])
def test_keys_are_whole_in_a_narrow_terminal(bayeshunt, monkeypatch, name):
    monkeypatch.setattr(terminal.out, "width", 80)
    shown = {line.split()[0] for line in bayeshunt("settings", name)[0].splitlines() if line[:1].strip()}
    keys = {row["key"] for row in json.loads(bayeshunt("settings", name, "--json")[0])}
    assert keys == shown - {"key"}


def commands():
    return typer.main.get_command(app).commands


@pytest.mark.parametrize("name", sorted(commands()))
def test_every_command_teaches_itself_and_stands_in_the_readme(bayeshunt, name):
    out, _ = bayeshunt(name, "--help")
    assert "Usage: bayeshunt" in out
    assert f"bayeshunt {name}" in README
    undocumented = [p.name for p in commands()[name].params if not getattr(p, "help", None)]
    assert not undocumented


def test_no_command_line_start_imports_pgmpy():
    code = "import sys; import bayeshunt.cli; assert 'pgmpy' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
