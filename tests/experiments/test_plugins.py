"""Prey and planners of one's own reach the command line and the workers."""

import hashlib
import json

import pytest

import bayeshunt as bh
from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import InputError, ResultsError
from bayeshunt.experiments.run.plugins import load_plugin, used_additions
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.run.sources import imported_files, source_hashes

PLUGIN = """
import bayeshunt as bh
from bayeshunt.planners.paper.reactive import ReactivePlanner

class Circle:
    def __init__(self, context):
        self.context = context

    def act(self, x, y, theta, hunter_x, hunter_y):
        return self.context.wheels(0.02, 0.5)

class Mine(ReactivePlanner):
    pass

bh.register_prey("circle_of_{jobs}", Circle)
bh.register_planner("mine_of_{jobs}", Mine)
"""


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_plugin_reaches_the_workers(bayeshunt, folder, jobs):
    (folder / "own.py").write_text(PLUGIN.format(jobs=jobs))
    small = ["--set", "model.babbling_steps=200", "--set", "protocol.thetas=[1.0, 2.0]", "--runs", "15", "--quiet"]
    out, _ = bayeshunt(
        "--plugin", "own.py", "evaluate", "--planner", f"mine_of_{jobs}", "--arena", "open", "--jobs", jobs,
        "--set", f'prey.behaviour="circle_of_{jobs}"', "--json", *small,
    )  # fmt: skip
    total = json.loads(out)["rows"][-1]
    assert total["runs"] == 30
    assert total["caught"] > 20  # a slow prey that goes round in circles


@pytest.mark.parametrize("kind", ["planner", "prey"])
def test_results_of_a_changed_plugin_are_not_mixed(tmp_path, khepera_model, kind):
    """Else who mends a planner and gives the same line again is shown what the old one did."""
    (tmp_path / "own.py").write_text(PLUGIN.format(jobs=f"changed_{kind}"))
    load_plugin(tmp_path / "own.py")
    planner, prey = (
        ("mine_of_changed_planner", "straight") if kind == "planner" else ("reactive", "circle_of_changed_prey")
    )
    settings = bh.load_experiment("paper", {"prey.behaviour": prey, "protocol.thetas": [1.0]})
    what = {"runs": 1, "planners": planner, "arenas": "open", "model": khepera_model, "out": tmp_path / "out"}
    frame = bh.evaluate(settings, **what)
    assert bh.evaluate(settings, **what).equals(frame)
    with (tmp_path / "own.py").open("a") as file:
        file.write("# another one now")
    with pytest.raises(
        ResultsError, match=f"SHA-256 of the file with {kind} {planner if kind == 'planner' else prey} is"
    ):
        bh.evaluate(settings, **what)


def test_only_what_is_used_and_does_not_ship_is_hashed(tmp_path):
    for name in ("one", "two"):  # files of one name, in two folders
        (tmp_path / name).mkdir()
        (tmp_path / name / "own.py").write_text(PLUGIN.format(jobs=name))
        load_plugin(tmp_path / name / "own.py")
    assert source_hashes(used_additions(["reactive", "planning"], "evader")) == {}
    found = source_hashes(used_additions(["mine_of_one"], "circle_of_one"))
    assert list(found) == ["with planner mine_of_one", "with prey circle_of_one"]
    assert set(found.values()) == {hashlib.sha256((tmp_path / "one" / "own.py").read_bytes()).hexdigest()}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "no such file"),
        ("import nonsense_that_is_not_there", "ModuleNotFoundError: No module named"),
        ("import bayeshunt as bh; bh.register_prey('evader', object)", "ships already; choose another name"),
        ("import bayeshunt", r"own\.py: registers nothing; call bayeshunt\.register_prey\(name, class\) or "),
        (
            "import bayeshunt as bh; bh.register_prey('x', object)",
            r"own\.py: prey 'x': class object has no method act\(",
        ),
        (
            "import bayeshunt as bh; bh.register_prey('x', 3)",
            "prey 'x': expected a class that is made from a Context, ",
        ),
    ],
)
def test_a_wrong_plugin_is_one_line(tmp_path, text, message):
    path = tmp_path / "own.py"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError, match=message):
        load_plugin(path)


def written(folder, **files):
    """Write Python files, a dot in whose names is a folder; return the folder."""
    for name, text in files.items():
        path = folder.joinpath(*name.split("__")).with_suffix(".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


def test_the_modules_that_a_plugin_imports_from_its_folder_are_found(tmp_path):
    written(
        tmp_path,
        own="import numpy, helper\ndef late():\n    from tools.deep import thing\nimport bayeshunt",
        helper="import json\nfrom second import x",
        second="import own",
        tools__init="", tools__deep="from . import sibling", tools__sibling="", unused="",
        bayeshunt="raise SystemExit  # not what is meant",
    )  # fmt: skip
    (tmp_path / "tools" / "init.py").rename(tmp_path / "tools" / "__init__.py")
    found = [path.relative_to(tmp_path).as_posix() for path in imported_files(tmp_path / "own.py")]
    assert found == ["helper.py", "second.py", "tools/__init__.py", "tools/deep.py", "tools/sibling.py"]


def test_a_package_is_found_by_its_own_name_and_a_file_that_python_cannot_read_imports_nothing(tmp_path):
    written(tmp_path, pack__init="", pack__own="from pack.tools import x\nimport other", pack__tools="(", other="")
    (tmp_path / "pack" / "init.py").rename(tmp_path / "pack" / "__init__.py")
    found = [path.relative_to(tmp_path).as_posix() for path in imported_files(tmp_path / "pack" / "own.py")]
    assert found == ["other.py", "pack/__init__.py", "pack/tools.py"]


def test_beside_an_installed_plugin_nothing_else_that_is_installed_counts(tmp_path, monkeypatch):
    written(tmp_path, own="import other, pack.tools", other="", pack__own="from pack import tools", pack__tools="")
    (tmp_path / "pack" / "__init__.py").touch()
    monkeypatch.setattr("bayeshunt.experiments.run.sources._installed", lambda: {tmp_path})
    assert imported_files(tmp_path / "own.py") == []
    found = [path.name for path in imported_files(tmp_path / "pack" / "own.py")]
    assert found == ["__init__.py", "tools.py"]


def test_results_of_a_changed_helper_of_a_plugin_are_not_mixed(tmp_path, khepera_model, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "speeds_of_a_helper.py").write_text("SPEED = 0.02\n")
    text = PLUGIN.format(jobs="helped").replace("0.02, 0.5", "SPEED, 0.5")
    (tmp_path / "own.py").write_text("from speeds_of_a_helper import SPEED\n" + text)
    load_plugin(tmp_path / "own.py")
    settings = bh.load_experiment("paper", {"prey.behaviour": "circle_of_helped", "protocol.thetas": [1.0]})
    what = {"runs": 1, "planners": "reactive", "arenas": "open", "model": khepera_model, "out": tmp_path / "out"}
    frame = bh.evaluate(settings, **what)
    assert bh.evaluate(settings, **what).equals(frame)
    (tmp_path / "speeds_of_a_helper.py").write_text("SPEED = 0.03\n")
    with pytest.raises(ResultsError, match=r"SHA-256 of the file speeds_of_a_helper\.py of prey circle_of_helped is"):
        bh.evaluate(settings, **what)


def test_an_unknown_prey_is_refused_before_any_work(monkeypatch):
    monkeypatch.setattr("bayeshunt.experiments.run.runner.learn_model", lambda *_: pytest.fail("it babbled"))
    with pytest.raises(InputError, match="unknown behaviour 'rabbit'"):
        evaluate(load_experiment("paper", {"prey.behaviour": "rabbit"}), runs=1)


EVERYTHING = """
import bayeshunt as bh
from bayeshunt.protocols import Detection, Frame, Observation

class Pair(bh.Drive):
    def limits(self, step):
        return 0.6 * step, 0.6 * step
    def twist(self, ahead, turn):
        return ahead, 0.0, self.settings.gain * turn

class PairSettings(bh.DriveSettings):
    gain: float = 2.0

class Looking:
    def __init__(self, context):
        self.context = context
    def sense(self, run, map, *, rng):
        now = run.moments[-1]
        own, prey = now.poses["hunter"], now.poses["prey"]
        return Observation(now.time, own, (Frame(now.time, own, (Detection(own.relative(prey)),)),))

class Known(bh.PreyModel):
    pass

bh.register_body("pair", Pair, commands=("ahead", "turn"), settings=PairSettings, speed=lambda command: abs(command[0]))
bh.register_sensor("looking", Looking)
bh.register_prey_model("known", Known)
"""


def test_every_kind_of_thing_reaches_the_workers(tmp_path):
    (tmp_path / "own.py").write_text(EVERYTHING)
    load_plugin(tmp_path / "own.py")
    gaits = [
        {"name": n, "ahead": a, "turn": t}
        for n, a, t in (("go", 0.06, 0.0), ("left", 0.05, 0.2), ("right", 0.05, -0.2))
    ]
    robot = {"name": "pair", "body": {"drive": "pair", "gain": 1.5}, "gait": gaits}
    changes = {"robot": robot, "sensing.sensor": "looking", "prey.model": "known", "protocol.thetas": [0.0, 1.0]}
    settings = bh.load_experiment("paper", {**changes, "model.babbling_steps": 60})
    assert settings.robot.top_speed == 0.06
    for shown in (str(settings.robot), settings.robot._repr_html_()):
        assert "gain 1.5" in shown
        assert "ahead" in shown
    what = {"runs": 2, "planners": "prediction", "arenas": "open"}
    one, two = (bh.evaluate(settings, jobs=jobs, **what) for jobs in (1, 2))
    assert one.equals(two)
    found = source_hashes(used_additions(["prediction"], "straight", settings))
    assert {name.split(" ", 1)[1] for name in found} == {"body pair", "sensor looking", "prey model known"}
