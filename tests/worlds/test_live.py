"""Babbling one's own robot live."""

import math

import pytest

import bayeshunt as bh

GAITS = bh.GaitRepertoire((bh.Gait("go"), bh.Gait("left"), bh.Gait("right")), body_length=0.1, duration=1.0)
MOVES = {"go": bh.Polar(0.2, 0.0, 0.0), "left": bh.Polar(0.15, -0.2, -0.5), "right": bh.Polar(0.15, 0.2, 0.5)}


def babbled(babbler, steps, pose):
    babbler.record(pose)
    for _ in range(steps):
        pose = pose.compose(MOVES[babbler.next().name])
        babbler.record(pose)
    return babbler.table()


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (-3.0, 5.0, 2.5)])
def test_the_table_holds_what_each_gait_did_in_any_frame(start):
    table = babbled(bh.Babbler(GAITS, seed=3), 30, bh.Pose(*start))
    assert table["gait"].value_counts().to_dict() == {"go": 10, "left": 10, "right": 10}
    assert table["previous_gait"].tolist() == [None, *table["gait"].tolist()[:-1]]
    for gait, move in MOVES.items():
        rows = table[table["gait"] == gait]
        for name in bh.Polar._fields:
            assert rows[name].to_numpy() == pytest.approx(getattr(move, name), abs=1e-9)
    model = bh.ForwardModel.fit(table, GAITS, prior=0.1, structure="previous_gait")
    assert model.predict("go").distance == pytest.approx(0.2, abs=0.02)


def test_it_saves_and_is_the_same_for_the_same_seed(tmp_path):
    one, other = (babbled(bh.Babbler(GAITS, seed=1), 12, bh.Pose(0.0, 0.0, 0.0)) for _ in range(2))
    assert one.equals(other)
    bh.save_dataset(one, tmp_path / "mine.parquet")
    assert bh.load_dataset(tmp_path / "mine.parquet")["gait"].tolist() == one["gait"].tolist()


def test_without_a_first_pose_the_first_gait_gives_no_row():
    babbler = bh.Babbler(GAITS)
    first = babbler.next()
    babbler.record(bh.Pose(0.0, 0.0, 0.0))
    assert len(babbler) == 0
    babbler.next()
    babbler.record(bh.Pose(0.1, 0.0, 0.0))
    assert babbler.table()["previous_gait"].tolist() == [first.name]


def test_a_robot_put_elsewhere_carries_nothing_on():
    babbler = bh.Babbler(GAITS)
    babbler.record(bh.Pose(0.0, 0.0, 0.0))
    babbler.next()
    babbler.record(bh.Pose(0.2, 0.0, 0.0))
    babbler.record(bh.Pose(5.0, 5.0, 0.0))
    babbler.next()
    babbler.record(bh.Pose(5.1, 5.0, 0.0))
    table = babbler.table()
    assert table["distance"].tolist() == pytest.approx([0.2, 0.1])
    assert table["previous_gait"].tolist() == [None, None]


def test_wrong_use_is_refused_in_one_line():
    babbler = bh.Babbler(["a", "b"])
    assert babbler.table().empty
    babbler.next()
    with pytest.raises(bh.InputError, match="record where"):
        babbler.next()
    for wrong in ("here", bh.Pose(math.nan, 0.0, 0.0), (1.0, 2.0)):
        with pytest.raises(bh.InputError, match="own_pose: expected"):
            babbler.record(wrong)
    with pytest.raises(bh.InputError, match="seed"):
        bh.Babbler(GAITS, seed=-1)
