"""Tables of what the fitted unicycle misses: predictions, draws, an inverse in ordinary bins, files, rows."""

from __future__ import annotations

import copy
import json
import pickle

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError, ModelFileError
from bayeshunt.models.motion.residuals import added, missed
from bayeshunt.models.motion.unicycle import Unicycle

AXES = bh.EffectAxes.standard(0.5)


def babbled(rows: int = 600, seed: int = 0, slip: float = 0.5) -> pd.DataFrame:
    """Arcs of four commands, 40 % of the turn lost where the wheels go opposite ways, and where the gait before did."""
    rng = np.random.default_rng(seed)
    wheels = np.array([[1.0, 1.0], [0.4, 1.0], [1.0, 0.4], [-0.6, 0.6]])
    gait = rng.integers(4, size=rows)
    left, right = wheels[gait].T
    turn = 1.2 * (right - left) * (1 - slip * (left * right < 0))
    chord = 0.5 * (left + right) * np.sinc(turn / 2 / np.pi)
    x, y = chord * np.cos(turn / 2), chord * np.sin(turn / 2)
    noise = rng.normal(scale=0.02, size=(3, rows))
    end = bh.Polar.from_cartesian(x + noise[0], -y + noise[1], -turn + noise[2])
    names = np.array(["ahead", "left", "right", "spin"])[gait]
    return pd.DataFrame({
        "gait": names, "distance": end.distance, "angle": end.angle, "heading": end.heading,
        "command_0": left, "command_1": right, "previous_gait": [None, *names[:-1]],
    })  # fmt: skip


FRAME = babbled()
GAITS = ["ahead", "left", "right", "spin"]


def test_a_residual_is_undone() -> None:
    rng = np.random.default_rng(1)
    asked, came = (bh.Polar.from_cartesian(*rng.normal(size=(3, 20))) for _ in range(2))
    again = added(asked, missed(asked, came))
    np.testing.assert_allclose(again.forward, came.forward, atol=1e-12)
    np.testing.assert_allclose(np.cos(again.heading - came.heading), 1.0, atol=1e-12)


@pytest.mark.parametrize(
    "how", [{}, {"prior": 0.03}, {"structure": "previous_gait", "backoff": 5.0}, {"structure": "tan", "prior": 0.1}]
)
def test_what_a_gait_does_is_foreseen_and_drawn(how) -> None:
    model = bh.ForwardModel.fit(FRAME, GAITS, axes=AXES, residual_of="unicycle", **how)
    for gait, rows in FRAME.iloc[1:].groupby("gait"):
        came = bh.Polar(*(rows[name].to_numpy() for name in ("distance", "angle", "heading")))
        pose = model.predict(gait)
        assert (pose.forward, pose.right) == pytest.approx((came.forward.mean(), came.right.mean()), abs=0.01)
        assert pose.heading == pytest.approx(came.heading.mean(), abs=0.01)
        drawn = model.sample(gait, 4000, rng=np.random.default_rng(0))
        assert (drawn.forward.mean(), drawn.right.mean()) == pytest.approx((pose.forward, pose.right), abs=0.05)
    assert model.mean_paths.shape == (4, 13, 3)
    assert model.joint.total == len(FRAME) - ("backoff" in how)


def test_tables_are_of_residuals_and_say_so() -> None:
    model = bh.ForwardModel.fit(FRAME, GAITS, 0.03, axes=AXES, residual_of="unicycle")
    table = model.cpt("Distance")
    assert table.index.name == "Distance residual"
    assert model.table("Angle").name == "P(Angle residual | Gait)"
    assert "residuals of the unicycle" in repr(model)
    assert "what the fitted unicycle misses" in str(model)
    assert model.axes != AXES
    np.testing.assert_allclose(table.sum(), 1.0)
    assert model.counts("Distance").to_numpy().sum() == len(FRAME)
    # the arcs of "ahead" are foreseen to 2 cm: its residuals are in the first bins, and its rows can be opened
    cell = model.counts("Distance")["ahead"]
    rows = model.rows("Distance", cell.idxmax(), "ahead")
    assert len(rows) == cell.max()
    assert set(rows["gait"]) == {"ahead"}
    assert rows["distance"].mean() == pytest.approx(1.0, abs=0.05)  # rows are shown as they were babbled


def test_the_inverse_bins_outcomes_drawn_from_it() -> None:
    model = bh.ForwardModel.fit(FRAME, GAITS, 0.03, axes=AXES, residual_of="unicycle")
    inverse = bh.InverseModel(model)
    assert inverse.model.axes.distance.width == AXES.distance.width
    drawn = model.sample("left", 50_000, rng=np.random.default_rng(5))
    shares = np.bincount(AXES.angle.index(drawn.angle), minlength=36) / 50_000
    np.testing.assert_allclose(inverse.model.probabilities("Angle")[:, 1], shares, atol=0.02)
    ends = {gait: model.predict(gait) for gait in GAITS}
    for gait in ("ahead", "left", "right"):
        answer = inverse.posterior(ends[gait].distance, ends[gait].angle)
        assert answer.best == gait
        assert answer.support > 0
        found = answer.interval()
        assert (found["low"] <= answer.probabilities).all()
        assert (answer.probabilities <= found["high"]).all()
        assert len(answer.explain()) == 4
    assert inverse.model.rows("Gait", "spin").shape[0] == (FRAME["gait"] == "spin").sum()
    assert bh.Network(model).posterior("Gait", {"Distance": 1.0}).sum() == pytest.approx(1.0)


def test_the_gait_before_is_known_to_its_inverse() -> None:
    model = bh.ForwardModel.fit(FRAME, GAITS, axes=AXES, residual_of="unicycle", structure="previous_gait", backoff=5.0)
    inverse = bh.InverseModel(model)
    after = inverse.after("spin")
    assert after.posterior(1.0, 0.0).best == "ahead"
    assert after.model.known == {"PreviousGait": "spin"}
    np.testing.assert_allclose(inverse.model.local_tables["Angle"].sum(axis=0), 1.0)


def test_files_exports_and_processes_keep_it(tmp_path) -> None:
    for how in ({"prior": 0.03}, {"structure": "previous_gait", "backoff": 5.0}):
        model = bh.ForwardModel.fit(FRAME, GAITS, axes=AXES, residual_of="unicycle", **how)
        model.save(tmp_path / "m.json")
        back = bh.ForwardModel.load(tmp_path / "m.json")
        pickle.dumps((model, bh.InverseModel(model)))  # they can be sent; copies are made by the state that is sent
        assert back == model == copy.deepcopy(model)
        assert back.predict("spin") == model.predict("spin")
        one, two = bh.InverseModel(back), copy.deepcopy(bh.InverseModel(model))
        np.testing.assert_array_equal(one.table().to_numpy(), two.table().to_numpy())
        model.to_xmlbif(tmp_path / "m.xmlbif")
        network = bh.import_network(tmp_path / "m.xmlbif")
        assert network.axes.distance.width == pytest.approx(AXES.distance.width)
        np.testing.assert_allclose(network.local_tables["Heading"], one.model.local_tables["Heading"])
    with pytest.raises(InputError, match="save that model itself"):
        one.model.save(tmp_path / "n.json")


def test_a_file_of_another_motion_is_refused() -> None:
    from bayeshunt.files.records import checksum
    from bayeshunt.models.formats import model_file

    record = json.loads(model_file.dumps(bh.ForwardModel.fit(FRAME, GAITS, axes=AXES, residual_of="unicycle")))
    for change in ({"motion": "car"}, {"left": [1.0]}, {"axes": {}}):
        content = {**record["content"], "residual_of": {**record["content"]["residual_of"], **change}}
        with pytest.raises(ModelFileError):
            bh.ForwardModel.loads(json.dumps({**record, "content": content, "checksum": checksum(content)}))


def test_further_rows_are_counted_beside_the_same_motion() -> None:
    one = bh.ForwardModel.fit(FRAME[:300], GAITS, 0.03, axes=AXES, residual_of="unicycle")
    more = one.update(FRAME[300:])
    kept = bh.ForwardModel.fit(FRAME, GAITS, 0.03, axes=AXES, residual_of=one.source.residuals)
    assert more == kept
    assert more.without(FRAME.index[300:]) == one
    assert np.isfinite(more.log_likelihood(FRAME))


def test_commands_may_be_the_gaits_own_or_are_asked_for() -> None:
    bare = FRAME.drop(columns=["command_0", "command_1"])
    with pytest.raises(DataError, match="gait 'ahead' has no command"):
        bh.ForwardModel.fit(bare, GAITS, axes=AXES, residual_of="unicycle")
    gaits = [
        bh.Gait("ahead", (1.0, 1.0)),
        bh.Gait("left", (0.4, 1.0)),
        bh.Gait("right", (1.0, 0.4)),
        bh.Gait("spin", (-0.6, 0.6)),
    ]
    own = bh.ForwardModel.fit(bare, gaits, axes=AXES, residual_of="unicycle")
    assert own == bh.ForwardModel.fit(FRAME, gaits, axes=AXES, residual_of="unicycle")
    with pytest.raises(InputError, match="did you mean 'unicycle'"):
        bh.ForwardModel.fit(FRAME, GAITS, axes=AXES, residual_of="unicicle")


def test_a_simulated_robot_with_paths_hunts_with_it(khepera_frame) -> None:
    robot = bh.load_robot("khepera")
    model = bh.ForwardModel.fit(khepera_frame, robot, 0.03, residual_of="unicycle")
    plain = bh.ForwardModel.fit(khepera_frame, robot, 0.03)
    np.testing.assert_allclose(model.mean_paths[:, :, :2], plain.mean_paths[:, :, :2], atol=0.002)
    episode = bh.hunt("paper", bh.make_planner("planning", model), theta=0.5, seed=0)
    assert episode.caught


def test_it_is_compared_by_the_poses_that_it_gives() -> None:
    residual, plain = (bh.ForwardModel.fit(FRAME, GAITS, 0.03, axes=AXES, residual_of=m) for m in ("unicycle", None))
    apart = bh.compare(plain, residual).difference["Angle"]
    assert apart.shape[0] == 36
    np.testing.assert_allclose(apart.sum(), 0.0, atol=1e-12)


def lagging(rows: int, seed: int, lag: float = 0.3) -> pd.DataFrame:
    """As ``babbled``, of a robot whose speeds follow its commands with a time constant of ``lag`` gaits."""
    rng = np.random.default_rng(seed)
    wheels = np.array([[1.0, 1.0], [0.4, 1.0], [1.0, 0.4], [-0.6, 0.6]])
    gait = rng.integers(4, size=rows)
    asked = np.column_stack([wheels[gait].mean(axis=1), 1.2 * (wheels[gait, 1] - wheels[gait, 0])])
    speed, ends = asked[0], []
    for target in asked:
        times = (np.arange(200) + 0.5) / 200
        now = target + (speed - target) * np.exp(-times[:, None] / lag)
        turned = np.cumsum(now[:, 1]) / 200
        place = (now[:, 0] * np.exp(1j * (turned - now[:, 1] / 400))).sum() / 200
        ends.append((place.real, place.imag, turned[-1]))
        speed = target + (speed - target) * np.exp(-1 / lag)
    x, y, yaw = (np.array(ends) + rng.normal(scale=0.01, size=(rows, 3))).T
    end = bh.Polar.from_cartesian(x, -y, -yaw)
    names = np.array(GAITS)[gait]
    return pd.DataFrame({
        "gait": names, "distance": end.distance, "angle": end.angle, "heading": end.heading,
        "command_0": wheels[gait, 0], "command_1": wheels[gait, 1], "previous_gait": [None, *names[:-1]],
    })  # fmt: skip


def test_a_robot_that_lags_is_foreseen_from_the_gait_before(tmp_path) -> None:
    frame = lagging(400, 2)
    how = {"axes": AXES, "residual_of": "unicycle", "structure": "previous_gait", "backoff": 5.0}
    model = bh.ForwardModel.fit(frame, GAITS, **how)
    motion = model.source.residuals.motion
    assert motion.lag == pytest.approx((0.3, 0.3), abs=0.05)
    assert motion.forward == pytest.approx((0.5, 0.5), abs=0.02)
    assert "lags behind its commands" in str(model)
    for (before, gait), rows in frame.groupby(["previous_gait", "gait"]):
        pose = model.given({"PreviousGait": before}).predict(gait)
        assert pose.heading == pytest.approx(rows["heading"].mean(), abs=0.06)
    unknown = model.predict("spin")  # the gait before is summed over
    assert unknown.heading == pytest.approx(frame.loc[frame["gait"] == "spin", "heading"].mean(), abs=0.06)
    drawn = model.sample("spin", 4000, rng=np.random.default_rng(0))
    assert drawn.heading.mean() == pytest.approx(unknown.heading, abs=0.06)
    assert model.mean_paths[3, -1, 2] == pytest.approx(unknown.heading, abs=1e-6)
    after, steady = (bh.InverseModel(model).after(name).model for name in ("spin", "ahead"))
    assert not np.array_equal(after.local_tables["Heading"], steady.local_tables["Heading"])
    model.save(tmp_path / "m.json")
    assert json.loads((tmp_path / "m.json").read_text())["format"] == 7
    assert bh.ForwardModel.load(tmp_path / "m.json") == model
    mixed = frame.sample(frac=1, random_state=1)
    kept = {**how, "residual_of": model.source.residuals}
    assert bh.ForwardModel.fit(mixed[:100], GAITS, **kept).update(mixed[100:]) == model
    assert bh.ForwardModel.fit(frame, GAITS, 0.03, axes=AXES, residual_of="unicycle").source.residuals.motion.lag == (
        0.0,
        0.0,
    )


def test_a_lagging_motion_part_way_is_the_way_to_its_end() -> None:
    motion = Unicycle((0.5, 0.5), (-1.2, 1.2), (0.4, 0.6))
    told, before = np.array([[1.0, 0.4]]), np.array([[-0.6, 0.6]])
    parts = np.arange(1, 2001) / 2000
    way = motion.predict(np.repeat(told, 2000, axis=0), np.repeat(before, 2000, axis=0), parts)
    speed = np.diff(np.asarray(way.heading), prepend=0.0) * 2000
    target, start = -1.2 * (0.4 - 1.0), -1.2 * 1.2  # clockwise
    np.testing.assert_allclose(speed, target + (start - target) * np.exp(-(parts - 1 / 4000) / 0.6), atol=1e-3)
    settled = motion.predict(told, told)
    np.testing.assert_allclose(np.column_stack(settled), np.column_stack(motion.predict(told)), atol=1e-12)
