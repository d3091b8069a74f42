"""Where commands write: every file and folder is looked at before any work, and an output that fails is one line."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
import typer

from bayeshunt.cli.app import app

COMMANDS = typer.main.get_command(app).commands
#: Arguments that a command cannot do without; none of the files is there, which a command would see only later.
NEEDED = {
    "fit": ["none.parquet"], "assess": ["none.parquet"], "replay": ["none.parquet"], "report": ["none"],
    "export": ["none.json"], "query": ["none.json", "--distance", "1", "--angle", "1"], "status": ["none"],
    "score": ["none.parquet"],
}  # fmt: skip
FILES = [("babble", "out"), ("fit", "out"), ("fit", "xmlbif"), ("assess", "out"), ("hunt", "out"), ("hunt", "replay"),
         ("replay", "out"), ("report", "out"), ("export", "xmlbif"), ("reference", "out"), ("remember", "out"),
         ("explore", "out"), ("export", "page"), ("hunt", "video"), ("replay", "video"), ("score", "out"),
         ("explore", "drawn")]  # fmt: skip
FOLDERS = [("evaluate", "out"), ("figures", "out"), ("sweep", "out"), ("tradeoff", "out"), ("export", "out"),
           ("reference", "cache"), ("assess", "csv")]  # fmt: skip
#: Options that are called otherwise than in the code.
FLAGS = {"drawn": "map"}
#: A folder in which nobody can make a file, the administrator neither.
NOBODYS = Path("/proc/sys")

each_file = pytest.mark.parametrize(("command", "option"), FILES)
each_target = pytest.mark.parametrize(("command", "option"), FILES + FOLDERS)


@pytest.fixture
def refused(bayeshunt, folder):
    """A function that gives a command a target: the one line that refuses it, after which nothing has been made."""

    def run(command, option, target):
        before = sorted(folder.iterdir())
        required = [p.name for p in COMMANDS[command].params if p.required and p.param_type_name == "option"]
        others = [text for name in required if name not in (option, "distance", "angle")
                  for text in (f"--{name}", "other.out")]  # fmt: skip
        out, err = bayeshunt(
            command, *NEEDED.get(command, []), *others, f"--{FLAGS.get(option, option)}", str(target), status=2
        )
        assert not out
        assert err.count("\n") == 1
        assert sorted(folder.iterdir()) == before
        return err

    return run


def test_the_lists_name_every_target():
    found = {
        (name, parameter.name)
        for name, command in COMMANDS.items()
        for parameter in command.params
        if "rite" in (parameter.help or "") or "older" in (parameter.help or "") or parameter.name in ("out", "xmlbif")
        if parameter.param_type_name == "option" and parameter.name != "results"  # which is read
    }
    assert found == {*FILES, *FOLDERS}


@each_file
def test_the_folder_of_a_file_must_be_there(refused, command, option):
    assert refused(command, option, "missing/file.svg") == (
        "bayeshunt: missing/file.svg: the folder missing does not exist; make it first\n"
    )


@each_file
def test_a_folder_is_no_file(refused, folder, command, option):
    (folder / "there.svg").mkdir()
    assert refused(command, option, "there.svg") == "bayeshunt: there.svg: is a folder; expected a file name\n"


#: What a command writes and how the name ends, and an ending that belongs to another kind of file.
ENDINGS = [
    ("babble", "out", "tables are Parquet", ".parquet", ".json"),
    ("fit", "out", "models are JSON", ".json", ".xmlbif"),
    ("fit", "xmlbif", "networks are XMLBIF", ".xmlbif", ".json"),
    ("hunt", "out", "episodes are Parquet", ".parquet", ".json"),
    ("hunt", "replay", "pages are HTML", ".html", ".txt"),
    ("replay", "out", "pages are HTML", ".html", ".parquet"),
    ("report", "out", "pages are HTML", ".html", ".PNG"),
    ("export", "xmlbif", "networks are XMLBIF", ".xmlbif", ".bif"),
    ("export", "page", "pages are HTML", ".html", ".json"),
    ("reference", "out", "such tables are NPZ", ".npz", ".json"),
    ("remember", "out", "memories are JSON", ".json", ".npz"),
    ("explore", "out", "rooms are JSON", ".json", ".txt"),
    ("score", "out", "tables of scores are CSV", ".csv", ".json"),
]


def test_the_list_of_endings_names_every_file():
    assert {(command, option) for command, option, *_ in ENDINGS} == {*FILES} - {
        ("assess", "out"),
        ("hunt", "video"),
        ("replay", "video"),
        ("explore", "drawn"),
    }


@pytest.mark.parametrize(("command", "option", "said", "right", "wrong"), ENDINGS)
def test_an_ending_of_another_kind_of_file_is_refused(refused, command, option, said, right, wrong):
    err = refused(command, option, f"new{wrong}")
    assert err.startswith(f"bayeshunt: new{wrong}: {said}, not ")
    assert err.endswith(f"; name it new{right}\n")


@pytest.mark.parametrize("command", ["hunt", "replay"])
def test_a_film_needs_its_ending(refused, command):
    said = "bayeshunt: hunt.avi: expected a file name that ends in .gif or .mp4\n"
    assert refused(command, "video", "hunt.avi") == said


@pytest.mark.parametrize("ending", ["", ".json", ".txt"])
def test_a_figure_needs_its_ending(refused, ending):
    assert refused("assess", "out", f"r{ending}") == (
        f"bayeshunt: r{ending}: expected a file name that ends in .png or .svg\n"
    )


def test_a_network_in_the_folder_that_export_makes_is_no_table_either(refused):
    assert "other.out/a.csv: networks are XMLBIF, not CSV" in refused("export", "xmlbif", "other.out/a.csv")


@pytest.mark.parametrize("name", ["model", "model.v2", "MODEL.JSON"])
def test_any_other_ending_is_taken(bayeshunt, folder, khepera_frame, name):
    from bayeshunt.data import babbling_table

    babbling_table.save(khepera_frame, folder / "b.parquet")
    bayeshunt("fit", "b.parquet", "--out", name)
    assert (folder / name).is_file()


@pytest.mark.skipif(not NOBODYS.is_dir(), reason="no such folder on this system")
@each_target
def test_a_folder_that_cannot_be_written_is_refused(refused, command, option):
    target = NOBODYS / "new.svg"
    assert refused(command, option, target).startswith(f"bayeshunt: {target}: cannot write in {NOBODYS} (")


@pytest.mark.parametrize(("command", "option"), FOLDERS)
def test_a_file_is_no_folder(refused, folder, command, option):
    (folder / "there").write_text("mine")
    for target in ("there", "there/below/it"):
        err = refused(command, option, target)
        assert err.startswith(f"bayeshunt: {target}: cannot be used as an output folder (")
        assert err.endswith("there is not a folder)\n")


def test_a_network_may_stand_in_the_folder_that_export_makes(bayeshunt, folder, khepera_model):
    khepera_model.save(folder / "model.json")
    for order in (["--out", "new", "--xmlbif", "new/a.xmlbif"], ["--xmlbif", "newer/a.xmlbif", "--out", "newer"]):
        bayeshunt("export", "model.json", *order)
    assert (folder / "new" / "a.xmlbif").read_bytes() == (folder / "newer" / "a.xmlbif").read_bytes()


@each_target
def test_a_dash_is_no_name(refused, command, option):
    assert "got '-', which is not taken for standard input or output here" in refused(command, option, "-")


def test_an_ending_may_be_in_capitals(bayeshunt, folder, khepera_frame):
    from bayeshunt.data import babbling_table

    babbling_table.save(khepera_frame, folder / "b.parquet")
    bayeshunt("assess", "b.parquet", "--out", "R.PNG", "--permutations", "1", "--structure", "naive")
    assert (folder / "R.PNG").read_bytes().startswith(b"\x89PNG")


def test_a_command_says_what_it_wrote_and_what_comes_next(bayeshunt, folder, khepera_model):
    khepera_model.save(folder / "model.json")
    few = ["--model", "model.json", "--set", "protocol.thetas=[1]"]
    _, err = bayeshunt("hunt", *few, "--planner", "reactive", "--out", "my hunt.parquet")
    decisions = len(pd.read_parquet(folder / "my hunt.parquet"))
    following = "bayeshunt replay 'my hunt.parquet' --out 'my hunt.html'"
    assert err == f"my hunt.parquet: {decisions} decisions; next: {following}\n"
    _, err = bayeshunt("evaluate", *few, "--planner", "reactive", "--runs", "1", "--out", "my results", "--jobs", "1")
    following = "bayeshunt report 'my results' --out report.html"
    assert err == f"every hunt and the summary are in my results; next: {following}\n"


def test_fit_says_a_question_that_its_model_answers(bayeshunt, folder, khepera_frame):
    from bayeshunt.data import babbling_table

    babbling_table.save(khepera_frame, folder / "b.parquet")
    for structure in ("naive", "previous_gait"):
        out, _ = bayeshunt("fit", "b.parquet", "--out", "my model.json", "--structure", structure)
        command = shlex.split(out.splitlines()[-1].removeprefix("next: "))
        assert command[:3] == ["bayeshunt", "query", "my model.json"]
        answer = json.loads(bayeshunt(*command[1:], "--json")[0])
        assert answer["support"] > 0
        assert not answer["snapped"]


# --- a standard output that fails ------------------------------------------------------------------

#: Commands that print at once, as a table, as JSON and as text.
PRINTING = [["settings"], ["settings", "--json"], ["prey"], ["presets", "paper", "--toml"], ["--help"], ["--version"]]
each_printing = pytest.mark.parametrize("arguments", PRINTING, ids=" ".join)


def run(*arguments, **streams):
    command = [sys.executable, "-m", "bayeshunt", *arguments]
    return subprocess.run(command, stderr=subprocess.PIPE, timeout=60, check=False, **streams)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device on this system")
@each_printing
def test_a_full_disk_is_one_line(arguments):
    with Path("/dev/full").open("w") as full:
        ended = run(*arguments, stdout=full)
    assert ended.returncode == 1
    assert ended.stderr == b"bayeshunt: the output cannot be written (No space left on device)\n"


@each_printing
def test_who_closes_the_pipe_is_told_nothing(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as pipe:
        ended = run(*arguments, stdout=pipe)
    assert (ended.returncode, ended.stderr) == (0, b"")


@pytest.mark.parametrize("encoding", ["latin-1", "ascii", "cp1252"])
def test_an_output_that_lacks_characters_gets_others(encoding, tmp_path, khepera_model):
    khepera_model.save(tmp_path / "model.json")
    for arguments in (["query", str(tmp_path / "model.json"), "--distance", "0.16", "--angle", "0.5"], ["prey"]):
        environment = {**os.environ, "PYTHONIOENCODING": encoding}
        ended = run(*arguments, stdout=subprocess.PIPE, env=environment)
        assert (ended.returncode, ended.stderr) == (0, b"")
        shown = ended.stdout.decode(encoding)
        assert shown.strip()
        assert "?" not in shown  # the bars and the rules have a plain form


def test_an_error_of_the_work_itself_keeps_its_traceback(bayeshunt, monkeypatch):
    def fails(_):
        raise OSError("a defect")

    monkeypatch.setattr("bayeshunt.config.loading.describe", fails)
    with pytest.raises(OSError, match="a defect"):
        bayeshunt("settings")
