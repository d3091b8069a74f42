"""Babbling that asks where a row would tell most."""

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import Polar
from bayeshunt.experiments.studies.active import Informed, babble_actively, compare_babbling
from bayeshunt.models.comparison.information import expected_bits


def test_expected_bits_are_those_of_the_definition():
    """H of the mean less the mean H, by drawing."""
    counts, rng = np.array([[3, 0], [1, 0], [0, 0]]), np.random.default_rng(0)

    def entropy(p):
        return -np.sum(np.where(p > 0, p * np.log2(np.maximum(p, 1e-300)), 0.0), axis=-1)

    for column in (0, 1):
        weights = counts[:, column] + 0.5
        drawn = entropy(rng.dirichlet(weights, 200_000)).mean()
        assert expected_bits(counts, 0.5)[column] == pytest.approx(entropy(weights / weights.sum()) - drawn, abs=3e-3)


def test_the_gait_of_which_least_is_known_comes_next():
    axes, rng = EffectAxes.standard(0.057), np.random.default_rng(0)
    chooser = Informed(axes, 3, rng=rng)
    first = chooser(None)
    second = chooser((first, Polar(0.1, 0.0, 0.0)))
    third = chooser((second, Polar(0.1, 0.0, 0.0)))
    assert {first, second, third} == {0, 1, 2}  # each once before any twice
    # a gait that always does the same tells less than one that never does
    told = Informed(axes, 2, rng=rng)
    for k in range(40):
        told((0, Polar(0.1, 0.0, 0.0)))
        told((1, Polar(0.005 * k, 0.1 * (k % 20), 0.1 * (k % 30))))
    assert told((0, Polar(0.1, 0.0, 0.0))) == 1


def test_an_active_table_is_a_babbling_table(tmp_path, bayeshunt, monkeypatch):
    table = babble_actively("khepera", 40, 3)
    assert table.equals(babble_actively("khepera", 40, 3))
    assert set(table["gait"]) == set(bh.load_robot("khepera").gaits.names)
    counts = table["gait"].value_counts()
    assert counts.max() - counts.min() <= 4
    monkeypatch.chdir(tmp_path)
    bayeshunt("babble", "--active", "--steps", "40", "--seed", "3", "--out", "a.parquet", "--quiet")
    assert bh.load_dataset("a.parquet")["gait"].tolist() == table["gait"].tolist()


def test_random_babbling_is_as_it_was():
    assert not bh.babble("khepera", 20, 0).equals(babble_actively("khepera", 20, 0))
    with pytest.raises(bh.InputError, match="choose"):
        bh.babble("khepera", 5, 0, choose=3)


def test_a_comparison_says_both_losses():
    frame = compare_babbling("khepera", at=(30, 60), seeds=(0,), held_out=100)
    assert frame["n"].tolist() == [30, 60]
    assert (frame[["random", "active"]].to_numpy() > 0).all()
    assert frame["random"].is_monotonic_decreasing
