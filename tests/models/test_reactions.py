"""What a prey does given where the hunter is: counts that lean on coarser ones, by hand."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from bayeshunt.core.errors import InputError, ModelFileError
from bayeshunt.core.geometry import Polar
from bayeshunt.models.target.reactions import Reactions

BODY = 0.1
AHEAD, LEFT = Polar(0.2, 0.0, 0.0), Polar(0.2, -0.5, -1.0)
BEFORE = Reactions(Polar(*np.array([AHEAD, LEFT]).T), BODY, evasion=0.0)
#: The hunter near and far behind, and near ahead, as the prey has it.
BEHIND, FAR, IN_FRONT = Polar(0.2, math.pi, 0.0), Polar(0.9, math.pi, 0.0), Polar(0.2, 0.0, 0.0)


def chances(table, place):
    return table.chances(np.array([place.distance]), np.array([place.angle]))[0]


def test_before_anything_is_seen_a_prey_prefers_what_takes_it_away():
    assert chances(BEFORE, BEHIND) == pytest.approx([0.5, 0.5])
    shy = Reactions(BEFORE.believed, BODY, evasion=1.0)
    # 0.4 m from a hunter 0.2 m behind after going ahead; by the cosine rule after the other
    left = math.sqrt(0.04 + 0.04 + 2 * 0.04 * math.cos(0.5))
    odds = math.exp((0.4 - left) / BODY)
    assert chances(shy, BEHIND) == pytest.approx([odds / (1 + odds), 1 / (1 + odds)])
    assert chances(shy, IN_FRONT)[1] > 0.5


def test_each_place_leans_on_its_sector_and_that_on_all():
    table = BEFORE.learn([LEFT, LEFT, AHEAD], [BEHIND, FAR, IN_FRONT])
    assert len(table.motions.distance) == 4  # what was seen stands beside what was believed
    everywhere = np.array([0.5, 0.5, 1.0, 2.0]) / 4
    if table.motions.heading[2] < -0.5:  # the order of motions seen is that of their turns
        everywhere[2:] = everywhere[:1:-1]
    left = int(everywhere.argmax())
    sector = everywhere / 3
    sector[left] += 2 / 3
    there = sector / 2
    there[left] += 1 / 2
    assert table.everywhere == pytest.approx(everywhere)
    assert chances(table, BEHIND) == pytest.approx(there)
    assert chances(table, Polar(0.2, math.pi / 2, 0.0)) == pytest.approx(everywhere)  # a side never seen from
    assert chances(table, BEHIND).sum() == pytest.approx(1.0)


def test_what_was_foretold_knew_nothing_of_later_motions():
    seen, where = [LEFT, AHEAD, LEFT, LEFT], [BEHIND, FAR, BEHIND, IN_FRONT]
    table = BEFORE.learn(seen, where)
    for n, told in enumerate(table.foretold()):
        so_far = BEFORE.learn(seen[:n], where[:n])
        # later motions are in the finished table, with nothing counted of them
        assert told[:2] == pytest.approx(chances(so_far, where[n])[:2])
        assert told.sum() == pytest.approx(1.0)


def test_the_table_shows_counts_beside_what_was_believed():
    table = BEFORE.learn([LEFT, LEFT, AHEAD], [BEHIND, BEHIND, IN_FRONT])
    shown = table.table(0.2, math.pi)
    likeliest = shown["probability"].idxmax()
    assert shown.loc[likeliest, ["count", "sector", "everywhere"]].tolist() == [2, 2, 2]
    assert shown.loc[likeliest, "turned"] == pytest.approx(-1.0)
    assert shown["before"].tolist()[:2] == pytest.approx([0.5, 0.5])
    assert shown["probability"].sum() == pytest.approx(1.0)
    for one in (shown, table.table(0.9, 0.3)):
        assert (one["low"] <= one["probability"]).all()
        assert (one["probability"] <= one["high"]).all()
    assert table.rows(0.2, math.pi).startswith("of these 2 transitions with the hunter there; the rest from 2 with")
    assert "of these 0 transitions" in table.rows(0.9, 0.0)


def test_a_place_that_is_not_known_teaches_nothing():
    assert BEFORE.learn([LEFT], []) is BEFORE


def test_a_file_gives_the_same_table(tmp_path):
    table = BEFORE.learn([LEFT, AHEAD], [BEHIND, FAR])
    table.save(tmp_path / "reactions.json")
    again = Reactions.load(tmp_path / "reactions.json")
    assert (again.transitions, again.approaches) == (table.transitions, table.approaches)
    assert np.array_equal(chances(again, BEHIND), chances(table, BEHIND))
    record = json.loads((tmp_path / "reactions.json").read_text())
    record["content"]["body"] = 0.2
    (tmp_path / "reactions.json").write_text(json.dumps(record))
    with pytest.raises(ModelFileError, match="checksum"):
        Reactions.load(tmp_path / "reactions.json")


@pytest.mark.parametrize("wrong", [{"body": 0.0}, {"backoff": 0.0}, {"evasion": -1.0}, {"transitions": (LEFT,)}])
def test_nonsense_is_named(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        Reactions(**{"believed": BEFORE.believed, "body": BODY, **wrong})
