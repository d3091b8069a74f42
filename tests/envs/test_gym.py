"""Hunt-v0 is what users of Gymnasium expect."""

import copy
import importlib.util
import pickle
import subprocess
import sys
from itertools import pairwise

import gymnasium
import numpy as np
import pytest
from episodes import ID, episode, make
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import DependencyNotInstalled, ResetNeeded
from gymnasium.utils.env_checker import check_env

import bayeshunt as bh
import bayeshunt.envs
from bayeshunt.core.errors import ConfigError, InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.planners.policy import observation

pytestmark = pytest.mark.filterwarnings("error")


@pytest.mark.parametrize("arguments", [{}, {"arena": "open", "reward": "shaped"}, {"robot": "car"}])
@pytest.mark.parametrize("render_mode", [None, "rgb_array"])
def test_gymnasiums_own_checks(arguments, render_mode):
    check_env(make(**arguments, render_mode=render_mode).unwrapped, skip_render_check=render_mode is None)


@pytest.mark.skipif(importlib.util.find_spec("stable_baselines3") is None, reason="no stable-baselines3 here")
def test_stable_baselines_own_checks():
    from stable_baselines3.common.env_checker import check_env as check

    check(make())


def test_every_name_it_has():
    for name in (ID, "bayeshunt:Hunt-v0", "bayeshunt.envs:bayeshunt/Hunt-v0", "bayeshunt/Hunt-v0", "Hunt-v0"):
        assert gymnasium.make(name).unwrapped.__class__ is bayeshunt.envs.HuntEnv
        assert gymnasium.spec(name.partition(":")[2] or name).max_episode_steps is None
    code = f"import bayeshunt, gymnasium; assert 'Hunt-v0' not in gymnasium.registry; gymnasium.make('{ID}')"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_what_importing_costs():
    code = (
        "import sys, bayeshunt; assert 'gymnasium' not in sys.modules\n"
        "import bayeshunt.envs, gymnasium\n"
        "heavy = {'pandas', 'pyarrow', 'pgmpy', 'matplotlib', 'pettingzoo', 'pygame'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
        f"env = gymnasium.make('{ID}'); env.reset(seed=0); env.step(0)\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_spec_goes_to_json_and_back():
    env = make(arena="open", overrides={"prey.speed": 0.04}, reward="shaped", theta=2.0, sensing="exact")
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    assert again.unwrapped.settings == env.unwrapped.settings
    assert again.unwrapped.settings.prey.speed == 0.04
    one, two = env.reset(seed=3), again.reset(seed=3)
    np.testing.assert_array_equal(one[0], two[0])
    assert one[1] == two[1]


def test_a_miss_costs_the_time_limit_and_is_truncated():
    env = make(arena="open", overrides={"protocol.time_limit": 9.999})
    infos, rewards, ended = episode(env, lambda seen: 0, theta=3.0, hunt_seed=0)
    assert ended == (False, True)
    assert infos[-1]["time"] == 9.999
    assert sum(rewards) == pytest.approx(-1.0, abs=1e-12)


def test_the_shaped_reward_is_the_time_and_a_potential():
    timed, shaped = make(reward="time"), make(reward="shaped")
    actions = iter(range(1000))
    policy = lambda seen: next(actions) % 10  # noqa: E731
    infos, plain, _ = episode(timed, policy, theta=1.0, hunt_seed=4)
    actions = iter(range(1000))
    same, formed, (caught, _) = episode(shaped, policy, theta=1.0, hunt_seed=4)
    assert [i["time"] for i in infos] == [i["time"] for i in same]
    phi = [-info["distance"] for info in infos]
    phi[-1] = 0.0 if caught else phi[-1]
    expected = [r + 0.99 * after - before for r, before, after in zip(plain, phi[:-1], phi[1:], strict=True)]
    np.testing.assert_allclose(formed, expected, atol=1e-12)


def test_seeds_repeat():
    env = make()
    first = [env.reset(seed=123), env.reset()]
    second = [env.reset(seed=123), env.reset()]
    for (seen, info), (again, said) in zip(first, second, strict=True):
        np.testing.assert_array_equal(seen, again)
        assert info == said
    assert first[0][1]["hunt_seed"] != first[1][1]["hunt_seed"]
    assert env.reset(seed=456)[1]["hunt_seed"] != first[0][1]["hunt_seed"]


def test_infos_are_plain_numbers_with_the_same_keys():
    infos, _, _ = episode(make(), lambda seen: 2)
    assert {frozenset(info) for info in infos} == {frozenset(infos[0])}
    for info in infos:
        assert all(type(value) in (bool, int, float) and np.isfinite(value) for value in info.values())
        assert 0 <= info["hunt_seed"] < 2**62


@pytest.mark.parametrize("action", [-1, 10, 2.5, True, None, np.array([1, 2]), "crawl"])
def test_an_action_that_is_none_names_the_gaits(action):
    env = make().unwrapped
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"straight|wide left"):
        env.step(action)


def test_steps_outside_of_an_episode():
    env = make()
    with pytest.raises(ResetNeeded):
        env.step(0)
    episode(env, lambda seen: 0)
    with pytest.raises(InputError, match="reset"):
        env.step(0)
    env.close()
    env.close()


def test_a_prey_that_starts_within_reach_is_caught_at_once():
    with pytest.warns(bh.DataWarning, match="ends before its first decision"):
        env = make(arena="open", overrides={"protocol.prey_distance": 1.0})
    infos, rewards, ended = episode(env, lambda seen: 0)
    assert (ended, rewards, infos[-1]["gaits"]) == ((True, False), [0.0], 0)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"arena": "marsh"}, "unknown arena"),
        ({"reward": "tim"}, "did you mean 'time'"),
        ({"theta": 60.0}, "theta"),
        ({"overrides": {"prey.sped": 1}}, "sped"),
        ({"robot": "kephera"}, "khepera"),
        ({"theta": "east"}, "theta: expected"),
        ({"sensing": 3}, "sensing: expected"),
        ({"overrides": [1]}, "overrides: expected"),
    ],
)
def test_wrong_arguments(arguments, said):
    with pytest.raises((ConfigError, InputError), match=said):
        make(**arguments).reset(seed=0)
    with pytest.raises(InputError, match="render_mode"):
        bayeshunt.envs.HuntEnv(render_mode="film")


@pytest.mark.parametrize("options", [{"theta": "east"}, {"theta": 99.0}, {"hunt_seed": -1}, {"hunt_seed": 1.5}])
def test_wrong_options(options):
    with pytest.raises(InputError, match=r"theta|hunt_seed"):
        make().reset(options=options)


def test_a_copy_is_a_new_environment_of_the_same_arguments():
    env = make(arena="open", theta=2.0).unwrapped
    seen, info = env.reset(seed=5)
    pickle.dumps(env)  # it can be sent; a copy is made by the very state that is sent
    again, said = copy.deepcopy(env).reset(seed=5)
    np.testing.assert_array_equal(seen, again)
    assert info == said


def test_an_observation_by_hand():
    pursuit = Pursuit("paper", "open", 1.0, 0)
    gaits, unit = pursuit.gaits, 10 * pursuit.gaits.body_length
    seen = observation(pursuit.situation, gaits)
    assert (seen.dtype, seen.shape) == (np.float32, (28,))
    np.testing.assert_allclose(seen[:7], [0.5 * np.cos(1), 0.5 * np.sin(1), 0.5, np.cos(1), np.sin(1), 1, 0], atol=1e-6)
    assert seen[7:].tolist() == [0] * 5 + [0, 0, 1, 0] + [1] + [1] + [0] * 10
    pursuit.step(3)
    situation = pursuit.situation
    seen = observation(situation, gaits)
    moved: Polar = situation.transitions[-1]
    np.testing.assert_allclose(
        seen[7:12],
        [1, moved.forward / unit, moved.right / unit, np.cos(moved.heading), np.sin(moved.heading)],
        atol=1e-6,
    )
    np.testing.assert_allclose(seen[12:14], [situation.pose.x / unit, situation.pose.y / unit], atol=1e-6)
    assert seen[16] == pytest.approx(1 - 3.328 / 60)
    assert seen[17:].tolist() == [0, 0, 0, 0, 1] + [0] * 6


def rollout(envs, steps):
    """Everything that two environments tell."""
    seen, infos = envs.reset(seed=[1, 2])
    rng = np.random.default_rng(0)
    rows = [seen]
    for _ in range(steps):
        seen, rewards, caught, late, infos = envs.step(rng.integers(0, 10, 2))
        rows += [seen, rewards, caught, late, infos["hunt_seed"]]
        rows += [one for one in infos.get("final_obs", ()) if one is not None]
    envs.close()
    return rows


RESETS = (gymnasium.vector.AutoresetMode.NEXT_STEP, gymnasium.vector.AutoresetMode.SAME_STEP)
SLOW = [pytest.param(context, marks=pytest.mark.slow) for context in ("forkserver", "spawn")]


@pytest.mark.parametrize("context", ["fork", *SLOW])
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_vectors_in_processes_are_vectors_here(context):
    arguments = {"arena": "walled", "overrides": {"protocol.time_limit": 12.0}}
    for mode in RESETS:
        chosen = {"autoreset_mode": mode}
        here = rollout(gymnasium.make_vec(ID, 2, "sync", vector_kwargs=chosen, **arguments), 12)
        there = rollout(
            gymnasium.make_vec(ID, 2, "async", vector_kwargs={"context": context, **chosen}, **arguments), 12
        )
        same(here, there)


def same(here, there):
    assert len(here) == len(there)
    for one, other in zip(here, there, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("mode", RESETS)
def test_both_autoresets(mode):
    envs = gymnasium.make_vec(
        ID, 2, "sync", vector_kwargs={"autoreset_mode": mode}, overrides={"protocol.time_limit": 7.0}, arena="open"
    )
    envs.reset(seed=[1, 2])
    ends = 0
    for _ in range(8):
        *_, late, infos = envs.step(np.array([0, 0]))
        ends += int(late.sum())
        if late.any() and mode == gymnasium.vector.AutoresetMode.SAME_STEP:
            assert infos["final_obs"][0].shape == (28,)
            assert infos["final_info"]["time"][0] == 7.0
    assert ends >= 4
    envs.close()


def test_a_film_shows_every_control_interval(tmp_path):
    arguments = {"arena": "open", "render_mode": "rgb_array", "overrides": {"protocol.time_limit": 7.0}}
    film = bayeshunt.envs.Film(make(**arguments))
    env = gymnasium.wrappers.RecordVideo(film, str(tmp_path / "film"), episode_trigger=lambda n: True)
    frames = []
    keep = env._capture_frame
    env._capture_frame = lambda: (keep(), frames.append(env.recorded_frames[-1]))
    infos, rewards, ended = episode(env, lambda seen: 2, theta=1.0, hunt_seed=0)
    env.close()
    plain, once, end = episode(make(**arguments), lambda seen: 2, theta=1.0, hunt_seed=0)
    assert (ended, infos[-1], sum(rewards)) == (end, plain[-1], pytest.approx(sum(once)))
    steps = int(7.0 / 0.032 + 1e-9)
    assert len(frames) == len(infos) == 1 + -(-steps // 2)
    assert frames[0].shape == (400, 400, 3)
    assert any((one != other).any() for one, other in pairwise(frames))
    assert len(list((tmp_path / "film").glob("*.mp4"))) == 1
    assert env.metadata["render_fps"] == pytest.approx(1 / 0.064)


@pytest.mark.parametrize("arena", ["open", "walled"])
def test_a_frame_shows_both_robots_where_they_are(arena):
    env = make(arena=arena, render_mode="rgb_array", theta=0.0)
    env.reset(seed=0)
    frame = env.render()
    assert (frame.shape, frame.dtype) == ((400, 400, 3), np.uint8)
    centres = {}
    for name, colour in (("hunter", (0, 114, 178)), ("prey", (213, 94, 0))):
        rows, columns = np.nonzero((frame == colour).all(axis=2))
        assert len(rows) > 20
        centres[name] = rows.mean(), columns.mean()
    assert centres["prey"][1] > centres["hunter"][1] + 20  # straight ahead, along x
    assert centres["prey"][0] == pytest.approx(centres["hunter"][0], abs=3)
    env.close()


def test_a_window_on_no_screen():
    env = make(render_mode="human", overrides={"robot.gait_duration": 0.128})
    env.reset(seed=0)
    env.step(1)
    assert env.render() is None
    env.close()
    env.close()


def test_without_pygame_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygame", None)
    env = make(render_mode="rgb_array")
    env.reset(seed=0)
    with pytest.raises(DependencyNotInstalled, match=r"pip install \"\.\[gym\]\""):
        env.render()


#: Beside the Khepera: legs, a simulator of another kind, a camera, obstacles.
OTHERS = (
    {"preset": "legs"},
    {"preset": "legs_camera"},
    {"robot": "puppy", "overrides": {"world": "mujoco", "protocol.time_limit": 6.0}},
    {"preset": "paper", "arena": "open", "sensing": {"preset": "camera_narrow", "start": "unknown"}},
    {"preset": "clutter", "arena": "clutter"},
    {"preset": "detour", "arena": "barrier"},
)


@pytest.mark.slow
@pytest.mark.parametrize("arguments", OTHERS)
def test_gymnasiums_own_checks_of_other_bodies_senses_and_arenas(arguments):
    check_env(gymnasium.make(ID, **arguments, render_mode="rgb_array").unwrapped)


def test_what_a_step_returns():
    env = make(arena="walled", reward="shaped", overrides={"protocol.time_limit": 10.0})
    seen, _ = env.reset(seed=2)
    kept, ended = [seen], False
    while not ended:
        seen, reward, terminated, truncated, _ = env.step(np.int64(3))
        assert (type(reward), type(terminated), type(truncated)) == (float, bool, bool)
        assert not (terminated and truncated)
        assert env.observation_space.contains(seen)
        kept.append(seen)
        ended = terminated or truncated
    assert np.isfinite(env.observation_space.low).all()
    assert np.isfinite(env.observation_space.high).all()
    assert not any(np.shares_memory(one, other) for one, other in pairwise(kept))


def test_a_time_limit_can_only_shorten():
    env = gymnasium.wrappers.TimeLimit(make(arena="open", overrides={"protocol.time_limit": 7.0}), 2)
    infos, _, ended = episode(env, lambda seen: 0, theta=3.0, hunt_seed=0)
    assert (len(infos), ended) == (3, (False, True))
    longer = gymnasium.wrappers.TimeLimit(make(arena="open", overrides={"protocol.time_limit": 7.0}), 100)
    infos, _, ended = episode(longer, lambda seen: 0, theta=3.0, hunt_seed=0)
    assert (infos[-1]["time"], ended) == (7.0, (False, True))


def test_whatever_renders_arrays_can_be_shown_on_a_screen():
    env = gymnasium.wrappers.HumanRendering(make(render_mode="rgb_array"))
    env.reset(seed=0)
    env.step(1)
    env.close()
