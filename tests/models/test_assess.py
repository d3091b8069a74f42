"""Assessments: every number recomputed by hand on a small table, and the laws they keep."""

from __future__ import annotations

import json
import math
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.cli import main
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.models.assessment.assess import PRIOR
from bayeshunt.models.assessment.independence import g_statistic, permuted
from bayeshunt.models.assessment.rows import CodedRows
from bayeshunt.models.assessment.scores import accuracy, brier, confusion, log_loss
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import JOINT, NAIVE, PREVIOUS_GAIT, Structure

GAITS = ("go", "turn")
AXES = EffectAxes.standard(0.05, distance_bin=1.0, angle_bins=4, heading_bins=4)
#: gait, distance [m], angle, heading [rad]; bins of 5 cm and quarter turns.
ROWS = [
    ("go", 0.06, 0.0, 0.0), ("go", 0.07, 0.1, 0.0), ("turn", 0.01, 0.0, 1.6), ("go", 0.06, 0.2, 0.1),
    ("turn", 0.02, 1.5, 1.5), ("turn", 0.06, 1.6, 1.4), ("go", 0.03, 0.0, 1.5), ("turn", 0.01, -1.6, 3.1),
    ("go", 0.08, 0.0, 0.2), ("turn", 0.02, 1.7, 1.5),
]  # fmt: skip
SMALL = pd.DataFrame(ROWS, columns=["gait", "distance", "angle", "heading"])
SMALL["previous_gait"] = [None, *SMALL["gait"][:-1]]
ALPHA, FOLDS, SEED = 0.5, 3, 7
SIZES = {"Distance": 2, "Angle": 4, "Heading": 4}


def hand_rows() -> list[dict[str, object]]:
    """The bins of every row, counted by eye: 5 cm distance bins; quarter turns centred on 0."""

    def quarter(angle: float) -> int:
        return next(i for i, centre in enumerate((-math.pi, -math.pi / 2, 0.0, math.pi / 2)) if near(angle, centre))

    def near(angle: float, centre: float) -> bool:
        return math.cos(angle - centre) > math.cos(math.pi / 4)

    return [
        {
            "PreviousGait": previous if isinstance(previous, str) else "nothing",
            "Gait": gait,
            "Distance": int(distance // 0.05),
            "Angle": quarter(angle),
            "Heading": quarter(heading),
        }
        for (gait, distance, angle, heading), previous in zip(ROWS, SMALL["previous_gait"], strict=True)
    ]


def hand_probability(train: list[dict], row: dict, effect: str, parents: tuple[str, ...]) -> float:
    """(N + a) / (N_parents + S a), by counting dictionaries."""
    same = [r for r in train if all(r[p] == row[p] for p in parents)]
    hits = [r for r in same if r[effect] == row[effect]]
    return (len(hits) + ALPHA) / (len(same) + SIZES[effect] * ALPHA)


def hand_folds() -> np.ndarray:
    rows = CodedRows.of(SMALL, bh.GaitRepertoire.of(GAITS), AXES)
    return rows.folds(FOLDS, np.random.default_rng(np.random.SeedSequence(SEED).spawn(2)[0]))


def hand_splits() -> list[tuple[list[dict], dict]]:
    """Every row with the rows of the other folds."""
    rows, fold = hand_rows(), hand_folds()
    return [([r for r, g in zip(rows, fold, strict=True) if g != f], row) for row, f in zip(rows, fold, strict=True)]


@pytest.fixture(scope="module")
def small() -> bh.Assessment:
    structures = ["joint", "previous_gait"]
    return bh.assess(
        SMALL, GAITS, folds=FOLDS, seed=SEED, prior=ALPHA, axes=AXES, structures=structures, permutations=50
    )


@pytest.fixture(scope="module")
def plain() -> bh.Assessment:
    """Without back-off."""
    return bh.assess(
        SMALL, GAITS, folds=FOLDS, seed=SEED, prior=ALPHA, axes=AXES, structures=["previous_gait"], permutations=1,
        backoff=None,
    )  # fmt: skip


def leaning_probability(train: list[dict], row: dict, effect: str, rows: float) -> float:
    """(N + s P(effect | Gait)) / (N_pair + s), by counting dictionaries."""
    same = [r for r in train if all(r[p] == row[p] for p in ("Gait", "PreviousGait"))]
    hits = sum(r[effect] == row[effect] for r in same)
    return (hits + rows * hand_probability(train, row, effect, ("Gait",))) / (len(same) + rows)


@pytest.mark.parametrize("backoff", [None, 5.0])
@pytest.mark.parametrize("structure", [NAIVE, JOINT, PREVIOUS_GAIT], ids=lambda s: s.name)
def test_held_out_log_loss_by_hand(
    small: bh.Assessment, plain: bh.Assessment, structure: Structure, backoff: float | None
) -> None:
    leans = backoff is not None and structure is PREVIOUS_GAIT
    if structure is PREVIOUS_GAIT and not leans:
        small = plain
    assert small.settings["backoff"] == (None if small is plain else 5.0)
    losses = [
        -sum(
            math.log(
                leaning_probability(train, row, e, backoff or 0.0)
                if leans
                else hand_probability(train, row, e, structure.parents(e))
            )
            for e in EFFECTS
        )
        for train, row in hand_splits()
    ]
    naive = [
        -sum(math.log(hand_probability(train, row, e, ("Gait",))) for e in EFFECTS) for train, row in hand_splits()
    ]
    found = small.structures.loc[structure.name]
    assert found["log_loss"] == pytest.approx(sum(losses) / len(ROWS), rel=1e-12)
    gains = [n - m for n, m in zip(naive, losses, strict=True)]
    mean = sum(gains) / len(gains)
    spread = math.sqrt(sum((g - mean) ** 2 for g in gains) / (len(gains) - 1) / len(gains))
    assert found["gain"] == pytest.approx(mean, abs=1e-12)
    assert found["gain_low"] == pytest.approx(mean - 1.959963984540054 * spread, abs=1e-12)
    assert found["gain_high"] == pytest.approx(mean + 1.959963984540054 * spread, abs=1e-12)


@pytest.mark.parametrize("structure", [NAIVE, JOINT, PREVIOUS_GAIT], ids=lambda s: s.name)
def test_bic_and_parameters_by_hand(small: bh.Assessment, structure: Structure) -> None:
    rows, states = hand_rows(), {**SIZES, "Gait": 2, "PreviousGait": 3}
    likelihood, parameters = 0.0, 0
    for effect in EFFECTS:
        parents = structure.parents(effect)
        for row in rows:
            same = [r for r in rows if all(r[p] == row[p] for p in parents)]
            likelihood += math.log(sum(r[effect] == row[effect] for r in same) / len(same))
        parameters += (SIZES[effect] - 1) * math.prod(states[p] for p in parents)
    found = small.structures.loc[structure.name]
    assert found["parameters"] == parameters
    assert found["log_likelihood"] == pytest.approx(likelihood, rel=1e-12)
    assert found["bic"] == pytest.approx(likelihood - parameters / 2 * math.log(len(rows)), rel=1e-12)


def test_scores_of_each_variable_by_hand(small: bh.Assessment) -> None:
    for effect in EFFECTS:
        loss = squares = blind = 0.0
        for train, row in hand_splits():
            forecast = [
                hand_probability(train, {**row, effect: state}, effect, ("Gait",)) for state in range(SIZES[effect])
            ]
            loss -= math.log(forecast[row[effect]])
            squares += sum((p - (state == row[effect])) ** 2 for state, p in enumerate(forecast))
            blind -= math.log(hand_probability(train, row, effect, ()))
        found = small.variables.loc[effect]
        assert found["log_loss"] == pytest.approx(loss / len(ROWS), rel=1e-12)
        assert found["brier"] == pytest.approx(squares / len(ROWS), rel=1e-12)
        assert found["log_loss_without_gait"] == pytest.approx(blind / len(ROWS), rel=1e-12)
        assert found["impossible"] == 0


def test_gait_classification_by_hand(small: bh.Assessment) -> None:
    right, loss, confusion = 0, 0.0, np.zeros((2, 2), dtype=int)
    for train, row in hand_splits():
        scores = [
            math.prod(hand_probability(train, {**row, "Gait": g}, e, ("Gait",)) for e in ("Distance", "Angle"))
            for g in GAITS
        ]
        posterior = [score / sum(scores) for score in scores]
        true = GAITS.index(row["Gait"])
        best = posterior.index(max(posterior))
        confusion[true, best] += 1
        right += best == true
        loss -= math.log(posterior[true])
    assert small.gaits["accuracy"] == right / len(ROWS)
    assert small.gaits["log_loss"] == pytest.approx(loss / len(ROWS), rel=1e-12)
    assert small.confusion.to_numpy().tolist() == confusion.tolist()
    assert 0 < confusion.trace() < len(ROWS)  # the table is not so easy that any mistake would pass


def test_independence_by_hand(small: bh.Assessment) -> None:
    rows = hand_rows()
    for found in small.independence.itertuples():
        g = 0.0
        for row in rows:  # 2 sum over cells n log(...) is 2 sum over rows log(...)
            stratum = [r for r in rows if r["Gait"] == row["Gait"]]
            n_x = sum(r[found.x] == row[found.x] for r in stratum)
            n_y = sum(r[found.y] == row[found.y] for r in stratum)
            n_xy = sum(r[found.x] == row[found.x] and r[found.y] == row[found.y] for r in stratum)
            g += 2.0 * math.log(n_xy * len(stratum) / (n_x * n_y))
        assert found.g == pytest.approx(g, abs=1e-12)
        assert found.information_bits == pytest.approx(g / (2 * len(rows) * math.log(2)), abs=1e-12)
        assert found.p_permutation * 51 == pytest.approx(round(found.p_permutation * 51))
        assert 1 / 51 - 1e-12 <= found.p_permutation <= 1.0


def test_reliability_by_hand(small: bh.Assessment) -> None:
    events = []
    for (train, row), state in product(hand_splits(), range(SIZES["Angle"])):
        events.append((hand_probability(train, {**row, "Angle": state}, "Angle", ("Gait",)), row["Angle"] == state))
    table = small.reliability.query("variable == 'Angle'")
    assert table["count"].sum() == len(events)
    for found in table.itertuples():
        inside = [(p, hit) for p, hit in events if found.low <= p < found.high]
        assert found.count == len(inside)
        assert found.forecast == pytest.approx(sum(p for p, _ in inside) / len(inside))
        assert found.observed == pytest.approx(sum(hit for _, hit in inside) / len(inside))


def test_the_command_prints_the_same_numbers(small: bh.Assessment, tmp_path, monkeypatch, capsys) -> None:
    path = tmp_path / "small.parquet"
    bh.save_dataset(SMALL, path)
    robot = tmp_path / "robot.toml"
    robot.write_text(
        'name = "toy"\n[body]\ndiameter = 0.05\n'
        '[[gait]]\nname = "go"\nleft = 0.05\nright = 0.05\n[[gait]]\nname = "turn"\nleft = 0.05\nright = 0.0\n'
    )
    options = ["--robot", str(robot), "--folds", "3", "--seed", "7", "--prior", "0.5", "--permutations", "50",
               "--distance-bin", "1", "--angle-bins", "4", "--heading-bins", "4", "--structure", "joint",
               "--structure", "previous_gait"]  # fmt: skip
    text = run(monkeypatch, capsys, "assess", str(path), *options)
    for name, row in small.structures.iterrows():
        line = next(line for line in text.splitlines() if line.split()[:2] == [name, f"{row['log_loss']:.4f}"])
        assert f"{row['parameters']:,}" in line
        assert f"{row['bic']:,.0f}" in line
    for row in small.independence.itertuples():
        assert f"{row.x}, {row.y}" in text
        assert f"{row.g:.1f}" in text
    facts = json.loads(run(monkeypatch, capsys, "assess", str(path), *options, "--json"))
    assert {k: v for k, v in facts.items() if k != "out"} == small.to_dict()
    figure = tmp_path / "figure.svg"
    run(monkeypatch, capsys, "assess", str(path), *options, "--out", str(figure))
    assert figure.read_text().lstrip().startswith("<?xml")


def test_it_shows_itself(small: bh.Assessment) -> None:
    page, text = small._repr_html_(), str(small)
    assert page.count("<table") == page.count("</table") == 5
    for name, row in small.structures.iterrows():
        assert f"{row['parameters']:,}" in page
        assert f"{row['log_loss']:.4f}" in text
        assert name in text
    nasty = "<script>alert('go')</script>"
    frame = SMALL.replace({"gait": {"go": nasty}, "previous_gait": {"go": nasty}})
    shown = bh.assess(frame, (nasty, "turn"), axes=AXES, permutations=1, structures=[])
    assert "<script" not in shown._repr_html_()
    assert "&lt;script" in shown._repr_html_()


def run(monkeypatch, capsys, *arguments: str, status: int = 0) -> str:
    monkeypatch.setattr("sys.argv", ["bayeshunt", *arguments])
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == status
    printed = capsys.readouterr()
    return printed.out if status == 0 else printed.err


# --- laws ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def babbled() -> pd.DataFrame:
    return bh.babble("khepera", steps=400, seed=3)


@pytest.fixture(scope="module")
def assessed(babbled: pd.DataFrame) -> bh.Assessment:
    return bh.assess(babbled, folds=4, seed=1, permutations=99)


def test_the_same_seed_gives_the_same_numbers(babbled: pd.DataFrame, assessed: bh.Assessment) -> None:
    again = bh.assess(babbled, folds=4, seed=1, permutations=99)
    assert again.to_dict() == assessed.to_dict()
    other = bh.assess(babbled, folds=4, seed=2, permutations=99)
    assert other.structures["log_loss"]["naive"] != assessed.structures["log_loss"]["naive"]


def test_all_structures_are_compared_and_numbers_are_finite(assessed: bh.Assessment) -> None:
    assert list(assessed.structures.index) == ["naive", "tan", "joint", "previous_gait", "learned"]
    assert np.isfinite(assessed.structures["log_loss"].to_numpy()).all()
    assert json.loads(json.dumps(assessed.to_dict())) == assessed.to_dict()
    assert assessed.settings["prior"] == PRIOR
    # Knowing the gait says more about every effect than not knowing it.
    assert (assessed.variables["log_loss"] < assessed.variables["log_loss_without_gait"]).all()
    assert assessed.confusion.to_numpy().sum() == 400


def test_folds_spread_every_gait_evenly() -> None:
    frame = pd.concat([SMALL] * 11, ignore_index=True)
    rows = CodedRows.of(frame, bh.GaitRepertoire.of(GAITS), AXES)
    fold = rows.folds(5, np.random.default_rng(0))
    assert sorted(np.bincount(fold)) == [22] * 5
    for gait in (0, 1):
        shares = np.bincount(fold[rows.column("Gait") == gait])
        assert shares.max() - shares.min() <= 1
    assert not np.array_equal(fold, rows.folds(5, np.random.default_rng(1)))


def test_dependence_is_found_and_independence_is_not() -> None:
    rng = np.random.default_rng(5)
    n = 600
    bins = rng.integers(0, 4, size=(n, 3))
    angle = -math.pi + bins[:, 1] * math.pi / 2
    follows = np.where(rng.random(n) < 0.7, bins[:, 1], bins[:, 2])
    frame = pd.DataFrame(
        {
            "gait": np.array(GAITS)[rng.integers(0, 2, n)],
            "distance": 0.02 + 0.05 * (bins[:, 0] % 2),
            "angle": angle,
            "heading": -math.pi + follows * math.pi / 2,
        }
    )
    found = bh.assess(frame, GAITS, axes=AXES, permutations=199)
    p = {(row.x, row.y): row.p_permutation for row in found.independence.itertuples()}
    assert p["Angle", "Heading"] == 1 / 200
    assert p["Distance", "Angle"] > 0.05
    assert found.structures["log_loss"].idxmin() in ("tan", "learned")
    assert ("Angle", "Heading") in found.found["tan"].edges or ("Heading", "Angle") in found.found["tan"].edges
    assert found.found["learned"].edges  # the strong link survives the price of its parameters
    assert {("Angle", "Heading"), ("Heading", "Angle")} & set(found.found["learned"].edges)
    assert found.structures["gain_low"]["tan"] > 0
    assert "previous_gait" not in found.structures.index
    assert "previous_gait" in found.notes[0]


def test_shuffles_keep_the_margins() -> None:
    rows = CodedRows.of(SMALL, bh.GaitRepertoire.of(GAITS), AXES)
    counts = rows.count().tabulate(("Gait", "Angle", "Heading"))
    gs = permuted(rows, "Angle", "Heading", 200, np.random.default_rng(0))
    assert gs.min() >= -1e-9
    assert len({round(g, 9) for g in gs}) > 1
    # The data's own table is one of the shuffles, and no shuffle has more information than a perfect link.
    assert (np.abs(gs - g_statistic(counts)) < 1e-9).any()


def test_scores_of_known_forecasts() -> None:
    happened = np.array([0, 1])
    sure = np.eye(2)
    even = np.full((2, 2), 0.5)
    assert (log_loss(sure, happened), brier(sure, happened)) == (0.0, 0.0)
    assert log_loss(even, happened) == pytest.approx(math.log(2))
    assert brier(even, happened) == pytest.approx(0.5)
    assert brier(sure[::-1], happened) == 2.0
    assert log_loss(sure[::-1], happened) == math.inf


def test_a_row_that_no_gait_could_have_done_is_a_miss() -> None:
    rows = CodedRows.of(SMALL, bh.GaitRepertoire.of(GAITS), AXES)
    nothing = np.zeros((len(ROWS), 2))
    assert accuracy(rows, nothing) == 0.0
    assert confusion(rows, nothing).to_numpy().sum() == 0
    truth = np.eye(2)[rows.column("Gait")]
    truth[0] = 0.0
    assert accuracy(rows, truth) == pytest.approx(0.9)
    assert confusion(rows, truth).to_numpy().tolist() == [[4, 0], [0, 5]]


def test_without_a_prior_the_impossible_is_counted(babbled: pd.DataFrame) -> None:
    found = bh.assess(babbled, prior=0.0, permutations=1, structures=["tan"])
    assert found.structures["impossible"]["naive"] > 0
    assert math.isinf(found.structures["log_loss"]["naive"])
    assert found.to_dict()["structures"][0]["log_loss"] is None
    assert math.isnan(found.structures["gain"]["tan"])


def test_a_model_brings_its_structure_and_its_own_scores(babbled: pd.DataFrame) -> None:
    model = bh.ForwardModel.fit(babbled, bh.load_robot("khepera").gaits, structure="tan")
    found = bh.assess(babbled, model=model, permutations=1, structures=[])
    assert found.settings["structure"] == "tan"
    gait_part = len(babbled) * math.log(1 / 10)
    expected = -(model.log_likelihood(babbled) - gait_part) / len(babbled)
    assert found.given["log_loss"] == pytest.approx(expected, rel=1e-12)
    assert found.given["same_rows"] is True
    fresh = bh.babble("khepera", steps=200, seed=11)
    other = bh.assess(fresh, model=model, permutations=1, structures=[])
    assert other.given["same_rows"] is False
    assert other.given["impossible"] > 0
    assert math.isfinite(other.given["log_loss_of_possible"])


def test_nobody_knows_the_rows_of_an_imported_model(babbled: pd.DataFrame, tmp_path: Path) -> None:
    bh.ForwardModel.fit(babbled, bh.load_robot("khepera").gaits).to_xmlbif(tmp_path / "model.xmlbif")
    model = bh.import_network(tmp_path / "model.xmlbif")
    found = bh.assess(babbled, model=model, permutations=1, structures=[])
    assert (found.given["same_rows"], found.given["prior"]) == (None, None)
    assert found.to_dict()["given"]["same_rows"] is None
    assert "(naive): imported, so it may have been made from these very rows" in str(found)


def test_rows_of_a_gait_that_a_model_never_chooses_are_impossible_to_it() -> None:
    learned = bh.ForwardModel.fit(SMALL, GAITS, 0.5, axes=AXES)
    given = {name: table.copy() for name, table in learned.local_tables.items()}
    model = ForwardModel.of_tables(learned.gaits, learned.axes, NAIVE, {**given, "Gait": np.array([1.0, 0.0])})
    scores = bh.assess(SMALL, model=model, permutations=1, structures=[]).given
    assert scores["impossible"] == (SMALL["gait"] == "turn").sum()
    assert scores["log_loss"] == math.inf
    assert math.isfinite(scores["log_loss_of_possible"])


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"folds": 1}, "folds"),
        ({"folds": 11}, "folds"),
        ({"folds": 2.5}, "folds"),
        ({"seed": -1}, "seed"),
        ({"prior": -0.1}, "prior"),
        ({"prior": math.nan}, "prior"),
        ({"permutations": 0}, "permutations"),
        ({"structures": ["tann"]}, "tann"),
        ({"structures": ["naive", "joint"], "axes": EffectAxes.standard(0.05, angle_bins=3600, heading_bins=3600)},
         "wider bins"),
    ],
)  # fmt: skip
def test_wrong_settings_are_refused(settings: dict, says: str) -> None:
    with pytest.raises(bh.InputError, match=says):
        bh.assess(SMALL, GAITS, **{"axes": AXES, "permutations": 1, **settings})


def test_wrong_tables_are_refused() -> None:
    with pytest.raises(bh.InputError, match="which robot"):
        bh.assess(SMALL)
    strange = SMALL.assign(previous_gait="moonwalk")
    with pytest.raises(bh.DataError, match="row 0: previous_gait 'moonwalk'"):
        bh.assess(strange, GAITS, axes=AXES)
    with pytest.raises(bh.InputError, match="no column previous_gait"):
        bh.assess(SMALL.drop(columns="previous_gait"), GAITS, axes=AXES, structures=["previous_gait"])
