"""The one way to lay out a table as text: numbers stay whole, and what gives way does so in the order that is said."""

import json
import re
from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest
from rich.console import Console
from rich.text import Text

from bayeshunt.views.terminal.text_tables import TextTable, folding, number, word

NUMBERS = ("0.123456789", "-1,234,567", "99.4 to 100.0")


def shown(table, width, encoding="utf-8"):
    raw = BytesIO()
    console = Console(file=TextIOWrapper(raw, encoding=encoding), width=width, color_system=None, legacy_windows=False)
    table.print(console)
    console.file.flush()
    return raw.getvalue().decode(encoding).splitlines()


@pytest.fixture
def table():
    made = TextTable(word("key"), folding("meaning"), folding("range"), *("a", "b", "c"), title="what it is")
    made.row("some.key", "a meaning of several words", "between 0.0000001 and 12345678901234", *NUMBERS)
    return made


@pytest.mark.parametrize("width", [10, 30, 60, 70, 80, 90, 200])
def test_every_number_stands_in_one_line(table, width):
    lines = shown(table, width)
    assert any(re.search(r"\s+".join(map(re.escape, NUMBERS)), line) for line in lines), lines
    for part in ("some.key", "0.0000001", "12345678901234", "meaning"):
        assert any(part in line for line in lines), (part, lines)


def test_text_folds_before_lines_outgrow_the_terminal(table):
    whole = max(map(len, shown(table, 400)))
    narrowest = whole - (26 - 8) - (36 - 14)  # a meaning keeps 8 characters, a range its longest number
    for width in (whole, whole - 1, narrowest + 7, narrowest):
        assert max(map(len, shown(table, width))) <= width
    assert len(shown(table, whole)) < len(shown(table, whole - 1)) < len(shown(table, narrowest))
    assert max(map(len, shown(table, narrowest - 1))) == max(map(len, shown(table, 10))) == narrowest


def test_a_string_is_as_wide_as_it_need_be():
    made = TextTable(folding("name"), "n", number("m"), ruled=False)
    made.row("long " * 40, 1, 2.5)
    made.row("[bold]:smile:", 10, Text("3"))
    head, first, second = made.lines()
    assert head == "name".ljust(200) + "   n    m"
    assert first == ("long " * 40).ljust(200) + "   1  2.5"
    assert second == "[bold]:smile:".ljust(200) + "  10    3"


def test_sections_and_a_plain_rule(table):
    table.section()
    table.row("another", "", "", 1, 2, 3)
    lines = shown(table, 200)
    assert "─" in lines[3]
    assert [bool(line.strip()) for line in lines] == [True, False, True, True, True, False, True, False]
    plain = shown(table, 200, "ascii")
    assert plain == [line.replace("─", "-") for line in lines]


def test_a_row_has_a_cell_for_each_column(table):
    with pytest.raises(ValueError, match="2 cells for 6 columns"):
        table.row("one", "two")


# --- every command that prints a table, in narrow terminals ----------------------------------------


@pytest.fixture(scope="module")
def folder(tmp_path_factory, khepera_frame, khepera_model):
    """A folder with what the commands read."""
    from bayeshunt.data import babbling_table

    made = tmp_path_factory.mktemp("tables")
    babbling_table.save(khepera_frame, made / "b.parquet")
    khepera_model.save(made / "m.json")
    (made / "walkers").mkdir()
    lines = [f"{walker},{0.4 * n:g},{1.2 * 0.4 * n:g},{walker}" for walker in (1, 2) for n in range(24)]
    (made / "walkers" / "street.csv").write_text("id,time,x,y\n" + "\n".join(lines))
    return made


SMALL = ["--set", "protocol.thetas=[1.0]", "--set", "model.babbling_steps=200", "--runs", "2", "--jobs", "1", "-q"]
COMMANDS = {
    "settings": ["settings"],
    "settings robot": ["settings", "robot"],
    "planners": ["planners"],
    "planners intercept": ["planners", "intercept"],
    "robots": ["robots"],
    "prey": ["prey"],
    "presets": ["presets"],
    "query": ["query", "m.json", "--distance", "0.16", "--angle", "0.5", "--explain"],
    "hunt": ["hunt", "--planner", "reactive", "--model", "m.json"],
    "evaluate": ["evaluate", "--planner", "proportional_navigation", "--planner", "reactive", "--per-theta",
                 "--out", "results", *SMALL],
    "status": ["status", "results"],
    "sweep": ["sweep", "--axis", "noise=0.5,1.0", "--planner", "proportional_navigation", "--arena", "walled", *SMALL],
    "tradeoff": ["tradeoff", "--vary", "distance=50", "--planner", "reactive", *SMALL],
    "assess": ["assess", "b.parquet", "--folds", "2", "--permutations", "9", "--structure", "tan"],
    "explore": ["explore", "--out", "room.json", "--steps", "100"],
    "score": ["score", "b.parquet", "--model", "stays", "--model", "table", "--folds", "2", "-q"],
    "routes": ["routes", "--explored", "9", "--maps", "1", "--runs", "1",
               "--set", "protocol.time_limit=6", "-q"],
    "prey follow": ["prey", "follow", "walkers", "--unit", "m", "--walkers", "1", "--model", "constant_velocity", "-q"],
}  # fmt: skip
NUMBER = re.compile(r"[-+]?\d[\d.,]*(?:e[-+]\d+)?%?")


def test_the_list_holds_every_command_that_prints_a_table():
    """One more? Then it belongs into the list above."""
    import bayeshunt

    source = "".join(
        path.read_text(encoding="utf-8") for path in (Path(bayeshunt.__file__).parent / "cli").glob("*.py")
    )
    called = set(re.findall(r"\b(\w+_tables?|\w+_page|\w+_bars|align)\(", source))
    assert called == {
        "align", "assessment_tables", "episode_table", "explanation_table", "names_table", "planner_page",
        "planners_table", "posterior_bars", "scores_table", "settings_table", "status_table", "success_table",
        "sweep_table", "tradeoff_table", "forward_table", "routes_table", "following_table",
        "open_tables", "count_tables", "_write_tables",  # these are of data
    }  # fmt: skip


@pytest.mark.parametrize("name", COMMANDS)
def test_no_number_is_cut_at_80_and_at_60_columns(bayeshunt, monkeypatch, name):
    """Every number and name of the same table in a very wide terminal stands in the narrow one, as often."""
    from bayeshunt.views.terminal import terminal

    if name == "status":  # of an evaluation, which another worker may run
        bayeshunt(*COMMANDS["evaluate"])

    def numbers(width):
        monkeypatch.setattr(terminal.out, "width", width)
        out, _ = bayeshunt(*COMMANDS[name])
        lines = [line for line in out.splitlines() if not re.search(r"^Change one:|^next:", line)]
        if name == "tradeoff":  # the time of a decision is another each time
            lines = [re.sub(r"\d+\.\d\d(?=\s+[\d.]+ *$)", "", line) for line in lines]
        assert "…" not in out
        return sorted(NUMBER.findall("\n".join(lines))), out

    whole, _ = numbers(400)
    assert whole or name in ("prey", "presets")
    for width in (80, 60):
        narrow, out = numbers(width)
        assert narrow == whole
        if width == 80 and name not in ("planners intercept", "explore"):  # which end in a line to copy
            assert max(map(len, out.splitlines())) <= 80


def test_json_numbers_stand_in_the_table(bayeshunt):
    """What a machine reads is what a person reads at 60 columns."""
    rows = json.loads(bayeshunt("evaluate", "--planner", "reactive", "--arena", "open", "--json", *SMALL)[0])["rows"]
    out, _ = bayeshunt("evaluate", "--planner", "reactive", "--arena", "open", *SMALL)
    (total,) = [row for row in rows if row["theta"] is None]
    assert f"{total['caught']}/{total['runs']}" in out
    assert f"{100 * total['ci_low']:.1f} to {100 * total['ci_high']:.1f}" in out


def test_no_word_is_cut_in_a_narrow_terminal():
    made = TextTable(folding("planner"), folding("meaning"), "caught")
    made.row("prediction", "the gait that leads where the prey will be", "653/700")
    lines = shown(made, 30)
    assert any(line.split()[:1] == ["prediction"] for line in lines)
    words = {word for line in lines for word in line.split()}
    assert {
        "planner",
        "meaning",
        "prediction",
        "653/700",
        *["the", "gait", "that", "leads", "where", "prey", "will", "be"],
    } <= words


def test_a_long_name_is_broken_between_its_words():
    made = TextTable(folding("planner"), "caught")
    made.row("proportional_navigation", "653/700")
    words = [line.split() for line in shown(made, 22)]
    assert ["proportional_", "653/700"] in words
    assert ["navigation"] in words
