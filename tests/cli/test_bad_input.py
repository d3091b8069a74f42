"""Bad input: one clear line on stderr, exit status 2, no traceback, nothing half-written."""

import json
import shutil

import numpy as np
import pytest

from bayeshunt.cli import main
from bayeshunt.data import babbling_table


@pytest.fixture(scope="module")
def good(tmp_path_factory, khepera_frame, khepera_model):
    """A folder with a good babbling table and a good model."""
    folder = tmp_path_factory.mktemp("good")
    babbling_table.save(khepera_frame, folder / "data.parquet")
    khepera_model.save(folder / "model.json")
    return folder


@pytest.fixture
def folder(good, tmp_path, monkeypatch):
    """A fresh copy of it, as the working folder."""
    for path in good.iterdir():
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(monkeypatch, *arguments):
    monkeypatch.setattr("sys.argv", ["bayeshunt", *arguments])
    with pytest.raises(SystemExit) as stopped:
        main()
    return stopped.value.code


def edit_table(folder, change):
    frame = babbling_table.load(folder / "data.parquet")
    record = frame.attrs[babbling_table.PROVENANCE_KEY]
    babbling_table.save(change(frame), folder / "data.parquet", record)


def edit_model(folder, change):
    content = json.loads((folder / "model.json").read_text())
    change(content)
    (folder / "model.json").write_text(json.dumps(content))


def with_nan(frame):
    frame.loc[17, "distance"] = float("nan")
    return frame


def with_stranger(frame):
    frame.loc[3, "gait"] = "moonwalk"
    return frame


def negative(frame):
    frame.loc[0, "distance"] = -0.1
    return frame


def wordy(frame):
    frame["angle"] = "north"
    return frame


def cut(name, keep):
    def change(folder):
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[: int(len(content) * keep)])

    return change


def write(name, text):
    return lambda folder: (folder / name).write_text(text)


FIT = ("fit", "data.parquet", "--out", "new.json")
QUERY = ("query", "model.json", "--distance", "0.1", "--angle", "0.5")
EVALUATE = ("evaluate", "--model", "model.json", "--runs", "1", "--quiet")
BABBLE = ("babble", "--out", "new.parquet", "--steps", "20")
HUNT = ("hunt", "--model", "model.json", "--out", "new.parquet")

#: name: (what is done to the folder, the command, what the line must say)
CASES = {
    "missing column": (lambda f: edit_table(f, lambda t: t.drop(columns="angle")), FIT, "column 'angle' is missing"),
    "NaN": (lambda f: edit_table(f, with_nan), FIT, "row 17: distance is nan"),
    "stranger gait": (lambda f: edit_table(f, with_stranger), FIT, "row 3: gait 'moonwalk' is not in the repertoire"),
    "negative distance": (lambda f: edit_table(f, negative), FIT, "row 0: distance is -0.1"),
    "words for numbers": (lambda f: edit_table(f, wordy), FIT, "column 'angle' holds"),
    "angles in degrees": (
        lambda f: edit_table(f, lambda t: t.assign(angle=np.degrees(t["angle"]) + 90)),
        FIT,
        "expected radians from -4 pi to 4 pi; if the column is in degrees, convert it: numpy.radians(frame['angle'])",
    ),
    "headings in degrees": (lambda f: edit_table(f, lambda t: t.assign(heading=-90.0)), FIT, "row 0: heading is -90;"),
    "empty table": (lambda f: edit_table(f, lambda t: t.iloc[:0]), FIT, "the table has no rows"),
    "a gait never babbled": (lambda f: edit_table(f, lambda t: t[t["gait"] != "straight"]), FIT, "straight"),
    "truncated Parquet": (cut("data.parquet", 0.6), FIT, "data.parquet: cannot be read as a babbling table"),
    "empty file": (cut("data.parquet", 0), FIT, "data.parquet: cannot be read as a babbling table"),
    "CSV for Parquet": (
        write("data.parquet", "gait,distance\na,1\n"),
        FIT,
        "data.parquet: cannot be read as a babbling table",
    ),
    "no such data": (None, ("fit", "nowhere.parquet", "--out", "new.json"), "nowhere.parquet: no such file"),
    "folder as data": (None, ("fit", ".", "--out", "new.json"), ".: is a folder; give a file made by"),
    "something else as data": (
        write("notes.md", "notes"),
        ("fit", "notes.md", "--out", "new.json"),
        "give a table made by: bayeshunt babble\n",
    ),
    "CSV name for a table": (None, ("babble", "--out", "new.csv", "--steps", "20"), "new.csv: tables are Parquet"),
    "table as an episode": (None, ("replay", "data.parquet", "--out", "a.html"), "not an episode, or damaged; give"),
    "table as a model": (None, ("query", "data.parquet", *QUERY[2:]), "not a text file); give a file made by"),
    "negative prior": (None, (*FIT, "--prior", "-1"), "prior"),
    "prior not a number": (None, (*FIT, "--prior", "nan"), "prior"),
    "no folder for the model": (None, ("fit", "data.parquet", "--out", "no/new.json"), "the folder no does not exist"),
    "edited model": (lambda f: edit_model(f, lambda m: m["content"].update(prior=0.5)), QUERY, "model.json: "),
    "newer model": (lambda f: edit_model(f, lambda m: m.update(format=99)), QUERY, "model.json: "),
    "truncated model": (cut("model.json", 0.5), QUERY, "model.json"),
    "not a model": (write("model.json", "[1, 2]"), QUERY, "model.json"),
    "Parquet for a model": (lambda f: shutil.copy(f / "data.parquet", f / "model.json"), QUERY, "model.json"),
    "no such model": (None, ("query", "gone.json", "--distance", "0.1", "--angle", "0"), "gone.json"),
    "negative target": (None, (*QUERY[:3], "-1", "--angle", "0"), "target (-1.0, 0.0): expected"),
    "target not a number": (None, (*QUERY[:3], "nan", "--angle", "0"), "target (nan, 0.0): expected"),
    "bearing in degrees": (None, (*QUERY[:-1], "57"), "--angle: expected radians from -2 pi to 2 pi, got 57; "),
    "heading in degrees": (None, (*QUERY, "--heading", "-90"), "if that is in degrees, give -1.571 "),
    "unknown target, no snapping": (None, (*QUERY[:3], "9", "--angle", "0", "--no-snap"), "leave out --no-snap"),
    "word for a number": (None, (*QUERY[:3], "far", "--angle", "0"), "'--distance'"),
    "missing option": (None, QUERY[:4], "--angle"),
    "unknown option": (None, (*QUERY, "--speed", "3"), "--speed"),
    "unknown command": (None, ("chase",), "chase"),
    "negative runs": (None, (*EVALUATE, "--runs", "-5"), "runs"),
    "zero runs": (None, (*EVALUATE, "--runs", "0"), "runs"),
    "zero jobs": (None, (*EVALUATE, "--jobs", "0"), "jobs: expected"),
    "negative seed": (None, (*EVALUATE, "--seed", "-1"), "seed"),
    "unknown planner": (None, (*EVALUATE, "--planner", "clever"), "unknown planner 'clever'"),
    "unknown arena": (None, (*EVALUATE, "--arena", "pond"), "unknown arena 'pond'"),
    "planner twice": (None, (*EVALUATE, "--planner", "reactive", "--planner", "reactive"), "given twice"),
    "unknown preset": (None, (*EVALUATE, "--preset", "papr"), "did you mean 'paper'"),
    "file as output folder": (
        None,
        (*EVALUATE, "--out", "model.json"),
        "model.json: cannot be used as an output folder",
    ),
    "TOML typo": (
        write("my.toml", 'base = "paper"\n[prey]\nsped = 1\n'),
        (*EVALUATE, "--config", "my.toml"),
        "my.toml: prey.sped: unknown key; did you mean 'speed'",
    ),
    "TOML value": (
        write("my.toml", 'base = "paper"\n[protocol]\ntime_limit = -1\n'),
        (*EVALUATE, "--config", "my.toml"),
        "my.toml: protocol.time_limit",
    ),
    "planner setting": (
        write("my.toml", 'base = "paper"\n[planner.planning]\ndept = 3\n'),
        (*EVALUATE, "--config", "my.toml"),
        "did you mean 'depth'",
    ),
    "not TOML": (write("my.toml", "speed: 3"), (*EVALUATE, "--config", "my.toml"), "my.toml: not valid TOML"),
    "no such TOML": (None, (*EVALUATE, "--config", "gone.toml"), "gone.toml: cannot be read"),
    "another robot's model": (
        write("my.toml", 'base = "paper"\nrobot = "car"\n'),
        (*EVALUATE, "--config", "my.toml"),
        "fit a model for this robot",
    ),
    "unknown behaviour": (
        write("my.toml", 'base = "paper"\n[prey]\nbehaviour = "rabbit"\n'),
        (*EVALUATE, "--config", "my.toml"),
        "unknown behaviour 'rabbit'",
    ),
    "unknown robot": (None, (*BABBLE, "--robot", "kepera"), "did you mean 'khepera'"),
    "zero steps": (None, (*BABBLE[:3], "--steps", "0"), "steps: expected a whole number"),
    "folder as output": (None, ("babble", "--out", "."), "is a folder"),
    "hunt in an unknown arena": (None, (*HUNT, "--arena", "pond"), "unknown arena 'pond'"),
    "hunt at no bearing": (None, (*HUNT, "--theta", "nan"), "theta: expected a finite number"),
    "hunt at a bearing in degrees": (None, (*HUNT, "--theta", "57"), "theta: expected radians from -2 pi to 2 pi"),
    "bearings in degrees": (
        write("my.toml", 'base = "paper"\n[protocol]\nthetas = [0, 30, 60]\n'),
        (*EVALUATE, "--config", "my.toml"),
        "my.toml: protocol.thetas: expected radians from -2 pi to 2 pi, got 30; if that is in degrees, give 0.5236 ",
    ),
    "unknown kind of settings": (None, ("settings", "prey"), "expected experiment or robot"),
}


@pytest.mark.parametrize("name", CASES)
def test_one_line_status_2_and_nothing_written(folder, monkeypatch, capfd, name):
    spoil, command, says = CASES[name]
    if spoil is not None:
        spoil(folder)
    before = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    status = run(monkeypatch, *command)
    out, err = capfd.readouterr()
    assert status == (1 if name == "unknown target, no snapping" else 2)
    assert out == ""
    assert err.startswith("bayeshunt: ")
    assert err.count("\n") == 1
    assert says in err
    assert {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()} == before


@pytest.mark.parametrize(
    ("planner", "setting"),
    [("memory_place", "planner.memory_place.tables=model.json"), ("reference", "planner.reference.table=model.json")],
)
def test_a_model_is_no_table_of_theirs_and_no_python_is_spoken(folder, monkeypatch, capfd, planner, setting):
    assert run(monkeypatch, *EVALUATE, "--planner", planner, "--set", setting) == 2
    err = capfd.readouterr().err
    assert "model.json: not a " in err
    assert "or damaged; give a file made by: bayeshunt" in err
    assert "pickle" not in err
    assert "(" not in err


@pytest.mark.parametrize("command", [FIT, QUERY, ("replay", "data.parquet", "--out", "a.html")])
def test_no_suggested_command_would_overwrite_a_file(folder, monkeypatch, capfd, command):
    (folder / command[1]).write_text("somebody's own words")
    assert run(monkeypatch, *command) == 2
    assert f"--out {command[1]}" not in capfd.readouterr().err
    (folder / command[1]).unlink()
    assert run(monkeypatch, *command) == 2
    assert f"--out {command[1]}" in capfd.readouterr().err


def test_damaged_results_are_not_to_be_written_over(folder, monkeypatch, capfd):
    (folder / "results").mkdir()
    (folder / "results" / "hunts.parquet").write_text("no table")
    assert run(monkeypatch, "report", "results", "--out", "a.html") == 2
    err = capfd.readouterr().err
    assert "hunts.parquet: cannot be read as results" in err
    assert "move it away" in err
    assert "--out" not in err
