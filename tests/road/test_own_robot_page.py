"""The page "Your own robot's loop": its code runs, in its order, and does what it says."""

import re
from pathlib import Path

import numpy as np

import bayeshunt as bh

PAGE = Path(__file__).parents[2].joinpath("docs", "own_robot.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def test_its_blocks_run_in_their_order(capsys) -> None:
    names: dict = {}
    for block in BLOCKS:
        exec(block, names)  # a page of our own
    assert len(names["table"]) == 300
    assert names["table"]["gait"].value_counts().to_dict() == dict.fromkeys(names["gaits"].names, 50)
    scores = names["scores"].set_index("model")
    assert scores.loc["residual", "position_m"] < scores.loc["stays", "position_m"] / 5
    assert names["model"].source.residual_of == "unicycle"
    # the left wheel is worn: "ahead" bends to the left, and the model knows
    assert names["model"].predict("ahead").heading < -0.05
    assert names["answer"].best in ("right", "ahead")
    assert names["gaps"][-1] < 0.25, "the ball was reached"
    assert "planning chose" in capsys.readouterr().out


def test_its_other_words_are_true(tmp_path) -> None:
    names: dict = {}
    exec(BLOCKS[0], names)
    gaits = names["gaits"]
    babbler = bh.Babbler(gaits)
    babbler.record(bh.Pose(0, 0, 0))
    babbler.next()
    babbler.record(bh.Pose(0.3, 0, 0))
    babbler.record(bh.Pose(5, 5, 1))  # carried back
    babbler.next()
    babbler.record(bh.Pose(5, 5, 1))
    assert babbler.table()["previous_gait"].isna().all()
    model = bh.ForwardModel.empty(gaits, 0.03)
    hunter = bh.Hunter("reactive", bh.ForwardModel.fit(_rows(gaits), gaits, 0.03))
    hunter.step(bh.Pose(0, 0, 0), bh.Pose(1, 0, np.nan))
    hunter.step(bh.Pose(0.1, 0, 0), None)
    assert "last seen" in hunter.explain()
    assert model.gaits == gaits


def _rows(gaits):
    babbler = bh.Babbler(gaits, seed=1)
    pose = bh.Pose(0.0, 0.0, 0.0)
    babbler.record(pose)
    for number in range(60):
        babbler.next()
        pose = bh.Pose(pose.x + 0.2, pose.y + 0.02 * number, 0.1 * number)
        babbler.record(pose)
    return babbler.table()
