"""The structure previous_gait on the command line, from babbling to an evaluation."""

import json

import pytest

import bayeshunt as bh


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A table of 1,500 rows, in which every gait follows every other."""
    place = tmp_path_factory.mktemp("previous")
    bh.save_dataset(bh.babble("khepera", 1500, 0), place / "babbling.parquet")
    bh.save_dataset(bh.babble("khepera", 1500, 0).drop(columns="previous_gait"), place / "mute.parquet")
    return place


@pytest.fixture
def fitted(bayeshunt, folder):
    """Fit the model if it is not there yet; return its path."""
    if not (folder / "model.json").exists():
        arguments = ("--structure", "previous_gait", "--out", "model.json", "--xmlbif", "model.xmlbif")
        out, _ = bayeshunt("fit", "babbling.parquet", *arguments, "--quiet")
        assert "1499 rows of 1500 (the others had no gait before)" in out
    return folder / "model.json"


def test_fit_says_what_it_fitted(bayeshunt, fitted):
    out, _ = bayeshunt("fit", "babbling.parquet", "--structure", "previous_gait", "--out", "again.json", "--json")
    facts = json.loads(out)
    assert (facts["rows"], facts["structure"]) == (1499, "previous_gait")
    assert ["PreviousGait", "Heading"] in facts["edges"]
    assert (fitted.parent / "again.json").read_bytes() == fitted.read_bytes()


def test_query_takes_the_gait_before(bayeshunt, fitted):
    target = ("model.json", "--distance", "0.16", "--angle", "0.5")
    out, _ = bayeshunt("query", *target, "--previous-gait", "spin left", "--explain")
    assert "P(Gait | Distance, Angle, PreviousGait)" in out
    assert "PreviousGait         spin left" in out
    out, _ = bayeshunt("query", *target, "--previous-gait", "spin left", "--json")
    answer = bh.InverseModel(bh.ForwardModel.load(fitted)).after("spin left").posterior(0.16, 0.5)
    found = json.loads(out)
    assert found["probabilities"] == answer.probabilities.to_dict()
    assert found["evidence"]["PreviousGait"] == "spin left"
    out, _ = bayeshunt("query", *target, "--json")
    assert "PreviousGait" not in json.loads(out)["evidence"]
    _, err = bayeshunt("query", *target, "--previous-gait", "gallop", status=2)
    assert "unknown gait 'gallop'" in err


def test_query_refuses_a_gait_before_that_says_nothing(bayeshunt, fitted):
    bayeshunt("fit", "babbling.parquet", "--out", "naive.json", "--quiet")
    asked = ("--distance", "0.16", "--angle", "0.5", "--previous-gait", "straight")
    _, err = bayeshunt("query", "naive.json", *asked, status=2)
    assert "fit with --structure previous_gait" in err


def test_hunts_and_evaluations_use_it(bayeshunt, fitted):
    out, _ = bayeshunt("hunt", "--model", "model.json", "--planner", "planning", "--arena", "open", "--theta", "2",
                       "--seed", "0", "--json")  # fmt: skip
    hunted = json.loads(out)
    planner = bh.make_planner("planning", bh.ForwardModel.load(fitted))
    episode = bh.hunt("paper", planner, arena="open", theta=2.0, seed=0)
    assert hunted["time"] == episode.time
    assert hunted["gaits"] == episode.frame["gait"].tolist()
    naive = bh.ForwardModel.fit(bh.load_dataset(fitted.parent / "babbling.parquet"), bh.load_robot("khepera").gaits)
    other = bh.hunt("paper", bh.make_planner("planning", naive), arena="open", theta=2.0, seed=0)
    assert other.frame["value"].tolist() != episode.frame["value"].tolist()
    out, _ = bayeshunt("evaluate", "--model", "model.json", "--planner", "planning", "--arena", "open", "--runs", "1",
                       "--jobs", "1", "--json", "--quiet")  # fmt: skip
    totals = [row for row in json.loads(out)["rows"] if row["theta"] is None]
    assert [row["runs"] for row in totals] == [7]


def test_export_and_assess_take_it(bayeshunt, fitted):
    bayeshunt("export", "model.json", "--out", "csv")
    assert (fitted.parent / "csv" / "angle.csv").read_text().startswith("previous_gait,gait,bin,low,high,probability")
    arguments = ("--model", "model.json", "--structure", "previous_gait", "--permutations", "9")
    out, _ = bayeshunt("assess", "babbling.parquet", *arguments)
    assert "The model given (previous_gait, prior 0.03)" in (said := " ".join(out.split()))
    assert "each leaning on the gait's own table as on 5 rows" in said


def test_back_off_is_the_default_and_can_be_left_out(bayeshunt, fitted):
    line = ("fit", "babbling.parquet", "--structure", "previous_gait", "--out", "plain.json", "--json")
    assert json.loads(bayeshunt(*line)[0])["backoff"] == 5.0
    facts = json.loads(bayeshunt(*line, "--backoff", "0", "--prior", "0.03")[0])
    assert (facts["backoff"], bh.ForwardModel.load(fitted.parent / "plain.json").backoff) == (None, None)
    line = ("assess", "babbling.parquet", "--structure", "previous_gait", "--permutations", "9", "--json")
    lean, plain = (json.loads(bayeshunt(*line, *more)[0]) for more in ((), ("--backoff", "0")))
    assert (lean["settings"]["backoff"], plain["settings"]["backoff"]) == (5.0, None)
    gains = [{row["structure"]: row["gain"] for row in a["structures"]}["previous_gait"] for a in (lean, plain)]
    assert gains[0] > 0.0 > gains[1]


def test_a_table_without_the_gait_before_is_refused_in_one_line(bayeshunt, folder):
    arguments = ("mute.parquet", "--structure", "previous_gait", "--out", "none.json", "--quiet")
    _, err = bayeshunt("fit", *arguments, status=2)
    assert err.count("\n") == 1
    assert "mute.parquet: column 'previous_gait' is missing" in err
    assert not (folder / "none.json").exists()
