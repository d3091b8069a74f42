"""Tag of the literature tries rules of search: ``python -m benchmarks.tag [--episodes 4000] [--seeds 0 1 2]``.

Pineau, Gordon and Thrun, IJCAI 2003: a robot and an opponent on 29 cells. The robot knows where it is and sees the
opponent only on its own cell, at the start too. A move costs 1, a tag brings 10 on the opponent's cell and costs 10
elsewhere; discount 0.95. The opponent stays with probability 0.2; with 0.4 each it goes away from the robot along
either axis, to one of both sides where neither leads away, and stays where there is no cell to go to. The belief is
exact, so the table says what a rule of search is worth. It says nothing of learning: an opponent that is believed to
walk at random is found nearly as soon as one that is known.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bayeshunt.core.geometry import FloatArray

__all__ = ["POLICIES", "Policy", "Tag", "detect", "likeliest", "play", "qmdp"]

DISCOUNT, TAGGED = 0.95, 10.0
#: What one more move makes of the chance to find the opponent. Of 0.5 to 0.8 the best of 8,000 episodes on seed 1000.
PER_MOVE = 0.65
#: After so many steps what is still to come counts less than a thousandth; so often values are iterated.
_STEPS, _ITERATIONS = 140, 300
_TAG = 4
_MOVES = ((0, 1), (0, -1), (1, 0), (-1, 0))  # north, south, east, west


@dataclass(frozen=True, eq=False)
class Tag:
    """The problem, as tables over C cells. rows: of cells from the north, "." where there is one."""

    rows: tuple[str, ...] = ("#####...##", "#####...##", "#####...##", "..........", "..........")

    @cached_property
    def cells(self) -> FloatArray:
        """East and north of every cell, whole numbers [C, 2]."""
        places = [(x, -y) for y, row in enumerate(self.rows) for x, mark in enumerate(row) if mark == "."]
        return np.array(places)

    @cached_property
    def moves(self) -> FloatArray:
        """Cell that a move north, south, east and west leads to; where there is none, the same one [C, 4]."""
        number = {tuple(cell): place for place, cell in enumerate(self.cells.tolist())}
        return np.array(
            [[number.get((x + dx, y + dy), place) for dx, dy in _MOVES] for (x, y), place in number.items()]
        )

    @cached_property
    def steps(self) -> FloatArray:
        """Moves from cell to cell [C, C]."""
        count = len(self.cells)
        far = np.where(np.eye(count, dtype=bool), 0, count)
        for _ in range(count):
            far = np.minimum(far, 1 + far[self.moves].min(axis=1))
        return far

    @cached_property
    def flight(self) -> FloatArray:
        """P(where the opponent goes | where the robot was, where it was) [C, C, C]."""
        count = len(self.cells)
        table = np.zeros((count, count, count))
        for robot, opponent in np.ndindex(count, count):
            goes = table[robot, opponent]
            goes[opponent] += 0.2
            away = self.cells[opponent] - self.cells[robot]
            for off, both in zip(away, ((2, 3), (0, 1)), strict=True):
                to = both if off == 0 else both[:1] if off > 0 else both[1:]
                for move in to:
                    goes[self.moves[opponent, move]] += 0.4 / len(to)
        return table

    @cached_property
    def walk(self) -> FloatArray:
        """The same of an opponent that stays, or goes any way, with 0.2 each [C, C, C]: what is not so."""
        count = len(self.cells)
        one = 0.2 * (np.eye(count) + np.eye(count)[self.moves].sum(axis=1))
        return np.broadcast_to(one, (count, count, count))

    @cached_property
    def values(self) -> FloatArray:
        """Discounted return of every action if the opponent is always seen: [C robot, C opponent, 5]."""
        count = len(self.cells)
        every, there = np.arange(count), np.eye(count, dtype=bool)
        values = np.zeros((count, count, _TAG + 1))
        for _ in range(_ITERATIONS):
            # [robot before, opponent before, robot after]
            later = DISCOUNT * self.flight.reshape(-1, count) @ values.max(axis=2).T
            later = later.reshape(count, count, count)
            for move in range(_TAG):
                values[..., move] = later[every, :, self.moves[:, move]] - 1.0
            values[..., _TAG] = np.where(there, TAGGED, later[every, :, every] - TAGGED)
        return values


#: Beliefs [N, C] and cells of the robot [N] -> actions [N]: 0 to 3 a move, 4 a tag.
Policy = Callable[[Tag, FloatArray, FloatArray], FloatArray]


def qmdp(tag: Tag, beliefs: FloatArray, robots: FloatArray) -> FloatArray:
    """Best on average, if from the next step on the opponent were always seen: it never looks for it."""
    return np.einsum("no,noa->na", beliefs, tag.values[robots]).argmax(axis=1)


def likeliest(tag: Tag, beliefs: FloatArray, robots: FloatArray) -> FloatArray:
    """Best if the opponent is where it most probably is."""
    return tag.values[robots, beliefs.argmax(axis=1)].argmax(axis=1)


def detect(tag: Tag, beliefs: FloatArray, robots: FloatArray) -> FloatArray:
    """Expected detection: towards the largest chance to find it, every move discounted; tags what it sees."""
    here = beliefs[np.arange(len(robots)), robots]
    goals = (beliefs * PER_MOVE ** tag.steps[robots]).argmax(axis=1)
    return np.where(here > 0.5, _TAG, tag.steps[tag.moves[robots], goals[:, None]].argmin(axis=1))


class Row(NamedTuple):
    """A row of the table: a rule, and whether the opponent is believed to walk at random."""

    policy: Policy
    wrong: bool = False


#: Name -> rule.
POLICIES: Mapping[str, Row] = {
    "QMDP": Row(qmdp),
    "most likely cell": Row(likeliest),
    "expected detection": Row(detect),
    "expected detection, opponent believed to walk at random": Row(detect, wrong=True),
}


def play(tag: Tag, row: Row, episodes: int, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Return the discounted return of every episode, and whether the opponent was tagged; both start anywhere."""
    believed, count = tag.walk if row.wrong else tag.flight, len(tag.cells)
    robots, opponents = rng.integers(0, count, (2, episodes))
    beliefs = _looked(np.full((episodes, count), 1.0 / count), robots, robots == opponents)
    returns, going = np.zeros(episodes), np.arange(episodes)
    tagged = np.zeros(episodes, dtype=bool)
    for step in range(_STEPS):
        actions = row.policy(tag, beliefs, robots)
        tags, there = actions == _TAG, robots == opponents
        returns[going] += DISCOUNT**step * np.where(tags, np.where(there, TAGGED, -TAGGED), -1.0)
        tagged[going] = tags & there
        left = ~(tags & there)
        robots, opponents, beliefs, actions, going = (
            part[left] for part in (robots, opponents, beliefs, actions, going)
        )
        reach = np.cumsum(tag.flight[robots, opponents], axis=1)
        opponents = np.minimum((reach < rng.random((len(going), 1))).sum(axis=1), count - 1)
        beliefs = np.einsum("no,nop->np", beliefs, believed[robots])
        robots = np.where(actions == _TAG, robots, tag.moves[robots, np.minimum(actions, _TAG - 1)])
        beliefs = _looked(beliefs, robots, robots == opponents)
    return returns, tagged


def _looked(beliefs: FloatArray, robots: FloatArray, seen: FloatArray) -> FloatArray:
    """Beliefs [N, C] after the robots [N] looked on their own cells, where the opponent was ``seen`` [N] or not."""
    here = np.eye(beliefs.shape[1])[robots]
    elsewhere = beliefs * (1.0 - here)
    total = elsewhere.sum(axis=1, keepdims=True)
    missed = np.where(total > 0.0, elsewhere / np.where(total > 0.0, total, 1.0), (1.0 - here) / (here.shape[1] - 1))
    return np.where(seen[:, None], here, missed)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=4000, help="of each seed")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    options = parser.parse_args()
    tag, known = Tag(), "fully observed, the bound (exact)"
    print("| rule | discounted return | tagged |\n| --- | --- | --- |")
    print(f"| {known} | {tag.values.max(axis=2).mean():.2f} | |")
    for name, row in POLICIES.items():
        played = [play(tag, row, options.episodes, np.random.default_rng(seed)) for seed in options.seeds]
        print(_line(name, *(np.concatenate(part) for part in zip(*played, strict=True))), flush=True)


def _line(name: str, returns: FloatArray, tagged: FloatArray) -> str:
    error = returns.std() / len(returns) ** 0.5
    return f"| {name} | {returns.mean():.2f} ± {error:.2f} | {100 * tagged.mean():.0f} % |"


if __name__ == "__main__":
    main()
