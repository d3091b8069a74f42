"""Environments and episodes for the tests."""

import gymnasium

ID = "bayeshunt.envs:Hunt-v0"


def make(**arguments):
    return gymnasium.make(ID, preset="paper", **arguments)


def episode(env, policy, **options):
    """The infos, rewards and end of one episode."""
    seen, info = env.reset(options=options or None)
    infos, rewards, ended = [info], [], (False, False)
    while not any(ended):
        seen, reward, *ended, info = env.step(policy(seen))
        infos.append(info)
        rewards.append(reward)
    return infos, rewards, tuple(ended)
