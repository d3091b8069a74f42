"""Other structures than the paper's: learned as pgmpy learns them, exact in every answer, ready to hunt."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.cells import CountedCells, conditional, mutual_information
from bayeshunt.models.formats import xmlbif
from bayeshunt.models.formats.model_file import dumps
from bayeshunt.models.tables import network
from bayeshunt.models.tables.structures import JOINT, NAIVE, bic, find_structure, search_structure, tree_augmented

GAITS = ("a", "b", "c")
AXES = EffectAxes.standard(0.05, distance_bin=1.0, angle_bins=4, heading_bins=3)
#: A network that BIC could find: two parents that may meet for the first time after babbling.
COLLIDER = bh.Structure(
    "learned", (("Gait", "Distance"), ("Gait", "Angle"), ("Distance", "Heading"), ("Angle", "Heading"))
)
STRUCTURES = ["tan", "joint", COLLIDER]
each_structure = pytest.mark.parametrize("structure", STRUCTURES, ids=["tan", "joint", "collider"])


def make_frame(n: int, seed: int) -> pd.DataFrame:
    """Random rows in which heading follows angle and angle follows distance; sparse on purpose."""
    rng = np.random.default_rng(seed)
    gait = rng.integers(0, 3, n)
    distance = np.minimum(rng.poisson(0.5 + gait), 3)
    angle = (distance + gait + (rng.random(n) < 0.3)) % 4
    heading = (angle + (rng.random(n) < 0.2)) % 3
    return pd.DataFrame(
        {
            "gait": np.array(GAITS)[gait],
            "distance": 0.05 * (distance + rng.random(n)),
            "angle": AXES.angle.centres[angle],
            "heading": AXES.heading.centres[heading],
        }
    )


FRAME = make_frame(120, 0)


def fit(structure: str | bh.Structure, prior: float = 0.5) -> bh.ForwardModel:
    return bh.ForwardModel.fit(FRAME, GAITS, prior, axes=AXES, structure=structure)


def enumerate_joint(model: bh.ForwardModel) -> np.ndarray:
    """P(Gait, Distance, Angle, Heading) by pgmpy: the product of the network's own factors."""
    factors = [cpd.to_factor() for cpd in model.network.get_cpds()]
    product = factors[0]
    for factor in factors[1:]:
        product = product * factor
    order = [product.variables.index(v) for v in network.VARIABLES]
    return np.transpose(product.values, order)


# --- learning --------------------------------------------------------------------------------------


@each_structure
@pytest.mark.parametrize("prior", [0.0, 0.5])
def test_tables_are_pgmpys_own(structure: str | bh.Structure, prior: float) -> None:
    """``fit`` compares; a wrong table of ours must make it fail, so break one and see."""
    model = fit(structure, prior)
    states = network.state_names(model.gaits, model.axes)
    fitted = network.fit_cells(model.joint.table, states, prior, model.structure)
    tables = {e: conditional(model.joint.table.tabulate((e, *model.structure.parents(e))), prior) for e in EFFECTS}
    network.check_equal(fitted, tables)
    broken = {**tables, "Angle": tables["Angle"] * 0.999}
    with pytest.raises(bh.BayesHuntError, match="Angle"):
        network.check_equal(fitted, broken)


@pytest.mark.parametrize("seed", range(6))
def test_tree_is_pgmpys_tree(seed: int) -> None:
    from pgmpy.estimators import TreeSearch

    frame = make_frame(300, seed)
    model = bh.ForwardModel.fit(frame, GAITS, axes=AXES)
    codes = babbling_table.discretise(frame, model.gaits, model.axes)
    rows = pd.DataFrame(codes, columns=list(network.VARIABLES))
    theirs = TreeSearch(rows, root_node="Distance", n_jobs=1).estimate(
        estimator_type="tan", class_node="Gait", show_progress=False
    )
    assert set(tree_augmented(model.joint.table).edges) == set(theirs.edges())


@pytest.mark.parametrize("seed", range(3))
def test_search_uses_pgmpys_bic(seed: int) -> None:
    from pgmpy.structure_score import BIC

    frame = make_frame(300, seed)
    model = bh.ForwardModel.fit(frame, GAITS, axes=AXES)
    states = network.state_names(model.gaits, model.axes)
    codes = babbling_table.discretise(frame, model.gaits, model.axes)
    names = list(network.VARIABLES)
    rows = pd.DataFrame({v: np.array(states[v])[codes[:, i]] for i, v in enumerate(names)})
    score = BIC(rows, state_names=states)
    for effect in EFFECTS:
        others = [v for v in names if v != effect]
        for parents in (p for size in range(4) for p in combinations(others, size)):
            assert bic(model.joint.table, effect, parents) == pytest.approx(score.local_score(effect, parents))


def test_search_finds_the_best_of_all_networks() -> None:
    """Three effects allow few networks: hill climbing must not stop below the best of them here."""
    frame = make_frame(4000, 9)
    table = bh.ForwardModel.fit(frame, GAITS, axes=AXES).joint.table
    found = search_structure(table)

    def score(structure: bh.Structure) -> float:
        return sum(bic(table, effect, structure.parents(effect)) for effect in EFFECTS)

    best = max(score(s) for s in all_structures())
    assert score(found) == pytest.approx(best, rel=1e-12)
    assert score(found) > score(NAIVE)


def all_structures() -> list[bh.Structure]:
    possible = [("Gait", e) for e in EFFECTS] + [(a, b) for a in EFFECTS for b in EFFECTS if a != b]
    found = []
    for size in range(7):
        for edges in combinations(possible, size):
            try:
                found.append(bh.Structure("learned", edges))
            except bh.InputError:
                continue
    return found


@pytest.mark.slow
def test_search_does_not_depend_on_the_hash_seed() -> None:
    code = (
        "import numpy as np\n"
        "from bayeshunt.models.counting.cells import CountedCells\n"
        "from bayeshunt.models.tables.structures import find_structure\n"
        "rng = np.random.default_rng(0); x = rng.integers(0, 3, 500)\n"
        "rows = np.column_stack([rng.integers(0, 2, 500), x, x, x])\n"
        "table = CountedCells.of_rows(('Gait', 'Distance', 'Angle', 'Heading'), (2, 3, 3, 3), rows)\n"
        "print(find_structure('learned', table).edges)\n"
    )
    printed = set()
    for seed in range(4):
        environment = {**os.environ, "PYTHONHASHSEED": str(seed)}
        run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
        printed.add(run.stdout)
    assert len(printed) == 1


def test_information_by_hand() -> None:
    perfect = np.zeros((2, 2, 1), dtype=np.int64)
    perfect[0, 0], perfect[1, 1] = 3, 3
    assert mutual_information(perfect) == pytest.approx(np.log(2))
    assert mutual_information(np.full((2, 2, 3), 5)) == pytest.approx(0)


# --- answers ---------------------------------------------------------------------------------------


@each_structure
def test_every_answer_equals_enumeration(structure: str | bh.Structure) -> None:
    model = fit(structure)
    joint = enumerate_joint(model)
    assert joint.sum() == pytest.approx(1, abs=1e-12)
    for i, effect in enumerate(EFFECTS):
        others = tuple(1 + k for k in range(3) if k != i)
        np.testing.assert_allclose(model.probabilities(effect), joint.sum(axis=others).T * 3, atol=1e-12)
    inverse = bh.InverseModel(model)
    for cell in inverse.table().itertuples():
        answer = inverse.posterior(cell.distance, cell.angle, snap=False)
        d, a = answer.cell.distance_bin, answer.cell.angle_bin
        expected = joint[:, d, a].sum(axis=1)
        np.testing.assert_allclose(answer.values, expected / expected.sum(), atol=1e-12)
        assert answer.evidence_probability == pytest.approx(expected.sum(), abs=1e-12)
        for h, heading in enumerate(model.axes.heading.centres):
            with_heading = inverse.posterior(cell.distance, cell.angle, heading, snap=False)
            np.testing.assert_allclose(with_heading.values, joint[:, d, a, h] / joint[:, d, a, h].sum(), atol=1e-12)
    targets = FRAME["distance"].to_numpy(), FRAME["angle"].to_numpy()
    many = inverse.posterior_many(*targets)
    for row, (distance, angle) in zip(many, zip(*targets, strict=True), strict=True):
        assert np.array_equal(row, inverse.posterior(distance, angle).values)


@each_structure
def test_a_second_engine_agrees(structure: str | bh.Structure) -> None:
    from pgmpy.inference import VariableElimination

    model = fit(structure)
    engine = VariableElimination(model.network)
    inverse = bh.InverseModel(model)
    for cell in list(inverse.table().itertuples())[::3]:
        answer = inverse.posterior(cell.distance, cell.angle, snap=False)
        theirs = engine.query(["Gait"], evidence=answer.evidence, show_progress=False)
        np.testing.assert_allclose(answer.values, theirs.values, atol=1e-12)


@each_structure
def test_explanations_add_up(structure: str | bh.Structure) -> None:
    inverse = bh.InverseModel(fit(structure))
    for cell in inverse.table().itertuples():
        for heading in (None, 0.0):
            parts = inverse.posterior(cell.distance, cell.angle, heading).explain()
            total = parts[["prior", *EFFECTS]].sum(axis=1)
            np.testing.assert_allclose(total, parts["log_odds"], atol=1e-9)


@each_structure
def test_samples_follow_the_joint_table(structure: str | bh.Structure) -> None:
    model = fit(structure, 0.0)
    joint, n = enumerate_joint(model) * 3, 40_000
    for gait, name in enumerate(GAITS):
        drawn = model.sample(name, n, rng=np.random.default_rng(gait))
        bins = tuple(axis.index(values) for axis, values in zip(model.axes, drawn, strict=True))
        seen = np.zeros(joint.shape[1:])
        np.add.at(seen, bins, 1)
        assert not seen[joint[gait] == 0].any()
        spread = np.sqrt(joint[gait] * (1 - joint[gait]) / n)
        assert (np.abs(seen / n - joint[gait]) <= 5.5 * spread + 1e-12).all()


@each_structure
def test_outcomes_are_what_sample_draws(structure: str | bh.Structure) -> None:
    model = fit(structure)
    uniforms = np.random.default_rng(1).random((2, 5, 6))
    outcomes = model.outcomes(uniforms)
    assert outcomes.distance.shape == (3, 2, 5)
    one = model.sample("b", 5, rng=_Given(uniforms[1]))
    for ours, theirs in zip(one, outcomes, strict=True):
        assert np.array_equal(ours, theirs[1, 1])


class _Given(np.random.Generator):
    """A generator that hands out given numbers."""

    def __init__(self, numbers: np.ndarray) -> None:
        super().__init__(np.random.PCG64(0))
        self.numbers = numbers

    def random(self, shape: tuple[int, int]) -> np.ndarray:
        assert shape == self.numbers.shape
        return self.numbers


@each_structure
def test_log_likelihood_is_the_sum_of_log_joint(structure: str | bh.Structure) -> None:
    model = fit(structure)
    joint = enumerate_joint(model)
    cells = babbling_table.discretise(FRAME, model.gaits, model.axes)
    assert model.log_likelihood(FRAME) == pytest.approx(np.log(joint[tuple(cells.T)]).sum(), rel=1e-12)


# --- values ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("structure", ["naive", "joint"])
def test_update_equals_one_batch_fit(structure: str) -> None:
    whole = fit(structure)
    parts = bh.ForwardModel.fit(FRAME[:50], GAITS, 0.5, axes=AXES, structure=structure).update(FRAME[50:])
    assert parts == whole
    for effect in EFFECTS:
        assert np.array_equal(parts.local_tables[effect], whole.local_tables[effect])


@pytest.mark.parametrize("structure", ["naive", "joint"])
def test_local_tables_are_read_only(structure: str) -> None:
    for table in fit(structure).local_tables.values():
        with pytest.raises(ValueError, match="read-only"):
            table[0] = 1.0


def test_update_keeps_the_edges() -> None:
    model = fit("tan")
    assert model.update(make_frame(50, 4)).structure == model.structure


@each_structure
def test_file_round_trip(structure: str | bh.Structure, tmp_path: Path) -> None:
    model = fit(structure)
    model.save(tmp_path / "model.json")
    back = bh.ForwardModel.load(tmp_path / "model.json")
    assert back == model
    assert back.structure == model.structure
    assert dumps(back) == dumps(model)
    assert model != fit("naive")


def test_files_from_before_structures_still_load() -> None:
    model = fit("naive")
    record = json.loads(dumps(model))
    del record["content"]["structure"]
    record["format"] = 1
    from bayeshunt.models.formats.model_file import _checksum

    record["checksum"] = _checksum(record["content"])
    assert bh.ForwardModel.loads(json.dumps(record)) == model


def test_xmlbif_carries_the_structure(tmp_path: Path) -> None:
    from pgmpy.inference import VariableElimination
    from pgmpy.readwrite import XMLBIFReader

    model = fit("tan")
    model.to_xmlbif(tmp_path / "model.xmlbif")
    read = XMLBIFReader(str(tmp_path / "model.xmlbif")).get_model()
    assert set(read.edges()) == set(model.structure.edges)
    names = {variable: list(labels) for variable, labels in xmlbif.safe_labels(model).items()}
    evidence = {"Distance": names["Distance"][1], "Angle": names["Angle"][2]}
    found = VariableElimination(read).query(["Gait"], evidence=evidence, show_progress=False)
    values = model.evidence(1, 2)
    order = [found.state_names["Gait"].index(name) for name in names["Gait"]]
    np.testing.assert_allclose(found.values[order], values / values.sum(), atol=1e-12)


def test_equal_edges_are_equal_structures() -> None:
    assert bh.Structure("joint", tuple(reversed(JOINT.edges))) == JOINT
    assert NAIVE.describe() == "P(Distance | Gait) P(Angle | Gait) P(Heading | Gait)"


# --- refusals --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "edges", "says"),
    [
        ("magic", (), "magic"),
        ("learned", (("Distance", "Gait"),), "not allowed"),
        ("learned", (("Gait", "Speed"),), "not allowed"),
        ("learned", (("Distance", "Angle"), ("Angle", "Distance")), "circle"),
    ],
)
def test_wrong_structures_are_refused(name: str, edges: tuple, says: str) -> None:
    with pytest.raises(bh.InputError, match=says):
        bh.Structure(name, edges)


def test_unknown_structures_are_refused() -> None:
    with pytest.raises(bh.InputError, match="unknown structure 'tann'"):
        fit("tann")
    mixed = bh.Structure("learned", (("Gait", "Distance"), ("PreviousGait", "Distance"), ("Gait", "Angle")))
    with pytest.raises(bh.InputError, match="'previous_gait' alone"):
        fit(mixed)


def test_parents_that_never_met_need_a_prior() -> None:
    few = make_frame(12, 0)
    with pytest.raises(bh.ZeroCountError, match="fit with a prior > 0"):
        bh.ForwardModel.fit(few, GAITS, 0.0, axes=AXES, structure=COLLIDER)
    assert bh.ForwardModel.fit(few, GAITS, 0.1, axes=AXES, structure=COLLIDER).structure == COLLIDER


def test_huge_tables_are_refused_before_they_are_allocated() -> None:
    fine = EffectAxes.standard(0.05, angle_bins=3600, heading_bins=3600)
    with pytest.raises(bh.InputError, match="use fewer or wider bins"):
        bh.ForwardModel.fit(FRAME, GAITS, axes=fine, structure="joint")


def test_find_structure_knows_its_names() -> None:
    table = CountedCells.of_rows(("Gait", *EFFECTS), (1, 1, 1, 1), np.zeros((3, 4), dtype=np.int64))
    assert find_structure("naive", table) is NAIVE
    assert find_structure("joint", table) is JOINT
    with pytest.raises(bh.InputError):
        find_structure("nothing", table)


# --- hunting ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("structure", ["tan", "joint", "learned"])
def test_every_structure_hunts(structure: str, tmp_path: Path) -> None:
    frame = bh.babble("khepera", steps=500, seed=0)
    path = tmp_path / "model.json"
    bh.ForwardModel.fit(frame, bh.load_robot("khepera").gaits, structure=structure).save(path)
    model = bh.ForwardModel.load(path)
    for name in ("reactive", "prediction", "planning"):
        one, again = (bh.hunt("paper", bh.make_planner(name, model), theta=3.0, seed=1) for _ in range(2))
        assert one.frame["gait"].tolist() == again.frame["gait"].tolist()
        assert one.time == again.time
    assert one.caught


@pytest.mark.parametrize(("structure", "status"), [("tan", 0), ("previous_gait", 0), ("tann", 2)])
def test_the_command_fits_a_structure(structure: str, status: int, tmp_path: Path, monkeypatch, capsys) -> None:
    from bayeshunt.cli import main

    data, out = tmp_path / "babbling.parquet", tmp_path / "model.json"
    bh.save_dataset(bh.babble("khepera", steps=200, seed=0), data)
    arguments = ["bayeshunt", "fit", str(data), "--out", str(out), "--structure", structure, "--json"]
    monkeypatch.setattr("sys.argv", arguments)
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == status
    printed = capsys.readouterr()
    assert out.exists() is (status == 0)
    if status:
        assert structure in printed.err
        assert len(printed.err.splitlines()) == 1
    else:
        assert json.loads(printed.out)["edges"] == [list(e) for e in bh.ForwardModel.load(out).structure.edges]
