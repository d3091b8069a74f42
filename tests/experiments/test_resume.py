"""A results folder: every hunt kept, the same experiment goes on, another one is refused."""

import sqlite3
from contextlib import closing
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import BayesHuntError, FolderInUseError, InputError, ResultsError
from bayeshunt.core.geometry import Polar
from bayeshunt.experiments.run import batches, runner
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.store.database import DATABASE_FILE, HuntDatabase
from bayeshunt.experiments.store.export import HUNTS_FILE, load_results
from bayeshunt.experiments.store.identity import Identity
from bayeshunt.experiments.store.status import status
from bayeshunt.files.locks import FolderLock, is_locked
from bayeshunt.models.target.prey import PreyModel

EXPORTS = ("hunts.parquet", "summary.json", "summary.md")


class StopError(Exception):
    """What interrupts an evaluation here."""


@pytest.fixture
def small(khepera_model):
    """A function that evaluates 28 hunts; keywords are added to its arguments."""

    def run(**changes):
        what = {"runs": 2, "seed": 4, "planners": ["reactive", "prediction"], "arenas": ["open"]}
        return evaluate("paper", **{**what, "model": khepera_model, **changes})

    return run


def stop_after(count):
    """A progress function that interrupts once ``count`` hunts have ended."""
    ended = 0

    def progress(more):
        nonlocal ended
        ended += more
        if ended >= count:
            raise StopError

    return progress


def contents(folder):
    return {name: (folder / name).read_bytes() for name in EXPORTS}


def test_a_folder_changes_nothing(small, tmp_path):
    frame = small(out=tmp_path)
    assert frame.equals(small())
    assert load_results(tmp_path).equals(frame)


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_interrupted_evaluation_goes_on_and_ends_in_the_same_bytes(small, tmp_path, jobs, monkeypatch):
    monkeypatch.setattr(batches, "_BATCH", 3)
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    small(out=whole)
    with monkeypatch.context() as patch:
        # Workers can be so fast that all is done before the stop arrives: they get no more than 18 of the 28.
        patch.setattr(runner, "batches", lambda hunts: islice(batches.batches(hunts), 6))
        with pytest.raises(StopError):
            small(out=parts, jobs=jobs, progress=stop_after(6))
    kept = status(parts).ended
    assert 6 <= kept < 28
    assert not (parts / HUNTS_FILE).exists()
    counted = []
    small(out=parts, jobs=jobs, progress=counted.append)
    assert counted[0] >= kept
    assert sum(counted) == 28
    assert contents(parts) == contents(whole)


def test_every_hunt_is_committed_as_it_ends(small, tmp_path, monkeypatch):
    real, seen = batches.run_hunt, []

    def watched(*arguments):
        seen.append(status(tmp_path).ended)
        return real(*arguments)

    monkeypatch.setattr(batches, "run_hunt", watched)
    small(out=tmp_path)
    assert seen == list(range(28))


@pytest.mark.parametrize("error", [KeyError, ValueError, TypeError])
def test_a_defect_in_a_planner_is_not_taken_for_damage(small, tmp_path, monkeypatch, error):
    """Who is told that the database is damaged moves it away, and loses every hunt in it."""
    real, seen = batches.run_hunt, []

    def fails(*arguments):
        seen.append(arguments)
        if len(seen) > 5:
            raise error("a defect of the planner's own")
        return real(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(batches, "run_hunt", fails)
        with pytest.raises(error, match="a defect of the planner's own") as raised:
            small(out=tmp_path)
    assert not isinstance(raised.value, BayesHuntError)
    assert status(tmp_path).ended == 5
    assert small(out=tmp_path).equals(small())


def test_a_finished_folder_runs_nothing_and_exports_again(small, tmp_path, monkeypatch):
    frame = small(out=tmp_path)
    before = contents(tmp_path)
    (tmp_path / HUNTS_FILE).unlink()
    monkeypatch.setattr(batches, "run_hunt", None)
    assert small(out=tmp_path).equals(frame)
    assert contents(tmp_path) == before


def test_the_learned_model_is_kept_with_the_hunts(tmp_path, monkeypatch):
    what = {"runs": 1, "seed": 2, "planners": ["reactive"], "arenas": ["open"], "out": tmp_path}
    frame = evaluate("paper", **what)
    monkeypatch.setattr(runner, "learn_model", None)
    assert evaluate("paper", **what).equals(frame)


@pytest.mark.parametrize(
    ("change", "difference"),
    [
        ({"seed": 5}, "seed is 4 there and 5 here"),
        ({"runs": 3}, "protocol.runs is 2 there and 3 here"),
        ({"planners": ["reactive"]}, "planners is reactive, prediction there and reactive here"),
        ({"arenas": ["walled"]}, "arenas is open there and walled here"),
        ({"model": None}, "the model is given with --model there and learned from the seed here"),
    ],
)
def test_another_experiment_is_refused_by_its_difference(small, tmp_path, change, difference):
    small(out=tmp_path)
    before = contents(tmp_path)
    with pytest.raises(ResultsError) as error:
        small(out=tmp_path, **change)
    assert str(error.value) == f"{tmp_path} holds another experiment: {difference}; choose another --out"
    assert contents(tmp_path) == before


def test_other_settings_another_model_or_other_versions_are_refused(small, tmp_path, khepera_model, monkeypatch):
    small(out=tmp_path)
    slower = runner.load_experiment("paper", {"prey.speed": 0.04, "protocol.runs": 2})
    with pytest.raises(ResultsError, match=r"prey\.speed is 0\.048 there and 0\.04 here"):
        evaluate(
            slower, seed=4, planners=["reactive", "prediction"], arenas=["open"], model=khepera_model, out=tmp_path
        )
    with pytest.raises(ResultsError, match="the model has fingerprint"):
        small(out=tmp_path, model=type(khepera_model)(khepera_model.joint, prior=1.0))
    monkeypatch.setattr("bayeshunt.experiments.store.identity._version", lambda name: "9.9")
    with pytest.raises(ResultsError, match=r"version of bayeshunt is \S+ there and 9\.9 here"):
        small(out=tmp_path)


def test_a_file_that_a_planner_uses_is_part_of_the_experiment(tmp_path):
    tables = tmp_path / "tables.json"
    settings = runner.load_experiment("paper", {"planner.memory.tables": str(tables)})
    identities = []
    for content in ("one", "two"):
        tables.write_text(content)
        identities.append(Identity.of(settings, ["memory"], ["open"], 0, None))
    assert identities[0].difference(identities[0]) is None
    assert "SHA-256 of the file planner.memory.tables is " in identities[0].difference(identities[1])
    other = Identity.of(settings, ["reactive"], ["open"], 0, None)  # which does not use it
    assert not other.files


def test_a_file_that_the_prey_is_of_is_part_of_the_experiment(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("counts").write_text("a file that is called as the prey model that ships")
    plain = Identity.of(runner.load_experiment("paper"), ["reactive"], ["open"], 0, None)
    assert not plain.files
    for key, value, file in (
        ("prey.model", "walkers.JSON", "walkers.JSON"),
        ("prey.behaviour", "recorded:some#tracks.parquet#17@a", "some#tracks.parquet"),
    ):
        settings = runner.load_experiment("paper", {key: value})
        identities = []
        for content in ("one", "two"):
            Path(file).write_text(content)
            identities.append(Identity.of(settings, ["reactive"], ["open"], 0, None))
        one, two = identities
        assert one.difference(one) is None
        assert list(one.files) == [key]
        assert f"SHA-256 of the file {key} is " in one.difference(two)
        earlier = replace(one, files={})  # when the prey's files were not noted
        assert earlier.difference(two) is None
        assert "SHA-256 of the file with prey mine is not given" in earlier.difference(
            replace(two, files={**two.files, "with prey mine": "a" * 64})
        )


def test_hunts_of_another_prey_in_a_file_of_that_name_do_not_mix(khepera_model, tmp_path):
    file, out = tmp_path / "prey.json", tmp_path / "results"
    settings = runner.load_experiment("paper", {"prey.model": str(file), "protocol.thetas": [1.0], "protocol.runs": 1})
    known = PreyModel()
    known.save(file)
    evaluate(settings, planners="prediction", arenas="open", model=khepera_model, out=out)
    known.observe(Polar(0.02, 0.1, 0.1))
    known.save(file)
    with pytest.raises(ResultsError, match=r"holds another experiment: SHA-256 of the file prey\.model is "):
        evaluate(settings, planners="prediction", arenas="open", model=khepera_model, out=out)


def test_exported_results_of_another_experiment_are_not_overwritten(small, tmp_path):
    small(out=tmp_path)
    (tmp_path / DATABASE_FILE).unlink()
    for change in ({"seed": 5}, {"runs": 3}, {"planners": ["reactive"]}, {"arenas": ["walled"]}):
        with pytest.raises(ResultsError, match="results of another experiment"):
            small(out=tmp_path, **change)
    small(out=tmp_path)  # the same experiment may make its own again


def test_a_second_process_is_refused(small, tmp_path):
    with FolderLock(tmp_path):
        assert is_locked(tmp_path)
        with pytest.raises(FolderInUseError, match=f"watch it with: bayeshunt status {tmp_path}"):
            small(out=tmp_path)
    assert not is_locked(tmp_path)
    small(out=tmp_path)


def change_database(folder, statement):
    with closing(sqlite3.connect(folder / DATABASE_FILE)) as connection, connection:
        connection.execute(statement)


def test_a_damaged_row_is_run_again_and_said(small, tmp_path):
    frame = small(out=tmp_path)
    change_database(tmp_path, "UPDATE hunts SET time = 1.0 WHERE number = 3")
    news = []
    assert small(out=tmp_path, say=news.append).equals(frame)
    assert len(news) == 1
    assert "1 damaged rows dropped; their hunts are run again" in news[0]


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("UPDATE about SET value = replace(value, '4', '5') WHERE key = 'identity'", "does not match its checksum"),
        ("CREATE TRIGGER t AFTER INSERT ON hunts BEGIN DELETE FROM hunts; END", "does not match its checksum"),
        ("UPDATE about SET value = '3' WHERE key = 'format'", "format '3', this version reads 2"),
        ("UPDATE about SET value = '1' WHERE key = 'format'", "hunts of an earlier version"),
        ("UPDATE about SET value = 'x' WHERE key = 'kind'", "not a database of hunts"),
    ],
)
def test_an_altered_database_is_refused_in_one_line(small, tmp_path, statement, message):
    small(out=tmp_path)
    change_database(tmp_path, statement)
    with pytest.raises(ResultsError, match=message) as error:
        small(out=tmp_path)
    assert "\n" not in str(error.value)


def test_a_file_that_is_no_database_is_refused(small, tmp_path):
    (tmp_path / DATABASE_FILE).write_text("hello, I am a text file that is long enough to be looked at" * 100)
    with pytest.raises(ResultsError, match="move it away"):
        small(out=tmp_path)


def test_a_database_that_was_never_finished_making_is_made_again(small, tmp_path):
    (tmp_path / DATABASE_FILE).touch()
    assert len(small(out=tmp_path)) == 28


def test_a_database_that_vanishes_is_noticed(small, tmp_path, monkeypatch):
    monkeypatch.setattr(batches, "_BATCH", 3)

    def remove(_):
        (tmp_path / DATABASE_FILE).unlink(missing_ok=True)

    with pytest.raises(BayesHuntError, match=r"removed or replaced while hunts were running|cannot be used"):
        small(out=tmp_path, progress=remove)
    assert not (tmp_path / HUNTS_FILE).exists()


def test_a_folder_that_cannot_be_made_is_one_line(small, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be used as an output folder"):
        small(out=tmp_path / "file")


def test_status_of_a_folder_without_hunts(tmp_path):
    with pytest.raises(ResultsError, match=f"no {DATABASE_FILE} here; start one with: bayeshunt evaluate"):
        status(tmp_path)


def test_suggested_lines_can_be_pasted_whatever_the_folder_is_called(small, tmp_path):
    folder = tmp_path / "my results"
    for reader in (status, load_results):
        with pytest.raises(InputError, match=f"with: bayeshunt evaluate --out '{folder}'$"):
            reader(folder)
    folder.mkdir()
    with FolderLock(folder), pytest.raises(FolderInUseError, match=f"watch it with: bayeshunt status '{folder}'$"):
        small(out=folder)


def test_status_counts_by_planner(small, tmp_path):
    frame = small(out=tmp_path)
    found = status(tmp_path)
    assert (found.ended, found.planned, found.running, found.rate) == (28, 28, False, None)
    assert [(s.planner, s.arena, s.ended, s.planned) for s in found.shares] == [
        ("reactive", "open", 14, 14),
        ("prediction", "open", 14, 14),
    ]
    assert sum(share.caught for share in found.shares) == frame["caught"].sum()


def test_status_of_a_running_evaluation_has_a_rate(small, tmp_path):
    seen = []
    small(out=tmp_path, progress=lambda _: seen.append(status(tmp_path)))
    assert all(s.running and s.rate > 0 for s in seen)
    assert seen[0].seconds_left == pytest.approx((28 - seen[0].ended) / seen[0].rate)


def test_the_same_hunt_twice_stays_one_row(small, tmp_path):
    small(out=tmp_path)
    with HuntDatabase.open(tmp_path) as database:
        results, _ = database.results()
        hunts = [runner.Numbered(n, t) for n, t in enumerate(runner.plan_hunts(
            runner.experiment_settings("paper", 2), ["reactive", "prediction"], ["open"], 4))]  # fmt: skip
        database.add_all((hunt, results[hunt.number]) for hunt in hunts)
        assert database.results() == (results, [])


def test_reading_half_an_evaluation_says_how_far_it_is(small, tmp_path):
    with pytest.raises(StopError):
        small(out=tmp_path, progress=stop_after(5))
    with pytest.raises(BayesHuntError, match=r"\d+ of 28 hunts are done; give the same evaluate line again"):
        load_results(tmp_path)


def test_a_worker_that_stands_in_another_folder_finds_the_database(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asked = Identity.of(load_experiment("paper"), ["reactive"], ["open"], 0, None)
    Path("results").mkdir()
    with HuntDatabase.create(Path("results"), asked, "{}") as database:
        monkeypatch.chdir("/")
        with database.sink.opened() as writer:
            assert writer is not None
