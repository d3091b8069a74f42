"""What gaits cost, E[energy | gait, gait before]: means of the very rows, exact in any order, kept and shown."""

import copy
import json
import pickle

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t as student

import bayeshunt as bh
from bayeshunt.models.counting.streaming import count_tables


@pytest.fixture(scope="module")
def robot():
    return bh.load_robot("hexapod_mixed")


@pytest.fixture(scope="module")
def frame(robot):
    return bh.babble(robot, 400, 3)


@pytest.fixture(scope="module", params=["naive", "previous_gait"])
def model(request, robot, frame):
    backoff = 5.0 if request.param == "previous_gait" else None
    return bh.ForwardModel.fit(frame, robot.gaits, 0.03, structure=request.param, backoff=backoff)


def rows_of(model, frame):
    return frame if model.structure.name == "naive" else frame[frame["previous_gait"].notna()]


def test_the_table_is_of_the_rows(model, frame):
    table, rows = model.energy(), rows_of(model, frame)
    whole = table[table["previous_gait"].isna()].set_index("gait")
    assert list(whole.index) == list(model.gaits.names)
    for gait, own in rows.groupby("gait")["energy"]:
        assert whole.loc[gait, "rows"] == len(own)
        assert whole.loc[gait, "mean_j"] == pytest.approx(own.mean(), rel=1e-5)
        assert whole.loc[gait, "sd_j"] == pytest.approx(own.std(), rel=1e-3)
        half = student.ppf(0.975, len(own) - 1) * own.std() / np.sqrt(len(own))
        assert whole.loc[gait, "high_j"] - whole.loc[gait, "mean_j"] == pytest.approx(half, rel=1e-3)
    pairs = table[table["previous_gait"].notna()].set_index(["previous_gait", "gait"])
    for key, own in frame[frame["previous_gait"].notna()].groupby(["previous_gait", "gait"])["energy"]:
        assert pairs.loc[key, "rows"] == len(own)
        assert pairs.loc[key, "mean_j"] == pytest.approx(own.mean(), rel=1e-5)


def test_one_gait_after_another(model):
    one = model.energy("wave", "ripple")
    assert one[["previous_gait", "gait"]].to_numpy().tolist() == [["ripple", "wave"]]
    if model.structure.name == "previous_gait":
        assert model.after("ripple").energy("wave").equals(one)


def test_the_expected_energy_after_a_gait_leans_on_the_gaits_own(model, frame):
    rows = rows_of(model, frame)
    mean = rows.groupby("gait")["energy"].mean()
    own = frame[(frame["gait"] == "wave") & (frame["previous_gait"] == "ripple")]["energy"]
    at = model.gaits.index("wave")
    assert model.expected_energy()[at] == pytest.approx(mean["wave"], rel=1e-5)
    leant = (own.sum() + 5.0 * mean["wave"]) / (len(own) + 5.0)
    assert model.expected_energy("ripple")[at] == pytest.approx(leant, rel=1e-5)


def test_any_order_any_split_and_every_copy_is_the_same(model, frame, robot, tmp_path):
    structure, rows = model.structure.name, model.energy()
    shuffled = frame.sample(frac=1.0, random_state=1)
    backoff = model.backoff
    again = bh.ForwardModel.fit(shuffled.iloc[:150], robot.gaits, 0.03, structure=structure, backoff=backoff)
    again = again.update(shuffled.iloc[150:])
    pickle.dumps(model)  # it can be sent to another process; a copy is made by the very state that is sent
    model.save(tmp_path / "m.json")
    for other in (again, bh.ForwardModel.load(tmp_path / "m.json"), copy.deepcopy(model)):
        pd.testing.assert_frame_equal(other.energy(), rows, check_exact=True)
    assert again == model


def test_counting_in_parts_tells_the_same(model, frame, robot):
    from bayeshunt.data.ingesting import Held

    counts, provenance = count_tables([Held(frame, "b")], robot.gaits, structure=model.structure.name)
    counted = bh.ForwardModel.from_counts(
        counts, 0.03, structure=model.structure.name, backoff=model.backoff, provenance=provenance
    )
    assert counted.energy().equals(model.energy())


def test_rows_without_energy_say_so(khepera_model, model, tmp_path):
    assert not khepera_model.knows_energy
    with pytest.raises(bh.InputError, match="do not say what gaits cost"):
        khepera_model.energy()
    with pytest.raises(bh.InputError, match="do not say what gaits cost"):
        bh.make_planner("frugal", khepera_model, energy=1.0)
    with pytest.raises(bh.InputError, match="level"):
        model.energy(level=1.5)
    with pytest.raises(bh.InputError, match="gallop"):
        model.energy("gallop")
    khepera_model.save(tmp_path / "m.json")
    assert '"energy"' not in (tmp_path / "m.json").read_text()
    assert [path.name for path in khepera_model.to_csv(tmp_path)][-1] == "heading.csv"
    assert [path.name for path in model.to_csv(tmp_path)][-1] == "costs.csv"
    read = pd.read_csv(tmp_path / "costs.csv").assign(previous_gait=model.energy()["previous_gait"])
    pd.testing.assert_frame_equal(read, model.energy(), check_dtype=False)


def test_it_is_shown_in_card_text_and_query(model, bayeshunt, tmp_path):
    assert "least after" in str(model)
    assert "Energy of each gait" in model._repr_html_()
    model.save(tmp_path / "m.json")
    ask = ["query", str(tmp_path / "m.json"), "--distance", "0.15", "--angle", "0"]
    best = json.loads(bayeshunt(*ask, "--json")[0])
    whole = model.energy(best["best"]).iloc[0]
    assert best["energy"][best["best"]]["mean_j"] == whole["mean_j"]
    assert f"energy               of {best['best']}: {whole['mean_j']:.3g} J" in bayeshunt(*ask)[0]


def test_frugal_weighs_what_it_learned_after_the_gait_before(model):
    """The energy of a plan is the sum of the expected energies along it."""
    free = bh.make_planner("frugal", model, energy=0.0, depth=2)
    priced = bh.make_planner("frugal", model, energy=2.0, depth=2)
    situation = bh.hunt("legs", free, arena="open", theta=1.0, seed=1).situations[2]
    before = situation.previous_gait
    rng = np.random.default_rng(0)
    plain, dear = (p.plan(situation, rng=rng).trace.set_index("node")["value"] for p in (free, priced))
    paths = priced.paths_after(before)
    names = model.gaits.names
    for node in dear.index[paths.tree.steps[dear.index] == 2][:40]:
        first, second = paths.tree.gaits[paths.tree.parents[node]], paths.tree.gaits[node]
        least = model.expected_energy(before)[first]
        most = least + model.expected_energy(names[first])[second]
        fast = names[paths.fastest]
        rate = model.expected_energy(fast)[paths.fastest] / paths.duration
        reach = priced.reach(situation)
        onward = paths.times_to_go(np.array([node]), priced._prey(situation), reach, paths.turn_price)[0, 0]
        paid = (dear[node] - plain[node]) / 2.0
        assert paid == pytest.approx(most + rate * onward) or least <= paid <= most  # caught within the second gait
