"""bayeshunt figures, export and query --explain, as typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import bayeshunt as bh
from bayeshunt.cli import app


def run(*arguments: object):
    return CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture(scope="module")
def model_file(khepera_model, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("cli") / "model.json"
    khepera_model.save(path)
    khepera_model.to_xmlbif(path.with_suffix(".xmlbif"))
    return path


@pytest.mark.slow
def test_figures_are_drawn_from_results(model_file, khepera_model, tmp_path: Path) -> None:
    settings = bh.load_experiment("paper", {"protocol.runs": 1, "protocol.thetas": (0.0, 3.0)})
    table = bh.evaluate(settings, seed=0, jobs=1, model=khepera_model)
    bh.save_results(table, settings, 0, tmp_path / "results")
    done = run("figures", "--out", tmp_path / "out", "--results", tmp_path / "results", "--model", model_file, "--json")
    assert done.exit_code == 0, done.output
    files = json.loads(done.stdout)["files"]
    assert sorted(files) == sorted(path.name for path in (tmp_path / "out").iterdir())
    stems = {Path(name).stem for name in files}
    assert {"fig1b_network", "fig1c_gait_outcomes", "fig2_prey", "fig5_search_tree", "fig6a_planning_step"} <= stems
    assert {"fig3_reactive_walled", "fig4_prediction_walled", "fig4_prediction_open", "fig6b_planning_open"} <= stems
    assert {Path(name).suffix for name in files} == {".png", ".svg"}
    assert len(files) == 2 * len(stems)
    told = run("figures", "--out", tmp_path / "out", "--results", tmp_path / "results", "--model", model_file)
    lines = told.stdout.splitlines()
    assert lines[0] == f"{tmp_path / 'out'}: {len(files)} files"
    assert "  fig1b_network.png, .svg" in lines
    assert len(lines) == 1 + len(stems)


@pytest.mark.slow
def test_figures_run_the_hunts_themselves(model_file, tmp_path: Path) -> None:
    config = tmp_path / "small.toml"
    config.write_text('base = "paper"\nplanners = ["planning"]\n[protocol]\nthetas = [1.0]\n')
    done = run("figures", "--out", tmp_path, "--config", config, "--runs", 1, "--model", model_file, "--jobs", 1, "-q")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "fig6b_planning_open.svg").stat().st_size > 10_000
    assert not (tmp_path / "fig3_reactive_walled.svg").exists()


def test_figures_without_results_say_where_they_come_from(tmp_path: Path) -> None:
    done = run("figures", "--out", tmp_path, "--results", tmp_path / "nowhere")
    assert isinstance(done.exception, bh.InputError)
    assert "evaluate --out" in str(done.exception)


def test_export_writes_tables_and_network(model_file, tmp_path: Path) -> None:
    done = run("export", model_file, "--out", tmp_path / "csv", "--xmlbif", tmp_path / "net.xmlbif", "--json")
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["files"] == ["gait.csv", "distance.csv", "angle.csv", "heading.csv"]
    assert (tmp_path / "csv" / "angle.csv").read_text().startswith("gait,bin,low,high,probability,count,ci_low,ci_high")
    assert bh.import_network(tmp_path / "net.xmlbif").gaits.names == bh.ForwardModel.load(model_file).gaits.names


def test_export_puts_the_network_into_the_folder_that_it_makes(model_file, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = run("export", model_file, "--out", "made", "--xmlbif", "made/net.xmlbif")
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines() == [
        "made: 4 files", "  gait.csv", "  distance.csv", "  angle.csv", "  heading.csv", "made/net.xmlbif",
        "made/net.xmlbif.labels.json: what its states are called",
    ]  # fmt: skip
    assert (tmp_path / "made" / "net.xmlbif").is_file()
    refused = run("export", model_file, "--out", "other", "--xmlbif", "elsewhere/net.xmlbif")
    assert isinstance(refused.exception, bh.InputError)
    assert not (tmp_path / "other").exists()


def test_query_explains(model_file) -> None:
    done = run("query", model_file, "--distance", 0.15, "--angle", 0.4, "--explain")
    assert done.exit_code == 0, done.output
    assert "What each variable said" in done.stdout
    assert "Heading" not in done.stdout.split("What each variable said")[1]
    told = run("query", model_file, "--distance", 0.15, "--angle", 0.4, "--heading", 0.5, "--explain", "--json")
    explanation = json.loads(told.stdout, parse_constant=pytest.fail)["explanation"]
    frame = bh.InverseModel(bh.ForwardModel.load(model_file)).posterior(0.15, 0.4, 0.5).explain()
    for gait, row in frame.to_dict("index").items():
        assert {key: float(v) if key != "reference" else v for key, v in explanation[gait].items()} == row


def test_query_reads_networks_of_other_programs(model_file) -> None:
    arguments = ("--distance", 0.15, "--angle", 0.4, "--json")
    ours, theirs = (json.loads(run("query", path, *arguments).stdout) for path in
                    (model_file, model_file.with_suffix(".xmlbif")))  # fmt: skip
    assert theirs["probabilities"] == pytest.approx(ours["probabilities"], abs=1e-12)
    assert theirs["evidence"] == ours["evidence"]


def test_a_network_answers_every_command_that_needs_no_counts(model_file, tmp_path) -> None:
    network = model_file.with_suffix(".xmlbif")
    ours, theirs = (
        json.loads(run("hunt", "--model", path, "--planner", "planning", "--json").stdout)
        for path in (model_file, network)
    )
    assert theirs == ours
    assert run("export", network, "--out", tmp_path / "tables").exit_code == 0
    refused = run("evaluate", "--model", network, "--runs", 1, "--out", tmp_path / "results")
    assert isinstance(refused.exception, bh.InputError)
    assert not (tmp_path / "results").exists()


def test_what_a_network_does_not_know_is_null(model_file) -> None:
    target = ("--distance", 0.15, "--angle", 0.4)
    ours, theirs = (
        json.loads(run("query", path, *target, "--json").stdout)["support"]
        for path in (model_file, model_file.with_suffix(".xmlbif"))
    )
    assert isinstance(ours, int)
    assert theirs is None
    assert (
        "unknown: an imported network carries no counts"
        in run("query", model_file.with_suffix(".xmlbif"), *target).stdout
    )
