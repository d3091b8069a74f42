"""Tables out as CSV, networks in from XMLBIF and BIF: the same numbers, the same answers."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.formats import interchange, xmlbif

gum = pytest.importorskip("pyagrum")

TARGETS = [(0.15, 0.3), (0.19, 0.0), (0.03, 2.0), (0.5, -1.0), (0.15, 0.3, 0.6)]


@pytest.fixture(scope="module", params=["naive", "tan", "joint"])
def pair(request, khepera_frame, khepera_model, tmp_path_factory):
    """A model and its XMLBIF export."""
    prior = 0.5 if request.param == "tan" else 0.0
    axes = bh.EffectAxes.standard(0.057, distance_bin=0.3, angle_bins=12, heading_bins=12)
    model = bh.ForwardModel.fit(khepera_frame, khepera_model.gaits, prior, structure=request.param, axes=axes)
    path = tmp_path_factory.mktemp("networks") / "model.bifxml"
    model.to_xmlbif(path)
    return model, path


def check_same_answers(model, imported, tolerance: float = 1e-12) -> None:
    ours, theirs = bh.InverseModel(model), bh.InverseModel(imported)
    for target in TARGETS:
        one = ours.posterior(*target)
        # The same cell: an import also knows cells that were possible but never babbled.
        two = theirs.posterior(one.cell.distance, one.cell.angle, one.cell.heading)
        assert two.evidence == one.evidence
        np.testing.assert_allclose(two.values, one.values, rtol=0, atol=tolerance)
        assert two.evidence_probability == pytest.approx(one.evidence_probability, abs=tolerance)


def test_an_export_comes_back(pair) -> None:
    model, path = pair
    imported = bh.import_network(path)
    for ours, theirs in zip(model.axes, imported.axes, strict=True):
        assert theirs.labels == ours.labels
        assert theirs.width == pytest.approx(ours.width, rel=1e-9)
    assert imported.gaits.names == model.gaits.names
    assert imported.structure.edges == model.structure.edges
    for variable in ("Gait", "Distance", "Angle", "Heading"):
        np.testing.assert_allclose(imported.probabilities(variable), model.probabilities(variable), rtol=0, atol=1e-12)
    check_same_answers(model, imported)


# pyAgrum writes BIF in full, but only seven digits into XMLBIF.
@pytest.mark.parametrize(("kind", "tolerance"), [("bif", 1e-12), ("bifxml", 1e-6)])
def test_what_pyagrum_wrote_comes_in(pair, kind: str, tolerance: float, tmp_path: Path) -> None:
    model, path = pair
    network = gum.loadBN(str(path))
    gum.saveBN(network, str(tmp_path / f"theirs.{kind}"))
    shutil.copy(xmlbif.labels_path(path), xmlbif.labels_path(tmp_path / f"theirs.{kind}"))
    check_same_answers(model, bh.import_network(tmp_path / f"theirs.{kind}"), tolerance)


def test_an_import_agrees_with_both_engines(pair) -> None:
    from pgmpy.inference import VariableElimination

    imported = bh.import_network(pair[1])
    theirs = gum.loadBN(str(pair[1]))
    safe = {v: {label: name for name, label in names.items()} for v, names in xmlbif.safe_labels(imported).items()}
    order = [theirs.variable("Gait").index(name) for name in safe["Gait"].values()]
    for target in TARGETS:
        answer = bh.InverseModel(imported).posterior(*target)
        query = VariableElimination(imported.network).query(["Gait"], evidence=answer.evidence, show_progress=False)
        values = [query.get_value(Gait=name) for name in imported.gaits.names]
        np.testing.assert_allclose(values, answer.values, rtol=0, atol=1e-12)
        engine = gum.LazyPropagation(theirs)
        engine.setEvidence({v: safe[v][label] for v, label in answer.evidence.items()})
        engine.makeInference()
        np.testing.assert_allclose(engine.posterior("Gait").toarray()[order], answer.values, rtol=0, atol=1e-12)


def test_states_in_another_order_are_put_in_ours(pair, tmp_path: Path) -> None:
    model, path = pair
    labels = json.loads(xmlbif.labels_path(path).read_text())
    text = path.read_text()
    # The states of Gait and Angle go by each other's names, from the last to the first.
    for variable in ("Gait", "Angle"):
        names = list(labels[variable])
        labels[variable] = dict(zip(names, reversed(list(labels[variable].values())), strict=True))
    (tmp_path / "turned.bifxml").write_text(text)
    xmlbif.labels_path(tmp_path / "turned.bifxml").write_text(json.dumps(labels))
    turned = bh.import_network(tmp_path / "turned.bifxml", gaits=model.gaits)
    np.testing.assert_allclose(turned.probabilities("Gait")[::-1], model.probabilities("Gait"), atol=1e-12)
    expected = model.probabilities("Angle")[::-1, ::-1]
    np.testing.assert_allclose(turned.probabilities("Angle"), expected, rtol=0, atol=1e-12)


def test_names_that_only_partly_agree_are_not_taken_in_order(tmp_path: Path) -> None:
    """One misspelt name among names in another order would give every gait another gait's table."""
    wanted = ("right", "left", "go")
    assert interchange._positions(["go", "left", "right"], wanted, "Gait", "net.xml") == [2, 1, 0]
    assert interchange._positions(["g0", "g1", "g2"], wanted, "Gait", "net.xml") == [0, 1, 2]  # all other names
    assert interchange._positions(["right", "left", "gogo"], wanted, "Gait", "net.xml") == [0, 1, 2]  # one renamed
    says = r"^net\.xml: Gait: the state 'go' is not in the file, which has 'goo', and the others stand in another order"
    with pytest.raises(bh.InputError, match=says):
        interchange._positions(["goo", "left", "right"], wanted, "Gait", "net.xml")


def test_the_tables_given_stay_the_callers(pair) -> None:
    model, _ = pair
    given = {name: table.copy() for name, table in model.local_tables.items()}
    imported = ForwardModel.of_tables(model.gaits, model.axes, model.structure, given)
    before = imported.probabilities("Gait").copy()
    assert all(table.flags.writeable for table in given.values())
    given["Gait"][:] = 7.0
    np.testing.assert_array_equal(imported.probabilities("Gait"), before)
    assert not imported.local_tables["Gait"].flags.writeable


def test_without_a_label_map_the_bins_must_be_given(pair, tmp_path: Path) -> None:
    model, path = pair
    alone = tmp_path / "alone.xml"
    shutil.copy(path, alone)
    with pytest.raises(
        bh.InputError, match=r"alone\.xml: the states of Distance \('mm0_17p1', \.\.\.\).*labels\.json.*axes="
    ):
        bh.import_network(alone)
    imported = bh.import_network(alone, gaits=model.gaits, axes=model.axes)
    check_same_answers(model, imported)


def test_an_import_plans_and_hunts(pair) -> None:
    model, path = pair
    imported = bh.import_network(path, gaits=model.gaits)
    uniforms = np.random.default_rng(1).random((50, 6))
    for ours, theirs in zip(model.outcomes(uniforms), imported.outcomes(uniforms), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12)
    hunts = [
        bh.hunt("paper", bh.make_planner("planning", m), arena="open", theta=1.0, seed=0) for m in (model, imported)
    ]
    assert hunts[0].frame["gait"].tolist() == hunts[1].frame["gait"].tolist()


def test_an_import_says_what_it_lacks(pair, tmp_path: Path, khepera_frame, worker) -> None:
    imported = bh.import_network(pair[1])
    for action in (
        lambda: imported.counts("Angle"),
        lambda: imported.rows("Angle", 0),
        lambda: imported.with_data(khepera_frame),
        lambda: imported.update(khepera_frame),
        lambda: imported.credible_interval("Angle"),
        lambda: imported.save(tmp_path / "model.json"),
        lambda: bh.evaluate("paper", runs=1, model=imported, out=tmp_path / "results"),
    ):
        with pytest.raises(bh.InputError, match=r"^an imported network has (probabilities but )?no counts") as caught:
            action()
        assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
    again = worker(imported)
    assert again == imported
    assert hash(again) == hash(imported)
    assert imported != pair[0]


def test_the_support_of_an_import_is_unknown(pair) -> None:
    model, imported = pair[0], bh.import_network(pair[1])
    ours, theirs = bh.InverseModel(model), bh.InverseModel(imported)
    for target in TARGETS:
        assert type(ours.posterior(*target).support) is int
        assert theirs.posterior(*target).support is None
    assert ours.table()["support"].dtype == np.int64
    table = theirs.table()
    assert table["support"].dtype == pd.Int64Dtype()
    assert table["support"].isna().all()
    assert repr(theirs.posterior(0.15, 0.3)).endswith("support unknown>")


def test_a_hunt_records_what_is_unknown_as_missing(pair, tmp_path: Path) -> None:
    model, imported = pair[0], bh.import_network(pair[1])
    unknown = pd.array([None], dtype="Int64")
    for mind, planner, known in ((model, "reactive", True), (imported, "reactive", False), (model, "planning", False)):
        episode = bh.hunt("paper", bh.make_planner(planner, mind), arena="open", theta=1.0, seed=0)
        support = episode.frame["support"]
        assert support.dtype == unknown.dtype
        assert support.notna().all() if known else support.isna().all()
        assert (episode.frame["evidence_probability"].notna() == (planner == "reactive")).all()
        if planner == "reactive":
            assert (episode.plans[0].trace["support"].notna() == known).all()
        episode.save(tmp_path / "hunt.parquet")
        assert bh.Episode.load(tmp_path / "hunt.parquet").frame["support"].equals(support)


def test_an_earlier_file_of_a_hunt_says_minus_one_where_nobody_asked(pair, tmp_path: Path) -> None:
    episode = bh.hunt("paper", bh.make_planner("planning", pair[0]), arena="open", theta=1.0, seed=0)
    replace(episode, frame=episode.frame.assign(support=-1)).save(tmp_path / "hunt.parquet")
    assert bh.Episode.load(tmp_path / "hunt.parquet").frame["support"].isna().all()


def test_the_tables_of_an_import_have_probabilities_alone(pair) -> None:
    imported = bh.import_network(pair[1])
    for variable in ("Gait", "Distance", "Angle", "Heading"):
        table = imported.table(variable)
        assert (table.count, table.low, table.high, table.prior) == (None,) * 4
        assert table.probability.equals(imported.cpt(variable))
        assert "counts unknown" in repr(table)


def test_the_expected_pose_of_an_import_is_within_a_bin(pair) -> None:
    model, imported = pair[0], bh.import_network(pair[1])
    # A prior spreads mass over the whole table and pulls the mean towards the robot.
    reach = model.axes.distance.width * (1 if model.prior == 0 else 8)
    for gait in model.gaits.names:
        one, two = model.predict(gait), imported.predict(gait)
        assert two.distance == pytest.approx(one.distance, abs=reach)
        assert two.heading == pytest.approx(one.heading, abs=model.axes.heading.width)


def test_rounded_columns_are_rescaled(pair, tmp_path: Path) -> None:
    model, path = pair
    network = gum.loadBN(str(path))
    table = network.cpt("Gait")
    table.fillWith([round(v, 4) + (2e-4 if i == 0 else 0) for i, v in enumerate(table.toarray().tolist())])
    gum.saveBN(network, str(tmp_path / "rounded.bif"))
    shutil.copy(xmlbif.labels_path(path), xmlbif.labels_path(tmp_path / "rounded.bif"))
    gait = bh.import_network(tmp_path / "rounded.bif").probabilities("Gait")
    assert gait.sum() == pytest.approx(1.0, abs=1e-15)
    assert gait[0] > gait[1]
    assert len(model.gaits) == len(gait)


SMALL = """network unknown {{}}
variable Gait {{ type discrete [ 2 ] {{ go, stop }}; }}
variable {name} {{ type discrete [ 2 ] {{ a, b }}; }}
probability ( Gait ) {{ table 0.5, 0.5; }}
probability ( {name} | Gait ) {{ (go) {column}; (stop) 0.5, 0.5; }}
"""


@pytest.mark.parametrize(
    ("file", "text", "says"),
    [
        ("gone.bif", None, "no such file"),
        ("model.json", "{}", "unknown kind of network '.json'"),
        ("broken.xmlbif", "<BIF><NETWORK>", "not a readable XMLBIF network"),
        (
            "other.bif",
            SMALL.format(name="Colour", column="0.5, 0.5"),
            "the variables are Colour, Gait; expected exactly",
        ),
    ],
)
def test_wrong_files_are_refused_in_one_line(file: str, text: str | None, says: str, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / file).write_text(text)
    with pytest.raises(bh.InputError, match=says) as caught:
        bh.import_network(tmp_path / file)
    assert file in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_column_that_is_no_distribution_is_refused(pair, tmp_path: Path) -> None:
    network = gum.loadBN(str(pair[1]))
    network.cpt("Gait").fillWith([0.2] * len(pair[0].gaits))
    gum.saveBN(network, str(tmp_path / "wrong.bifxml"))
    shutil.copy(xmlbif.labels_path(pair[1]), xmlbif.labels_path(tmp_path / "wrong.bifxml"))
    with pytest.raises(bh.InputError, match=r"wrong\.bifxml"):
        bh.import_network(tmp_path / "wrong.bifxml")


def test_a_damaged_label_map_is_refused(pair, tmp_path: Path) -> None:
    shutil.copy(pair[1], tmp_path / "model.bifxml")
    xmlbif.labels_path(tmp_path / "model.bifxml").write_text("[]")
    with pytest.raises(bh.InputError, match="not a label map"):
        bh.import_network(tmp_path / "model.bifxml")


# --- CSV -------------------------------------------------------------------------------------------


def test_csv_holds_every_cell(pair, tmp_path: Path) -> None:
    model = pair[0]
    assert [path.name for path in model.to_csv(tmp_path)] == ["gait.csv", "distance.csv", "angle.csv", "heading.csv"]
    for variable in ("Distance", "Angle", "Heading"):
        frame = pd.read_csv(tmp_path / f"{variable.lower()}.csv")
        low, high = model.credible_interval(variable)
        for column, table in (
            ("probability", model.cpt(variable)), ("count", model.counts(variable)), ("ci_low", low), ("ci_high", high)
        ):  # fmt: skip
            back = frame.pivot(index="bin", columns="gait", values=column).loc[table.index, table.columns]
            assert np.array_equal(back.to_numpy(), table.to_numpy())
        axis = model.axes[variable]
        assert np.array_equal(frame["low"].to_numpy()[: axis.bins], axis.edges[:-1])
        assert np.array_equal(frame["high"].to_numpy()[: axis.bins], axis.edges[1:])
    gaits = pd.read_csv(tmp_path / "gait.csv")
    assert np.array_equal(gaits["probability"], model.probabilities("Gait"))
    assert gaits["count"].tolist() == model.counts("Gait")["count"].tolist()
    assert gaits[["ci_low", "ci_high"]].isna().all(axis=None)  # P(Gait) is set, nobody estimated it


def test_csv_of_an_import_has_no_counts(pair, tmp_path: Path) -> None:
    bh.import_network(pair[1]).to_csv(tmp_path)
    frame = pd.read_csv(tmp_path / "angle.csv")
    assert frame[["count", "ci_low", "ci_high"]].isna().all().all()
    assert frame["probability"].notna().all()


def test_gait_names_survive_csv(khepera_frame, tmp_path: Path) -> None:
    names = ['a,"b"', "two\nlines", "=1+1"]
    frame = khepera_frame.iloc[:60].assign(gait=[names[i % 3] for i in range(60)])
    bh.ForwardModel.fit(frame, names).to_csv(tmp_path)
    assert pd.read_csv(tmp_path / "gait.csv")["gait"].tolist() == names
