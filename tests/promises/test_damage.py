"""1,000 corrupted files of each kind: no hang, no traceback, nothing silently different.

A corrupted file is refused in one line, or gives exactly what the intact one gives. Two kinds have
more to say: a damaged row of the results store is dropped and named, so that its hunt is run again;
a settings file is meant to be edited, so that a changed value is a changed experiment, and what was
begun with the intact file refuses to go on, naming the value.
"""

import contextlib
import shutil
import signal
import sqlite3
from importlib import resources

import numpy as np
import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.data import babbling_table
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.loop import hunt
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.store.database import DATABASE_FILE, HuntDatabase
from bayeshunt.experiments.store.export import HUNTS_FILE, load_results
from bayeshunt.experiments.store.identity import Identity
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.registry import make_planner

pytestmark = pytest.mark.slow

CASES = 1000
HUNTS = {"runs": 10, "seed": 3, "planners": ["reactive"], "arenas": ["open"]}


def flip(data, rng):
    """One to three bits."""
    for place in rng.integers(0, len(data), int(rng.integers(1, 4))):
        data[place] ^= 1 << int(rng.integers(0, 8))
    return data


def cut(data, rng):
    """The end is missing."""
    return data[: int(rng.integers(0, len(data)))]


def swap(data, rng):
    """Two blocks have changed places."""
    size = int(rng.integers(1, min(512, len(data) // 3)))
    one, two = sorted(rng.integers(0, len(data) - size, 2).tolist())
    if two - one < size:
        return flip(data, rng)
    data[one : one + size], data[two : two + size] = data[two : two + size], data[one : one + size]
    return data


def blank(data, rng):
    """A block of zeros, as after a crash of the file system."""
    start = int(rng.integers(0, len(data)))
    end = min(len(data), start + int(rng.integers(1, 512)))
    data[start:end] = bytes(end - start)
    return data


def corruptions(intact):
    """Yield CASES corrupted versions of some bytes, each different from the intact one."""
    rng = np.random.default_rng(len(intact))
    made = 0
    while made < CASES:
        for damage in (flip, cut, swap, blank):
            data = bytes(damage(bytearray(intact), rng))
            if data != intact and made < CASES:
                made += 1
                yield data


@contextlib.contextmanager
def at_most(seconds):
    """Fail if the block hangs."""

    def late(*unused):
        raise AssertionError(f"hung for {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def check_line(error, case):
    """What is refused is refused in one line."""
    assert str(error), case
    assert "\n" not in str(error), case


def outcomes(path, load, same):
    """Load every corrupted version of the file; return how many were refused, and how many made no difference."""
    intact = path.read_bytes()
    refused = equal = 0
    for number, data in enumerate(corruptions(intact)):
        path.write_bytes(data)
        try:
            with at_most(20):
                loaded = load(path)
        except BayesHuntError as error:
            check_line(error, number)
            refused += 1
        else:
            assert same(loaded), f"case {number}: loaded, and different"
            equal += 1
    path.write_bytes(intact)
    return refused, equal


def test_models(model_file, tmp_path, khepera_model, figure):
    path = shutil.copy(model_file, tmp_path / "model.json")
    source = dict(khepera_model.provenance)
    refused, equal = outcomes(path, ForwardModel.load, lambda m: m == khepera_model and dict(m.provenance) == source)
    assert refused > 0.9 * CASES
    figure(f"d. {CASES} corrupted model files: {refused} refused in one line, {equal} without a difference")


def test_data_sets(tmp_path, khepera_frame, figure):
    path = tmp_path / "b.parquet"
    babbling_table.save(khepera_frame, path)
    whole = babbling_table.load(path)
    refused, equal = outcomes(
        path, babbling_table.load, lambda frame: frame.equals(whole) and frame.attrs == whole.attrs
    )
    assert refused > 0.9 * CASES
    figure(f"d. {CASES} corrupted data sets: {refused} refused in one line, {equal} without a difference")


def test_episodes(tmp_path, khepera_model, figure):
    path = tmp_path / "e.parquet"
    hunt("paper", make_planner("planning", khepera_model), arena="walled", theta=3.0, seed=2).save(path)
    whole = Episode.load(path)

    def same(loaded):
        texts = [(repr(e.frame.to_dict("list")), repr(e.trail.to_dict("list")), e.provenance) for e in (loaded, whole)]
        return texts[0] == texts[1]

    refused, equal = outcomes(path, Episode.load, same)
    assert refused > 0.9 * CASES
    figure(f"d. {CASES} corrupted episodes: {refused} refused in one line, {equal} without a difference")


def test_exported_results(tmp_path, khepera_model, figure):
    evaluate("paper", **HUNTS, model=khepera_model, out=tmp_path)
    whole = load_results(tmp_path)
    refused, equal = outcomes(
        tmp_path / HUNTS_FILE,
        lambda path: load_results(path.parent),
        lambda frame: frame.equals(whole) and frame.attrs == whole.attrs,
    )
    assert refused > 0.9 * CASES
    figure(f"d. {CASES} corrupted hunts.parquet: {refused} refused in one line, {equal} without a difference")


@pytest.fixture
def store(tmp_path, khepera_model):
    """A finished store, and the same one as a kill leaves it: rows still in the write-ahead log."""
    folded, killed = tmp_path / "folded", tmp_path / "killed"
    evaluate("paper", **HUNTS, model=khepera_model, out=folded)
    killed.mkdir()
    with contextlib.closing(sqlite3.connect(folded / DATABASE_FILE)) as connection:
        rows = connection.execute("SELECT * FROM hunts").fetchall()
    with HuntDatabase.open(folded) as database:
        identity, model = database.identity, database.model
        intact = database.results()[0]
    with HuntDatabase.create(killed, identity, model) as database:
        for row in rows:
            database._connection.execute(f"INSERT INTO hunts VALUES ({','.join('?' * len(row))})", row)
        kept = {p.name: p.read_bytes() for p in killed.iterdir()}
    for name, data in kept.items():
        (killed / name).write_bytes(data)
    assert len(kept[f"{DATABASE_FILE}-wal"]) > 50_000
    return folded, killed, intact


def test_results_stores(store, khepera_model, figure):
    folded, killed, intact = store
    expected = evaluate("paper", **HUNTS, model=khepera_model)
    kept = {folder: {p.name: p.read_bytes() for p in folder.iterdir()} for folder in (folded, killed)}
    tally = {"refused": 0, "equal": 0, "some rows dropped": 0}
    targets = ((folded, DATABASE_FILE), (killed, DATABASE_FILE), (killed, f"{DATABASE_FILE}-wal"))
    for folder, name in targets:
        for number, data in enumerate(corruptions(kept[folder][name])):
            if number % len(targets):
                continue  # a third of the cases each
            restore(folder, {**kept[folder], name: data})
            try:
                with at_most(20):
                    tally[look(folder, intact)] += 1
                    if number % 30 == 0:  # and all the way, to the results
                        assert evaluate("paper", **HUNTS, model=khepera_model, out=folder).equals(expected)
            except BayesHuntError as error:
                check_line(error, (name, number))
                tally["refused"] += 1
    assert min(tally.values()) > 0, tally
    figure(
        f"d. {sum(tally.values())} corrupted results stores: {tally['refused']} refused in one line, "
        f"{tally['some rows dropped']} with hunts to run again, {tally['equal']} without a difference"
    )


def restore(folder, contents):
    for path in folder.iterdir():
        path.unlink()
    for name, data in contents.items():
        (folder / name).write_bytes(data)


def look(folder, intact):
    """Read the store as an evaluation does; nothing in it may be different."""
    database = HuntDatabase.open(folder)
    if database is None:
        return "some rows dropped"  # as if never made: everything is run again
    with database:
        results, damaged = database.results()
    assert results.items() <= intact.items()
    return "some rows dropped" if damaged or len(results) < len(intact) else "equal"


def test_settings_files(tmp_path, figure):
    text = (resources.files("bayeshunt") / "config" / "presets" / "paper.toml").read_bytes()
    path = tmp_path / "paper.toml"
    path.write_bytes(text)
    mine = load_experiment(path)
    known = Identity.of(mine, mine.planners, tuple(mine.arenas), 0, None)
    changed = 0

    def same(settings):
        nonlocal changed
        if settings == mine:
            return True
        changed += 1
        difference = known.difference(Identity.of(settings, settings.planners, tuple(settings.arenas), 0, None))
        return difference is not None and "\n" not in difference

    refused, accepted = outcomes(path, load_experiment, same)
    assert refused > 0.3 * CASES
    figure(
        f"d. {CASES} corrupted settings files: {refused} refused in one line, {accepted - changed} without a "
        f"difference, {changed} are other settings: resuming is refused and names the value"
    )
