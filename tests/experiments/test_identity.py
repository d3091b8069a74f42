"""What belongs to an evaluation: every library that can change a hunt, and only what was noted is held against it."""

import ast
import json
from dataclasses import replace
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

import bayeshunt
from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import ResultsError
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.store import identity
from bayeshunt.experiments.store.export import another_model, load_results, save_results, summary
from bayeshunt.experiments.store.identity import LIBRARIES, Identity
from bayeshunt.views.pages.report import report_facts, report_html, write_report

PACKAGE = Path(bayeshunt.__file__).parent
#: What the rooms below the experiments import and what changes no number: checks of settings, files, types.
HARMLESS = {"pyarrow", "pydantic", "pydantic_core", "typing_extensions", "h5py", "rosbags"} | {
    "mujoco-core",
    "mujoco-studio",  # which come with mujoco, in its version
}


def distributions_below_the_experiments():
    """The distribution of every library that anything a hunt rests on imports, anywhere in a file."""
    above = [PACKAGE / room for room in ("experiments", "views", "envs", "cli")]
    found = set()
    for path in PACKAGE.rglob("*.py"):
        if not any(path.is_relative_to(room) for room in above):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Import):
                    found |= {alias.name.split(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.module:
                    found.add(node.module.split(".")[0])
    owners = packages_distributions()
    return {owner.lower() for name in found for owner in owners.get(name, ())}


def test_every_library_that_a_hunt_rests_on_belongs_to_it():
    assert distributions_below_the_experiments() - HARMLESS | {"bayeshunt"} == set(LIBRARIES)


@pytest.fixture
def evaluation():
    return Identity.of(load_experiment("paper"), ["reactive"], ["open"], 0, None)


@pytest.mark.parametrize("library", LIBRARIES)
def test_another_version_of_a_library_is_another_evaluation(evaluation, monkeypatch, library):
    real = identity._version
    monkeypatch.setattr(identity, "_version", lambda name: "0.0.1" if name == library else real(name))
    other = Identity.of(load_experiment("paper"), ["reactive"], ["open"], 0, None)
    assert evaluation.difference(other) == f"version of {library} is {real(library)} there and 0.0.1 here"


def test_a_folder_that_noted_fewer_libraries_and_files_goes_on(evaluation):
    here = replace(evaluation, files={"with planner mine": "a" * 64, "helper.py of planner mine": "b" * 64})
    noted = {name: here.versions[name] for name in ("bayeshunt", "box2d", "numpy")}
    older = replace(here, versions=noted, files={"with planner mine": "a" * 64})
    assert older.difference(here) is None
    assert older.difference(replace(here, versions={**here.versions, "numpy": "0.1"})).startswith("version of numpy")
    assert "planner mine is" in older.difference(replace(here, files={**here.files, "with planner mine": "c" * 64}))
    newer = replace(here, files=older.files)  # which noted every library, and so would have noted the helper
    assert "helper.py of planner mine is not given there and bbb" in newer.difference(here)


def test_the_hash_of_an_older_record_stays(evaluation):
    """It salts the checksum of every hunt in the folder: another one would call them all damaged."""
    record = {**evaluation.to_dict(), "versions": {"bayeshunt": "0.1.0", "box2d": "2.3.10", "numpy": "2.0.0"}}
    record |= {"settings": {}, "files": {}, "model": "m"}
    assert Identity.from_dict(record).hash == "68518a5977fa5f3fedd375b6cfdb95a638d1f489e6e7791f550d3779050d906d"


def test_a_worker_without_a_library_says_so():
    assert identity._version("no-such-distribution") == "not installed"


# --- the model that results were made with --------------------------------------------------------

SETTINGS = load_experiment("paper", {"protocol.thetas": [1.0], "protocol.runs": 1})
WHAT = {"planners": "reactive", "arenas": "open"}


@pytest.fixture
def another(khepera_model):
    return type(khepera_model)(khepera_model.joint, prior=1.0)


def test_results_note_their_model_wherever_they_are(tmp_path, khepera_model, another):
    frame = evaluate(SETTINGS, model=khepera_model, out=tmp_path, **WHAT)
    noted = frame.attrs["model"]
    assert evaluate(SETTINGS, model=khepera_model, **WHAT).attrs["model"] == noted
    assert load_results(tmp_path).attrs["model"] == noted
    assert json.loads((tmp_path / "summary.json").read_text())["model"] == noted
    assert summary(frame, SETTINGS, 0)["model"] == noted
    assert evaluate(SETTINGS, model=another, **WHAT).attrs["model"] != noted


def test_a_learned_model_is_noted_too():
    learned = evaluate(SETTINGS, **WHAT).attrs["model"]
    assert learned == identity.model_fingerprint(learn_model(SETTINGS, 0))


def test_a_report_says_that_it_was_given_another_model(tmp_path, khepera_model, another):
    evaluate(SETTINGS, model=khepera_model, out=tmp_path, **WHAT)
    frame = load_results(tmp_path)
    there, here = (identity.model_fingerprint(model)[:12] for model in (khepera_model, another))
    said = f"the hunts were made with a model of fingerprint {there}, this is one of fingerprint {here}; "
    assert another_model(frame.attrs.get("model"), another).startswith(said)
    assert write_report(frame, tmp_path / "other.html", model=another)[0].startswith(said)
    assert f"Another model: {said}" in (tmp_path / "other.html").read_text(encoding="utf-8")
    assert another_model(frame.attrs.get("model"), khepera_model) is None
    facts = report_facts(frame, model=khepera_model)
    assert "Another model" not in report_html(facts)
    frame.attrs.pop("model")  # as earlier versions wrote them
    assert another_model(frame.attrs.get("model"), another) is None


def test_exported_hunts_of_another_model_are_not_overwritten(tmp_path, khepera_model, another):
    frame = evaluate(SETTINGS, model=khepera_model, **WHAT)
    save_results(frame, SETTINGS, 0, tmp_path)
    with pytest.raises(ResultsError, match="results of another experiment"):
        evaluate(SETTINGS, model=another, out=tmp_path, **WHAT)
    frame.attrs.pop("model")
    save_results(frame, SETTINGS, 0, tmp_path)
    assert evaluate(SETTINGS, model=another, out=tmp_path, **WHAT).attrs["model"]
