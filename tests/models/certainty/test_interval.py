"""How sure an answer is: against numerical integration, plain draws of the tables, and the models behind the rows."""

import math

import numpy as np
import pandas as pd
import pytest
from model_cases import repertoire
from scipy.special import betaincinv

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.models.counting.joint import JointCounts

LEVELS = np.array([0.025, 0.5, 0.975])


def two_gaits(counts, prior, gait_prior="uniform"):
    """A naive model of two gaits whose cells (gait, Distance, Angle, Heading) were seen so often."""
    gaits = bh.GaitRepertoire((bh.Gait("left"), bh.Gait("right")), body_length=0.1, duration=1.0)
    axes = bh.EffectAxes(
        bh.Axis.linear("Distance", 0.1, 3), bh.Axis.full_turn("Angle", 4), bh.Axis.full_turn("Heading", 2)
    )
    cells = np.array(sorted(counts))
    sums = np.zeros((2, 1, 4), dtype=np.int64)
    sums[:, 0, 2] = 1
    joint = JointCounts(gaits, axes, cells, np.array([counts[tuple(c)] for c in cells.tolist()]), sums)
    return bh.ForwardModel(joint, prior, gait_prior)


COUNTS = {(0, 1, 1, 0): 3, (0, 1, 2, 1): 2, (0, 2, 1, 0): 4, (1, 1, 1, 0): 1, (1, 0, 1, 1): 6, (1, 1, 0, 1): 2}


def integrated(betas, levels=LEVELS, points=240):
    """Quantiles of X / (X + Y) with X and Y products of two Beta variables each, on a fine product grid."""
    logits = np.linspace(-16.0, 16.0, points)
    levels_at = 1.0 / (1.0 + np.exp(-logits))
    weights = levels_at * (1.0 - levels_at)
    weights /= weights.sum()

    def product(pairs):
        one, two = (np.log(np.maximum(betaincinv(a, b, levels_at), 1e-300)) for a, b in pairs)
        values, share = (one[:, None] + two).ravel(), (weights[:, None] * weights).ravel()
        order = np.argsort(values)
        return values[order], share[order]

    (x, x_share), (y, y_share) = map(product, betas)
    below, kept = np.cumsum(x_share) - x_share / 2, y_share > 1e-9
    found = []
    for level in levels:
        low, high = -30.0, 30.0
        for _ in range(30):
            middle = (low + high) / 2
            reached = float(y_share[kept] @ np.interp(middle + y[kept], x, below))
            low, high = (middle, high) if reached < level else (low, middle)
        found.append(1.0 / (1.0 + math.exp(-low)))
    return np.array(found)


@pytest.mark.parametrize(("prior", "pseudo"), [(0.5, None), (0.0, None), (1.0, None), (0.5, 0.1)])
def test_two_gaits_as_by_numerical_integration(prior, pseudo):
    model = two_gaits(COUNTS, prior)
    answer = bh.InverseModel(model).posterior(0.15, 0.5 * math.pi)
    d, a = answer.cell.distance_bin, answer.cell.angle_bin
    betas = []
    for gait in range(2):
        pairs = []
        for variable, states, at in (("Distance", 3, d), ("Angle", 4, a)):
            column = model.joint.marginal(variable)[:, gait]
            weight = pseudo or prior or 1.0 / states
            pairs.append((column[at] + weight, column.sum() - column[at] + (states - 1) * weight))
        betas.append(pairs)
    found = answer.interval(pseudo=pseudo)
    expected = integrated(betas)
    np.testing.assert_allclose(found.loc["left"], expected, atol=1e-3)
    np.testing.assert_allclose(found.loc["right"], 1.0 - expected[::-1], atol=1e-3)


def test_two_gaits_with_a_heading_and_an_estimated_gait_prior_as_by_plain_draws():
    model = two_gaits(COUNTS, 0.5, "empirical")
    answer = bh.InverseModel(model).posterior(0.15, 0.5 * math.pi, 0.0)
    rng, n = np.random.default_rng(5), 200_000
    shares = rng.dirichlet(model.joint.marginal("Gait") + 0.5, n).T
    bins = {"Distance": answer.cell.distance_bin, "Angle": answer.cell.angle_bin, "Heading": answer.cell.heading_bin}
    for variable, at in bins.items():
        counts = model.joint.marginal(variable)
        for gait in range(2):
            shares[gait] *= rng.dirichlet(counts[:, gait] + 0.5, n)[:, at]
    expected = np.quantile(shares / shares.sum(axis=0), LEVELS, axis=1).T
    np.testing.assert_allclose(answer.interval(), expected, atol=4e-3)


def drawn(model, answer, n, rng):
    """P(Gait | Distance, Angle) under tables drawn cell by cell, for a structure over the effects alone."""
    structure, bins = model.structure, (answer.cell.distance_bin, answer.cell.angle_bin)
    letters = {"Gait": "g", "Distance": "d", "Angle": "a", "Heading": "h"}
    operands, spelt = [], []
    for effect in ("Distance", "Angle", "Heading"):
        names = (effect, *structure.parents(effect))
        weights = model.counted_cells.tabulate(names) + model.prior
        gammas = rng.standard_gamma(np.broadcast_to(weights, (n, *weights.shape)))
        operands.append(gammas / gammas.sum(axis=1, keepdims=True))
        spelt.append("n" + "".join(letters[name] for name in names))
    joint = np.einsum(",".join(spelt) + "->ngda", *operands, optimize=True)[:, :, bins[0], bins[1]]
    return joint / joint.sum(axis=1, keepdims=True)


@pytest.mark.parametrize("structure", ["naive", "tan", "joint"])
def test_any_structure_as_by_plain_draws(structure, frame):
    axes = bh.EffectAxes(
        bh.Axis.linear("Distance", 0.1, 3), bh.Axis.full_turn("Angle", 4), bh.Axis.full_turn("Heading", 4)
    )
    model = bh.ForwardModel.fit(frame.head(60), list(dict.fromkeys(frame["gait"])), 0.5, axes=axes, structure=structure)
    answer = bh.InverseModel(model).posterior(0.15, 0.5)
    shares = drawn(model, answer, 5_000, np.random.default_rng(3))
    np.testing.assert_allclose(answer.interval(), np.quantile(shares, LEVELS, axis=0).T, atol=0.04)


@pytest.mark.parametrize("structure", ["naive", "tan", "joint", "previous_gait"])
@pytest.mark.parametrize("heading", [None, 0.3])
def test_the_printed_probability_lies_inside(structure, heading, frame):
    rows = frame.assign(previous_gait=frame["gait"].shift(1))
    prior = 0.0 if structure == "naive" else 0.2
    model = bh.ForwardModel.fit(rows, repertoire(), prior, structure=structure)
    inverse = bh.InverseModel(model)
    for part in (inverse, inverse.after("straight")):
        for distance, angle in ((0.19, 0.0), (0.1, 1.0), (0.02, -2.0)):
            answer = part.posterior(distance, angle, heading)
            for level in (0.05, 0.95):
                found = answer.interval(level)
                assert list(found.index) == list(model.gaits.names)
                assert (found["low"] <= answer.values).all()
                assert (answer.values <= found["high"]).all()
                assert found.to_numpy().min() >= 0
                assert found.to_numpy().max() <= 1
                assert (found["low"] <= found["median"]).all()
                assert (found["median"] <= found["high"]).all()


def shipped():
    table = bh.load_dataset("data/khepera_babbling.parquet")
    return bh.ForwardModel.fit(table, bh.load_robot("khepera").gaits)


def test_an_answer_from_one_row_is_not_sure():
    answer = bh.InverseModel(shipped()).posterior(0.168, math.radians(-20))
    assert answer.support == 1
    assert answer.values.max() > 0.9995
    found = answer.interval()
    assert 0.1 < found["low"][answer.best] < 0.5
    assert found["high"][answer.best] == 1.0
    assert found.attrs["level"] == 0.95
    assert "1/K" in found.attrs["pseudo"]
    pd.testing.assert_frame_equal(found, answer.interval())  # the same every time
    assert "0.7" in answer.interval(pseudo=0.7).attrs["pseudo"]


def test_more_rows_narrow_the_interval():
    few, many = two_gaits(COUNTS, 0.5), two_gaits({cell: 50 * count for cell, count in COUNTS.items()}, 0.5)
    widths = [
        float((found["high"] - found["low"]).max())
        for found in (bh.InverseModel(m).posterior(0.15, 0.5 * math.pi).interval() for m in (few, many))
    ]
    assert widths[1] < 0.4 * widths[0]


def test_a_back_off_is_said_and_used(frame):
    rows = frame.assign(previous_gait=frame["gait"].shift(1))
    model = bh.ForwardModel.fit(rows, repertoire(), structure="previous_gait", backoff=5.0)
    answer = bh.InverseModel(model).after("straight").posterior(0.19, 0.1)
    assert "back-off, 5 rows" in answer.interval().attrs["pseudo"]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda a: a.interval(1.0), "level"),
        (lambda a: a.interval(0.0), "level"),
        (lambda a: a.interval(pseudo=0), "pseudo is 0"),
        (lambda a: a.interval(pseudo=-1.0), "pseudo"),
        (lambda a: a.sensitivity(2.0), "level"),
    ],
)
def test_what_is_out_of_range_is_refused(call, words):
    answer = bh.InverseModel(two_gaits(COUNTS, 0.5)).posterior(0.15, 0.5)
    with pytest.raises(InputError, match=words):
        call(answer)


@pytest.mark.parametrize("ask", ["interval", "sensitivity"])
def test_an_imported_network_has_no_counts_to_doubt(ask, tmp_path):
    two_gaits(COUNTS, 0.5).to_xmlbif(tmp_path / "net.xmlbif")
    answer = bh.InverseModel(bh.import_network(tmp_path / "net.xmlbif")).posterior(0.15, 0.5)
    with pytest.raises(InputError, match="no counts"):
        getattr(answer, ask)()


@pytest.mark.slow
@pytest.mark.parametrize("prior", [0.1, 0.5, 1.0])
def test_intervals_cover_the_truth(prior):
    """1,000 models drawn from the prior; each gait's true probability lies inside in 93 to 97 of 100."""
    rng, inside, total = np.random.default_rng(int(10 * prior)), 0, 0
    shape, per_gait = (3, 4, 2), 15
    for _ in range(1000):
        truth = [rng.dirichlet(np.full(k, prior), 2) for k in shape]  # [2, K]
        counts: dict = {}
        for gait in range(2):
            for row in zip(
                *(rng.choice(k, per_gait, p=t[gait]) for k, t in zip(shape, truth, strict=True)), strict=True
            ):
                cell = (gait, *map(int, row))
                counts[cell] = counts.get(cell, 0) + 1
        model = two_gaits(counts, prior)
        cells = model.learned_cells
        d, a = cells[rng.integers(len(cells))]
        true = truth[0][:, d] * truth[1][:, a]
        true = true / true.sum()
        found = bh.InverseModel(model).posterior(model.axes.distance.centres[d], model.axes.angle.centres[a]).interval()
        inside += int(found["low"].iloc[0] <= true[0] <= found["high"].iloc[0])
        total += 1
    assert 0.93 <= inside / total <= 0.97, inside / total
    print(f"pseudo-count {prior}: {inside} of {total}")
