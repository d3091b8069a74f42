"""The model that depends on the gait before: stored, exported, assessed, refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from previous_cases import AXES, GAITS, ORDER, enumerate_joint, fit, momentum

import bayeshunt as bh
from bayeshunt.core.bins import EFFECTS
from bayeshunt.data import babbling_table
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.previous import previous_codes
from bayeshunt.models.counting.streaming import count_tables, open_tables
from bayeshunt.models.formats import xmlbif
from bayeshunt.models.formats.model_file import _checksum, dumps
from bayeshunt.models.tables.structures import PREVIOUS_GAIT

FRAME = momentum(300, 0)


# --- values ----------------------------------------------------------------------------------------


def test_file_round_trip(tmp_path: Path) -> None:
    model = fit(momentum(200, 6, starts=2), 0.1, "empirical")
    model.save(tmp_path / "model.json")
    back = bh.ForwardModel.load(tmp_path / "model.json")
    assert back == model
    assert back.structure == PREVIOUS_GAIT
    assert dumps(back) == dumps(model)
    for name, table in model.local_tables.items():
        assert np.array_equal(back.local_tables[name], table)
    for one, two in zip(back.by_previous.after, model.by_previous.after, strict=True):
        assert np.array_equal(one.sums, two.sums)


def test_paths_survive_the_file(khepera_frame: pd.DataFrame) -> None:
    gaits = bh.load_robot("khepera").gaits
    model = bh.ForwardModel.fit(khepera_frame, gaits, 0.1, structure="previous_gait")
    back = bh.ForwardModel.loads(dumps(model))
    assert back == model
    assert np.array_equal(back.after("straight").mean_paths, model.after("straight").mean_paths)
    assert not np.array_equal(back.after("straight").mean_paths, model.mean_paths)


def test_only_this_structure_needs_the_new_format() -> None:
    naive = bh.ForwardModel.fit(FRAME, GAITS, axes=AXES)
    assert json.loads(dumps(fit(FRAME)))["format"] == 3
    record = json.loads(dumps(naive))
    assert record["format"] == 2
    for version in (1, 2, 3):  # what was written before, and what may be written later
        older = json.loads(dumps(naive))
        older["format"] = version
        if version == 1:
            del older["content"]["structure"]
        older["checksum"] = _checksum(older["content"])
        assert bh.ForwardModel.loads(json.dumps(older)) == naive


@pytest.mark.parametrize(
    "damage",
    [
        lambda content: content["cells"][0].__setitem__(0, 3),
        lambda content: content["cells"].reverse(),
        lambda content: content["pose_sums"].pop(),
        lambda content: content["structure"]["edges"].pop(),
        lambda content: content.update(cells=[row[1:] for row in content["cells"]]),
    ],
)
def test_malformed_files_are_refused(damage) -> None:
    record = json.loads(dumps(fit(FRAME)))
    damage(record["content"])
    record["checksum"] = _checksum(record["content"])
    with pytest.raises(bh.BayesHuntError, match="malformed content"):
        bh.ForwardModel.loads(json.dumps(record))


def test_models_travel_to_other_processes(worker) -> None:
    model = fit(FRAME, 0.1)
    assert worker(model) == model
    part = worker(model.after("b"))
    assert part == model.after("b")
    assert part != model.after("c")
    assert hash(part) == hash(model.after("b"))
    answer = worker(bh.InverseModel(model).after("b"))
    assert answer.posterior(0.1, 0.2).values.tolist() == bh.InverseModel(part).posterior(0.1, 0.2).values.tolist()


# --- interchange -----------------------------------------------------------------------------------


def test_xmlbif_is_read_back_with_the_same_posterior(tmp_path: Path) -> None:
    from pgmpy.inference import VariableElimination
    from pgmpy.readwrite import XMLBIFReader

    gum = pytest.importorskip("pyagrum")
    model = fit(FRAME)
    model.to_xmlbif(tmp_path / "m.bifxml")
    read = XMLBIFReader(str(tmp_path / "m.bifxml")).get_model()
    assert set(read.edges()) == set(PREVIOUS_GAIT.edges)
    maps = {v: {label: name for name, label in names.items()} for v, names in xmlbif.safe_labels(model).items()}
    assert set(maps) == set(ORDER)
    engine, inverse = VariableElimination(read), bh.InverseModel(model)
    second = gum.loadBN(str(tmp_path / "m.bifxml"))
    for name in (*GAITS, None):
        for cell in list(inverse.after(name).table().itertuples())[::3]:
            answer = inverse.after(name).posterior(cell.distance, cell.angle)
            evidence = {variable: maps[variable][label] for variable, label in answer.evidence.items()}
            theirs = engine.query(["Gait"], evidence=evidence, show_progress=False)
            values = [theirs.get_value(Gait=maps["Gait"][gait]) for gait in GAITS]
            np.testing.assert_allclose(answer.values, values, rtol=0, atol=1e-12)
            other = gum.LazyPropagation(second)
            other.setEvidence(evidence)
            other.makeInference()
            order = [second.variable("Gait").index(maps["Gait"][gait]) for gait in GAITS]
            np.testing.assert_allclose(answer.values, other.posterior("Gait").toarray()[order], rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["xmlbif", "bif"])
def test_a_network_with_the_gait_before_is_read(kind: str, tmp_path: Path, worker) -> None:
    """Our own export, and one that pgmpy writes: the same answers, without counts."""
    model, path = fit(FRAME, 0.2, "empirical"), tmp_path / f"m.{kind}"
    if kind == "xmlbif":
        model.to_xmlbif(path)
    else:
        from pgmpy.readwrite import BIFWriter, XMLBIFReader

        model.to_xmlbif(tmp_path / "m.xmlbif")
        BIFWriter(XMLBIFReader(str(tmp_path / "m.xmlbif")).get_model()).write(str(path))
        xmlbif.labels_path(path).write_text(xmlbif.labels_path(tmp_path / "m.xmlbif").read_text())
    read = bh.import_network(path)
    assert read.structure == PREVIOUS_GAIT
    assert set(read.local_tables) == set(model.local_tables)
    for name, table in model.local_tables.items():
        np.testing.assert_allclose(read.local_tables[name], table, rtol=0, atol=1e-12 if kind == "xmlbif" else 1e-7)
    again = worker(read)
    assert again == read
    for name in (*GAITS, None):
        part = read.after(name)
        assert part.known == ({} if name is None else {"PreviousGait": name})
        for effect in EFFECTS:
            expected = model.after(name).probabilities(effect)
            np.testing.assert_allclose(part.probabilities(effect), expected, rtol=0, atol=1e-7)
        answer = bh.InverseModel(read).after(name).posterior(0.07, 0.3)
        expected = bh.InverseModel(model).after(name).posterior(0.07, 0.3)
        if answer.cell == expected.cell:
            np.testing.assert_allclose(answer.values, expected.values, rtol=0, atol=1e-7)
        assert answer.support is None
    assert bh.make_planner("planning", read, depth=2).rollouts_after.keys() == set(GAITS)


def test_half_a_second_cause_is_refused(tmp_path: Path) -> None:
    model, path = fit(FRAME), tmp_path / "m.xmlbif"
    model.to_xmlbif(path)
    text = path.read_text()
    cut = text.replace("<GIVEN>PreviousGait</GIVEN>", "", 1)
    first = cut.index("<FOR>Distance</FOR>")
    start, end = cut.index("<TABLE>", first) + 7, cut.index("</TABLE>", first)
    cut = cut[:start] + " ".join(cut[start:end].split()[: 3 * model.axes.distance.bins]) + cut[end:]
    path.write_text(cut)
    with pytest.raises(bh.InputError, match=r"m\.xmlbif: with PreviousGait among the causes"):
        bh.import_network(path)


def test_csv_has_every_table_with_its_counts(tmp_path: Path) -> None:
    model = fit(FRAME)
    model.to_csv(tmp_path)
    for effect in EFFECTS:
        cells = pd.read_csv(tmp_path / f"{effect.lower()}.csv")
        assert cells.columns.tolist() == [
            "previous_gait", "gait", "bin", "low", "high", "probability", "count", "ci_low", "ci_high",
        ]  # fmt: skip
        counts = model.counted_cells.tabulate(("PreviousGait", "Gait", effect))
        assert cells["count"].tolist() == counts.ravel().tolist()
        shares = np.moveaxis(model.local_tables[effect], (2, 1, 0), (0, 1, 2))
        np.testing.assert_allclose(cells["probability"], shares.ravel(), rtol=0, atol=1e-15)
        assert cells["previous_gait"].unique().tolist() == list(GAITS)
    assert len(model.cells("Gait")) == len(GAITS)


# --- assessing -------------------------------------------------------------------------------------


def test_a_model_given_is_scored_given_the_gait_before() -> None:
    model = fit(FRAME, 0.2)
    found = bh.assess(FRAME, GAITS, model=model, structures=["previous_gait"], permutations=9, seed=0)
    whole = enumerate_joint(model)
    parts = []
    codes = babbling_table.discretise(FRAME, model.gaits, model.axes)
    for before, (gait, *bins) in zip(previous_codes(FRAME, model.gaits), codes, strict=True):
        joint = whole.sum(axis=0) if before < 0 else whole[before] / whole[before].sum()
        parts.append(joint[(gait, *bins)] / joint[gait].sum())
    assert found.given["log_loss"] == pytest.approx(-np.log(parts).mean(), rel=1e-12)
    assert found.given["same_rows"]
    other = bh.assess(momentum(90, 8), GAITS, model=model, structures=["tan"], permutations=9, seed=0)
    assert not other.given["same_rows"]
    with pytest.raises(bh.InputError, match="no column previous_gait"):
        bh.assess(FRAME.drop(columns="previous_gait"), GAITS, model=model, permutations=9, seed=0)


# --- refusals --------------------------------------------------------------------------------------


def test_a_table_that_does_not_say_what_went_before_is_refused() -> None:
    with pytest.raises(bh.DataError, match="column 'previous_gait' is missing"):
        fit(FRAME.drop(columns="previous_gait"))
    with pytest.raises(bh.DataError, match="gait 'a' has no rows"):
        fit(FRAME.assign(previous_gait=None))


def test_an_unknown_gait_before_is_named_with_its_file_and_row(tmp_path: Path) -> None:
    frame = FRAME.copy()
    frame.loc[17, "previous_gait"] = "gallop"
    with pytest.raises(bh.DataError, match=r"row 17: previous_gait 'gallop' is not in the repertoire"):
        fit(frame)
    babbling_table.save(frame, tmp_path / "t.parquet", {})
    with pytest.raises(bh.DataError, match=r"t\.parquet: row 17: previous_gait 'gallop'"):
        count_tables(
            open_tables([tmp_path / "t.parquet"]), bh.GaitRepertoire.of(GAITS), axes=AXES, structure="previous_gait"
        )


def test_a_pair_never_babbled_needs_a_prior() -> None:
    frame = FRAME[~((FRAME["previous_gait"] == "b") & (FRAME["gait"] == "c"))]
    with pytest.raises(bh.DataError, match=r"gait 'c' was never babbled right after 'b' \(1 of 9 pairs"):
        fit(frame)
    assert fit(frame, 0.1).by_previous.pairs[1, 2] == 0


def test_counts_of_the_wrong_kind_are_refused() -> None:
    model = fit(FRAME)
    with pytest.raises(bh.InputError, match="PreviousCounts"):
        ForwardModel.from_counts(model.joint, structure="previous_gait")
    with pytest.raises(bh.InputError, match="JointCounts"):
        ForwardModel.from_counts(model.by_previous)
    with pytest.raises(bh.InputError, match="PreviousCounts"):
        model.log_likelihood(model.joint)
    with pytest.raises(bh.InputError, match=r"ForwardModel\.fit"):
        ForwardModel(model.joint, structure=PREVIOUS_GAIT)
    with pytest.raises(bh.InputError, match="unknown gait"):
        model.after("d")


def test_a_part_neither_learns_nor_is_stored(tmp_path: Path) -> None:
    part = fit(FRAME).after("a")
    with pytest.raises(bh.InputError, match="update the whole model"):
        part.update(FRAME)
    with pytest.raises(bh.InputError, match="save the whole model"):
        part.save(tmp_path / "part.json")
    assert not list(tmp_path.iterdir())


def test_nothing_changes_where_the_gait_before_does_not_matter() -> None:
    naive = bh.ForwardModel.fit(FRAME, GAITS, axes=AXES)
    inverse = bh.InverseModel(naive)
    assert naive.after("b") is naive
    assert inverse.after("b") is inverse
    with pytest.raises(bh.InputError, match="unknown gait"):
        naive.after("d")
    with pytest.raises(bh.InputError, match="unknown gait"):
        bh.InverseModel(fit(FRAME)).after("d")
