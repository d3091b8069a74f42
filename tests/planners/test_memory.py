"""Kept prey tables: counting by context, smoothing, mixing by what was predicted, files."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from planner_cases import BODY, STEP, situations

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import InputError, ModelFileError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.target.memory import KINDS, PreyMemory, TransitionTables
from bayeshunt.planners.conformance import check_planner
from bayeshunt.planners.sequences.memory import Memory, OrderMemory, PlaceMemory

STRAIGHT, LEFT = Polar(0.16, 0.0, 0.0), Polar(0.12, -0.8, -1.6)
ELSEWHERE = Polar(0.3, 0.5, 0.2)
PLACE = 0.1  # m, less than a stride


def memory_of(**tracks: list[Polar]) -> PreyMemory:
    """Arena -> a run that starts at the origin, seen ten times."""
    memory = PreyMemory.empty(list(tracks), EffectAxes.standard(BODY), PLACE)
    for arena, moves in tracks.items():
        places = [Pose(0.0, 0.0, 0.0)]
        for move in moves:
            places.append(places[-1].compose(move))
        for _ in range(10):
            memory.observe_track(arena, places[:-1], moves)
    return memory


def test_counts_by_context():
    tables = memory_of(pen=[STRAIGHT, LEFT, STRAIGHT]).tables["pen"]
    assert tables["all"].total(()) == 30
    assert tables["all"].cpt()["count"].tolist() == [10, 20]
    assert tables["all"].cpt()["probability"].sum() == pytest.approx(1.0)
    assert tables["all"].cpt()["distance"].tolist() == pytest.approx([21.5 * 0.0057, 28.5 * 0.0057])  # cell centres
    assert tables["all"].uniform == pytest.approx(1 / (100 * 36 * 36))
    assert tables["all"].centre((28, 18, 18)) == pytest.approx((28.5 * 0.0057, 0.0, 0.0))
    assert tables["previous"].total(tables["previous"].context(None, STRAIGHT)) == 10  # it turned left after it
    assert tables["previous"].total(tables["previous"].context(None, LEFT)) == 10
    assert tables["place"].total(tables["place"].context(Pose(0.01, 0.01, 0.1), None)) == 10
    assert tables["place"].total(tables["place"].context(Pose(0.01, 0.01, 3.0), None)) == 0  # facing the other way


def test_contexts_by_hand():
    tables = {kind: TransitionTables(kind, EffectAxes.standard(BODY), PLACE) for kind in KINDS}
    assert tables["all"].context(None, None) == ()
    # places of 10 cm; directions in eighths of a turn, counter-clockwise from x, whatever the number of turns
    assert tables["place"].context(Pose(0.25, -0.05, 0.5 * math.pi), None) == (2, -1, 2)
    assert tables["place"].context(Pose(0.25, -0.05, -0.26 * math.pi + 2 * math.pi), None) == (2, -1, 7)
    # turns in eighths, clockwise; distances in five bins of 5.7 mm, none beyond the tenth
    assert tables["previous"].context(None, Polar(0.16, 0.0, -0.5 * math.pi)) == (6, 5)
    assert tables["previous"].context(None, Polar(0.02, 0.0, 0.26 * math.pi - 2 * math.pi)) == (1, 0)
    assert tables["previous"].context(None, Polar(0.5, 0.0, 0.0)) == (0, 9)


def test_what_is_not_known_has_no_context():
    for kind, known in zip(KINDS, (True, False, False), strict=True):
        tables = TransitionTables(kind, EffectAxes.standard(BODY), PLACE)
        assert (tables.context(None, None) is not None) is known


def test_smoothed_probabilities_sum_to_one_over_the_grid():
    tables = memory_of(pen=[STRAIGHT, LEFT]).tables["pen"]["all"]
    cells = round(1 / tables.uniform)
    seen = sum(tables.probability((), move, tables.uniform, 2.0) for move in (STRAIGHT, LEFT))
    unseen = tables.probability((), Polar(0.05, 1.0, 2.0), tables.uniform, 2.0)
    assert seen + (cells - 2) * unseen == pytest.approx(1.0)
    assert tables.probability((), STRAIGHT, 0.5, 2.0) == pytest.approx((10 + 2 * 0.5) / (20 + 2))
    assert tables.probability(None, STRAIGHT, 0.25, 2.0) == pytest.approx(0.25)  # no context: the base alone


def seen_so_far(moves: list[Polar], prey: Polar = ELSEWHERE):
    return replace(situations(1)[0], prey=prey, transitions=tuple(moves), pose=Pose(0.0, 0.0, 0.0), time_step=STEP)


def weights(planner: Memory, moves: list[Polar]) -> dict[str, float]:
    plan = planner.plan(seen_so_far(moves), rng=np.random.default_rng(0))
    columns = [name for name in plan.trace if name.startswith("weight_")]
    return {name.removeprefix("weight_"): plan.trace[name].iloc[0] for name in columns}


def test_memory_is_believed_as_far_as_it_predicts(model):
    planner = Memory(model, tables=memory_of(straight=[STRAIGHT] * 4, curve=[LEFT] * 4), depth=1)
    start = weights(planner, [])
    assert start == {"this_run": 0.5, "straight": 0.25, "curve": 0.25}
    for seen, right, wrong in ((STRAIGHT, "straight", "curve"), (LEFT, "curve", "straight")):
        after = weights(planner, [seen])
        assert after[right] > after["this_run"] > after[wrong]
        assert after[wrong] < 0.001
    stranger = [Polar(0.02, 2.0, 2.5)] * 4  # nothing like it was ever seen: this run alone can learn it
    assert weights(planner, stranger)["this_run"] > 0.99


def test_the_weights_are_the_product_of_the_predictions(model):
    memory = memory_of(pen=[STRAIGHT, LEFT])
    planner = Memory(model, tables=memory, depth=1, believe=0.3)
    table, s = memory.tables["pen"]["all"], 2.0
    u = table.uniform
    moves = [STRAIGHT, STRAIGHT, LEFT]
    base = (10 + s * u) / (20 + s)
    ours = 0.7 * (s * base / s) * ((1 + s * base) / (1 + s)) * (s * base / (2 + s))
    kept = 0.3 * ((10 + s * base) / (20 + s)) ** 3
    assert weights(planner, moves)["pen"] == pytest.approx(kept / (kept + ours), rel=1e-9)


def test_belief_can_be_switched_off_and_forced(model):
    memory = memory_of(pen=[LEFT] * 3)
    assert weights(Memory(model, tables=memory, depth=1, believe=0), [LEFT] * 3) == {"this_run": 1.0, "pen": 0.0}
    assert weights(Memory(model, tables=memory, depth=1, believe=1), [STRAIGHT])["pen"] == 1.0


def test_a_remembered_turn_is_expected_at_its_place(model):
    """The prey turned left at its second place: sampled paths turn there, and only by place or by order."""
    memory = memory_of(pen=[STRAIGHT, LEFT])
    here = seen_so_far([STRAIGHT], prey=Polar(0.16, 0.0, 0.0))  # at the place of the turn, facing as it did
    turned = {}
    for kind in (Memory, PlaceMemory, OrderMemory):
        planner = kind(model, tables=memory, depth=1, believe=1, paths=200)
        plan = planner.plan(here, rng=np.random.default_rng(1))
        assert plan.predicted_prey is not None
        turned[kind] = float(plan.predicted_prey.right[-1])
    sharp = LEFT.right
    assert turned[PlaceMemory] == pytest.approx(sharp, abs=0.02)
    assert turned[OrderMemory] == pytest.approx(sharp, abs=0.02)
    assert turned[Memory] == pytest.approx(sharp / 2, abs=0.02)


@pytest.mark.parametrize("kind", [Memory, PlaceMemory, OrderMemory])
def test_the_planners_conform(kind, model):
    planner = kind(model, tables=memory_of(pen=[STRAIGHT, LEFT, STRAIGHT]), depth=2)
    cases = [*situations(3), seen_so_far([STRAIGHT, LEFT]), replace(seen_so_far([STRAIGHT]), pose=None)]
    check_planner(planner, model.gaits.names, cases, seed=2)
    assert not planner.ab_initio


def test_a_memory_survives_its_file(tmp_path):
    memory = memory_of(pen=[STRAIGHT, LEFT], field=[STRAIGHT])
    path = tmp_path / "memory.json"
    memory.save(path)
    again = PreyMemory.load(path)
    assert again.observations == memory.observations == 30
    for arena, kinds in memory.tables.items():
        for kind, tables in kinds.items():
            assert again.tables[arena][kind].counts == tables.counts
            assert again.tables[arena][kind].axes == tables.axes


def test_damaged_memories_are_refused(tmp_path):
    path = tmp_path / "memory.json"
    memory_of(pen=[STRAIGHT]).save(path)
    text = path.read_text()
    for broken in (text.replace("10", "11", 1), text[:50], "[]", json.dumps({"memory": {}, "checksum": ""})):
        path.write_text(broken)
        with pytest.raises(ModelFileError, match=r"memory\.json: .*(make it again|made by: bayeshunt remember)"):
            PreyMemory.load(path)
    sound = {"format": 1, "tables": [], "distance_width": 0.01}  # but nothing that this version wrote
    checksum = hashlib.sha256(json.dumps(sound, sort_keys=True).encode()).hexdigest()
    path.write_text(json.dumps({"memory": sound, "checksum": checksum}))
    with pytest.raises(ModelFileError, match=r"memory\.json: malformed content"):
        PreyMemory.load(path)
    with pytest.raises(ModelFileError, match="bayeshunt remember"):
        PreyMemory.load(tmp_path / "none.json")


@pytest.mark.parametrize(
    ("setting", "value"), [("believe", 1.5), ("believe", True), ("smoothing", 0), ("paths", 0), ("paths", 2.5)]
)
def test_wrong_settings(setting, value, model):
    with pytest.raises(InputError, match=f"memory: {setting}"):
        Memory(model, tables=memory_of(pen=[STRAIGHT]), **{setting: value})


def test_a_memory_must_be_given(model):
    with pytest.raises(InputError, match="expected the name of a file made by: bayeshunt remember; got 3"):
        Memory(model, tables=3)
    with pytest.raises(InputError, match="memory_place: needs the setting tables"):
        PlaceMemory(model)
    assert math.isclose(sum(weights(Memory(model, tables=memory_of(pen=[LEFT]), depth=1), [LEFT, LEFT]).values()), 1.0)
