"""The search alone, on trees written by hand."""

from __future__ import annotations

import math

import pytest

from bayeshunt.core.errors import InputError
from bayeshunt.planners.search.search import Search


class Tree:
    """A space from a dict of children and a dict of values."""

    def __init__(self, children: dict[str, str], values: dict[str, float]) -> None:
        self.children, self.values = children, values

    def root(self):
        return "r", self.values["r"]

    def expand(self, handle):
        names = list(self.children.get(handle, ""))
        return names, [self.values[n] for n in names]


#          r(9)
#      a(5)      b(3)
#    c(1) d(4)  e(6) f(7)
TREE = Tree({"r": "ab", "a": "cd", "b": "ef"}, {"r": 9.0, "a": 5.0, "b": 3.0, "c": 1.0, "d": 4.0, "e": 6.0, "f": 7.0})


def run(order: str, *, depth: int = 2, expansions: int | None = None, stop: float = -math.inf, tree=TREE):
    return Search(order, depth, expansions, stop).run(tree)


def names(result, numbers):
    return "".join(result.handles[n] for n in numbers)


def test_best_first_expands_the_least_value():
    result = run("best-first")
    assert names(result, result.expanded) == "rba"
    assert "".join(result.handles) == "rabefcd"
    assert result.handles[result.best] == "c"


def test_breadth_first_expands_in_order_of_generation():
    result = run("breadth-first")
    assert names(result, result.expanded) == "rab"
    assert "".join(result.handles) == "rabcdef"
    assert result.depths == [0, 1, 1, 2, 2, 2, 2]


def test_the_budget_ends_the_search():
    result = run("best-first", expansions=2)
    assert names(result, result.expanded) == "rb"
    assert result.handles[result.best] == "b"


def test_the_stop_value_ends_the_search_when_generated():
    result = run("breadth-first", stop=3.0)
    assert names(result, result.expanded) == "r"
    assert result.handles[result.best] == "b"


def test_nodes_at_the_depth_limit_are_not_expanded():
    result = run("best-first", depth=1)
    assert "".join(result.handles) == "rab"


def test_branch_leads_from_the_root():
    result = run("best-first")
    assert names(result, result.branch(result.best)) == "rac"


def test_equal_values_prefer_the_shallow_and_then_the_first_generated():
    values = {"r": 1.0, "a": 2.0, "b": 3.0, "c": 3.0, "d": 3.0, "e": 3.0, "f": 3.0}
    tree = Tree({"r": "ab", "a": "cd", "c": "e", "b": "f"}, values)
    result = run("best-first", depth=5, tree=tree)
    # After r and a: b (depth 1), c and d (depth 2) are all worth 3.
    assert names(result, result.expanded) == "rabcdfe"
    assert result.handles[result.best] == "a"


def test_of_equally_good_nodes_the_first_generated_is_the_plan():
    tree = Tree({"r": "ab", "a": "c", "b": "d"}, {"r": 9.0, "a": 5.0, "b": 5.0, "c": 1.0, "d": 1.0})
    for order in ("best-first", "breadth-first"):
        result = run(order, tree=tree)
        assert result.handles[result.best] == "c"
        assert len(result.expanded) == 3


def test_the_root_is_never_the_plan():
    tree = Tree({"r": "a"}, {"r": 0.0, "a": 5.0})
    assert run("best-first", tree=tree).best == 1


@pytest.mark.parametrize("values", [{"r": 1.0}, {"r": 1.0, "a": math.nan}])
def test_nothing_to_choose_from_is_an_error(values):
    tree = Tree({"r": "a"} if "a" in values else {}, values)
    with pytest.raises(InputError, match="no node"):
        run("best-first", tree=tree)


def test_unknown_order():
    with pytest.raises(InputError, match=r"depth-first.*best-first"):
        Search("depth-first", 1, None, 0.0)
