"""Energy as a fourth node, for who asks: fitted, asked, observed, opened, kept, exported; and nobody else notices."""

import copy
import json
import pickle

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.bins import Axis, EffectAxes
from bayeshunt.core.errors import DataError, ImpossibleEvidenceError, InputError
from bayeshunt.models.counting.auto_axes import density_losses

EFFECTS = ["Energy", "Heading", "Angle", "Distance"]  # any order
NAMES = ("run", "turn", "creep")
MEAN = {"run": 3.0, "turn": 2.0, "creep": 0.8}


def table(rows=400, seed=0):
    """Gaits whose places overlap and whose energies tell them apart; dearer after another gait."""
    rng = np.random.default_rng(seed)
    gait = rng.choice(NAMES, size=rows)
    before = np.concatenate([[None], gait[:-1]])
    changed = np.array([b is not None and b != g for b, g in zip(before, gait, strict=True)])
    return pd.DataFrame({
        "gait": gait, "previous_gait": before,
        "distance": rng.uniform(0.15, 0.24, size=rows), "angle": rng.normal(0.0, 0.1, size=rows),
        "heading": np.where(gait == "turn", 0.6, 0.0) + rng.normal(0.0, 0.1, size=rows),
        "energy": [MEAN[g] for g in gait] + 0.5 * changed + rng.uniform(-0.1, 0.1, size=rows),
    })  # fmt: skip


@pytest.fixture(scope="module")
def frame():
    return table()


@pytest.fixture(scope="module")
def gaits():
    return bh.GaitRepertoire(tuple(map(bh.Gait, NAMES)), body_length=0.2, duration=1.5)


def fit(frame, gaits, structure="naive", **how):
    how = {"prior": 0.03, "backoff": 5.0 if structure == "previous_gait" else None, **how}
    return bh.ForwardModel.fit(frame, gaits, structure=structure, effects=EFFECTS, **how)


@pytest.fixture(scope="module", params=["naive", "tan", "joint", "previous_gait"])
def model(request, frame, gaits):
    return fit(frame, gaits, request.param)


def counted(model, frame):
    return frame if model.by_previous is None else frame[frame["previous_gait"].notna()]


def test_its_table_is_of_the_rows(model, frame):
    axis, rows = model.axes["Energy"], counted(model, frame)
    counts = pd.crosstab(axis.index(rows["energy"].to_numpy()), rows["gait"])
    assert (model.counts("Energy").to_numpy()[counts.index] == counts[list(NAMES)].to_numpy()).all()
    assert model.counts("Energy").to_numpy().sum() == len(rows)
    assert model.cpt("Energy").to_numpy().sum(axis=0) == pytest.approx(1.0)
    shown = model.table("Energy")
    assert (shown.low.to_numpy() <= shown.probability.to_numpy() + 1e-12).all()
    assert (shown.probability.to_numpy() <= shown.high.to_numpy() + 1e-12).all()


def test_the_rest_is_as_without_it(model, frame, gaits):
    how = {"structure": model.structure.name, "backoff": model.backoff}
    plain = bh.ForwardModel.fit(frame, gaits, 0.03, **how)
    assert plain.structure == model.structure.poses
    assert "Energy" not in plain.states
    for effect in ("Distance", "Angle", "Heading"):
        assert np.array_equal(plain.local_tables[effect], model.local_tables[effect])
    one, other = (bh.InverseModel(m).posterior(0.2, 0.0).values for m in (plain, model))
    assert np.array_equal(one, other)
    kept = model.without(model.rows("Energy", model.axes["Energy"].labels[-1]))
    assert kept.structure.has_energy
    assert kept.axes["Energy"].bins == model.axes["Energy"].bins - 1


@pytest.mark.parametrize("heading", [None, 0.05])
def test_evidence_on_energy_is_the_networks_own_answer(model, heading):
    inverse, bayes = bh.InverseModel(model), bh.Network(model)
    for joules in (0.8, 2.0, 3.1):
        answer = inverse.posterior(0.2, 0.0, heading, energy=joules)
        theirs = bayes.posterior("Gait", evidence=answer.evidence)
        assert answer.values == pytest.approx(theirs.to_numpy(), abs=1e-12)
        assert answer.evidence_probability == pytest.approx(bayes.probability(answer.evidence), rel=1e-9)
        low, high = (answer.interval()[end].to_numpy() for end in ("low", "high"))
        assert (low <= answer.values).all()
        assert (answer.values <= high).all()
        told = answer.explain()
        parts = told[["prior", "Distance", "Angle", "Heading", "Energy"]].sum(axis=1)
        assert parts.to_numpy() == pytest.approx(told["log_odds"].to_numpy(), abs=1e-9)
    assert inverse.posterior(0.2, 0.0, energy=0.8).best == "creep"
    assert inverse.posterior(0.2, 0.0, energy=3.0).best == "run"
    assert "Energy" in set(inverse.posterior(0.2, 0.0, energy=3.0).sensitivity()["variable"])


def test_pgmpy_agrees(model):
    from pgmpy.inference import VariableElimination

    answer = bh.InverseModel(model).posterior(0.2, 0.0, energy=2.0)
    found = VariableElimination(model.network).query(["Gait"], evidence=answer.evidence, show_progress=False)
    assert answer.values == pytest.approx(found.values, abs=1e-9)


def test_after_a_gait_a_change_is_dear(frame, gaits):
    model = fit(frame, gaits, "previous_gait")
    centres = model.axes["Energy"].centres
    after = {before: float(centres @ model.after(before).probabilities("Energy")[:, 0]) for before in NAMES}
    assert after["turn"] - after["run"] == pytest.approx(0.5, abs=0.1)
    bayes = bh.Network(model)
    assert bayes.posterior("PreviousGait", {"Gait": "run", "Energy": 3.0})["run"] > 0.9


def test_files_and_copies_bring_it_back(model, frame, tmp_path):
    model.save(tmp_path / "m.json")
    again = bh.ForwardModel.load(tmp_path / "m.json")
    assert again == model
    assert pickle.dumps(model)
    assert copy.deepcopy(model) == model
    assert np.array_equal(again.local_tables["Energy"], model.local_tables["Energy"])
    assert again.with_data(frame.copy()).uses(7)["variable"].tolist()[-1] == "Energy"
    names = {path.name for path in model.to_csv(tmp_path)}
    assert names == {"gait.csv", "distance.csv", "angle.csv", "heading.csv", "energy.csv", "costs.csv"}
    model.to_xmlbif(tmp_path / "m.xmlbif")
    back = bh.import_network(tmp_path / "m.xmlbif")
    assert back.structure.edges == model.structure.edges
    assert back.axes["Energy"].labels == model.axes["Energy"].labels
    assert back.local_tables["Energy"] == pytest.approx(model.local_tables["Energy"], abs=1e-12)
    seen = {"Distance": 0.205, "Energy": model.axes["Energy"].centres[9]}
    one, other = (bh.Network(m).posterior("Gait", seen).to_numpy() for m in (model, back))
    assert other == pytest.approx(one, abs=1e-9)


def test_any_split_of_the_rows_is_the_same(model, frame, gaits):
    mixed = frame.sample(frac=1.0, random_state=3)
    axes = EffectAxes.standard(0.2)
    axes = EffectAxes(*axes, body_length=0.2, energy=Axis.linear("Energy", model.axes["Energy"].width))
    how = {"structure": model.structure, "backoff": model.backoff, "axes": axes}
    split = bh.ForwardModel.fit(mixed.iloc[:150], gaits, 0.03, **how).update(mixed.iloc[150:])
    assert split == model
    assert split.log_likelihood(frame) == pytest.approx(model.log_likelihood(frame))


def test_its_log_likelihood_is_that_of_the_rows(model, frame):
    table, rows = model.local_tables["Energy"], counted(model, frame)
    gait = pd.Index(NAMES).get_indexer(rows["gait"])
    at = [model.axes["Energy"].index(rows["energy"].to_numpy()), gait]
    if model.by_previous is not None:
        at.append(pd.Index(NAMES).get_indexer(rows["previous_gait"]))
    plain = bh.ForwardModel.fit(frame, model.gaits, 0.03, structure=model.structure.poses, backoff=model.backoff)
    spent = np.log(table[tuple(at)]).sum()
    assert model.log_likelihood(frame) - plain.log_likelihood(frame) == pytest.approx(spent)


def test_bins_are_those_of_the_least_held_out_loss(frame, gaits):
    chosen = fit(frame, gaits).axes["Energy"]
    codes = pd.Index(NAMES).get_indexer(frame["gait"])
    loss = {w: density_losses(frame["energy"].to_numpy(), codes, Axis.linear("Energy", w))
            for w in (chosen.width, 0.01, 1.0)}  # fmt: skip
    assert loss[chosen.width] < min(loss[0.01], loss[1.0])
    assert chosen.labels[0] == f"0-{chosen.width:g} J"


def test_an_energy_that_nobody_spent_snaps_to_the_nearest(frame, gaits):
    inverse = bh.InverseModel(fit(frame, gaits, prior=0.0))
    answer = inverse.posterior(0.2, 0.0, energy=50.0)
    assert answer.snapped
    assert "J off" in answer.missed_by
    assert answer.cell.energy == pytest.approx(frame["energy"].max(), abs=inverse.model.axes["Energy"].width)
    with pytest.raises(ImpossibleEvidenceError, match="Energy = 50 J"):
        inverse.posterior(0.2, 0.0, energy=50.0, snap=False)


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        (["Distance", "Angle", "Heading", "Enrgy"], "did you mean 'Energy'"),
        (["Distance", "Energy"], "expected Distance, Angle, Heading, each once, and perhaps Energy"),
        (["Distance", "Angle", "Heading", "Energy", "Energy"], "each once"),
    ],
)
def test_other_effects_are_refused(frame, gaits, effects, said):
    with pytest.raises(InputError, match=said):
        bh.ForwardModel.fit(frame, gaits, effects=effects)


def test_rows_that_do_not_say_it_are_refused(frame, gaits):
    with pytest.raises(DataError, match=r"no column energy \[J\]"):
        fit(frame.drop(columns="energy"), gaits)
    with pytest.raises(DataError, match="expected joules >= 0"):
        fit(frame.assign(energy=-1.0), gaits)
    plain = bh.ForwardModel.fit(frame, gaits)
    with pytest.raises(InputError, match="fit it with effects="):
        bh.InverseModel(plain).posterior(0.2, 0.0, energy=1.0)
    with pytest.raises(InputError, match="nothing else"):
        bh.Structure("mine", (*plain.structure.edges, ("Distance", "Energy")))


def test_it_is_shown_everywhere(model):
    assert "Energy" in str(model)
    assert "Energy" in model._repr_html_()
    answer = bh.InverseModel(model).posterior(0.2, 0.0, energy=2.0)
    assert "2 J" in answer.asked
    assert "Energy" in answer._repr_html_()
    assert {"Energy"} <= set(bh.trace(answer, "turn").cells["variable"])
    assert "Energy" in bh.compare(model, model).difference


def test_the_command_line_fits_and_asks(bayeshunt, frame, tmp_path):
    frame.to_parquet(tmp_path / "b.parquet")
    robot = tmp_path / "r.toml"
    robot.write_text(
        'name = "r"\ngait_duration = 1.5\n[body]\ndrive = "differential"\ndiameter = 0.2\naxle = 0.18\n'
        + "".join(f'[[gait]]\nname = "{name}"\nleft = 0.1\nright = 0.1{i}\n' for i, name in enumerate(NAMES))
    )
    fitted = ["fit", str(tmp_path / "b.parquet"), "--robot", str(robot), "--out", str(tmp_path / "m.json")]
    out, _ = bayeshunt(*fitted, "--effects", "Distance,Angle,Heading,Energy", "--prior", "0.03", "--json")
    assert json.loads(out)["bins"]["Energy"] > 3
    asked = ["query", str(tmp_path / "m.json"), "--distance", "0.2", "--angle", "0"]
    facts = json.loads(bayeshunt(*asked, "--energy", "0.8", "--json")[0])
    assert facts["best"] == "creep"
    assert facts["evidence"]["Energy"].endswith(" J")
    assert "Energy" in bayeshunt(*asked, "--energy", "0.8", "--explain")[0]
    assert "effects: unknown effect 'Enery'" in bayeshunt(*fitted, "--effects", "Enery", status=2)[1]
