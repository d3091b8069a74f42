"""The README's tour as one walk: every console line of it, in order, in one folder."""

import re
import shlex
from pathlib import Path

import bayeshunt as bh

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
#: Commands whose hunts the walk may do fewer of: by --runs, as their --help says.
COUNTED = ("evaluate",)


def console() -> list[tuple[list[str], list[str]]]:
    """Every command of the README's console blocks as words, and the lines that the README shows of its output."""
    steps: list[tuple[list[str], list[str]]] = []
    for block in re.findall(r"```console\n(.*?)```", README, re.DOTALL):
        for line in block.splitlines():
            if line.startswith("$ "):
                steps.append((shlex.split(line[2:]), []))
            elif steps and block.startswith("$ "):
                steps[-1][1].append(line)
    return steps


def few(words: list[str]) -> list[str]:
    """The same command with one run per bearing."""
    if words[1] not in COUNTED:
        return words
    if "--runs" in words:
        place = words.index("--runs") + 1
        return [*words[:place], "1", *words[place + 1 :]]
    return [*words, "--runs", "1"]


def test_the_tour_is_a_whole_walk() -> None:
    walked = [words[1] for words, _ in console()]
    assert walked[:6] == ["babble", "fit", "query", "hunt", "evaluate", "report"]
    given = [words[1] for words, _ in console() if "--model" in words]
    assert {"hunt", "evaluate"} <= set(given)


def test_the_tour_runs_as_it_stands(bayeshunt, tmp_path) -> None:
    for name, text in re.findall(r"```toml\n# (\S+\.toml)\n(.*?)```", README, re.DOTALL):
        (tmp_path / name).write_text(text, encoding="utf-8")
    for words, shown in console():
        out, err = bayeshunt(*few(words)[1:])
        lines = [line.rstrip() for line in (out + err).splitlines()]
        missing = [line for line in shown if line.strip() not in ("", "...") and line.rstrip() not in lines]
        assert not missing, words
        if words[1] == "hunt":
            assert "Preset 'paper', because model.json is a model of its robot, 'khepera'." in " ".join(out.split())
    assert (tmp_path / "hunt.html").stat().st_size > 10_000
    assert (tmp_path / "report.html").stat().st_size > 10_000


def test_the_shipped_table_is_the_tours_first_step(bayeshunt, tmp_path) -> None:
    """The table under data/ goes the same way: fit, query, hunt, evaluate."""
    table = str(ROOT / "data" / "khepera_babbling.parquet")
    for words, _ in console()[1:5]:
        bayeshunt(*[table if word == "babbling.parquet" else word for word in few(words)[1:]])
    assert (tmp_path / "results" / "summary.md").is_file()


def test_the_pooled_table_shows_what_the_presets_say() -> None:
    """Its numbers of the paper are the published figures that ship."""
    page = (ROOT / "docs" / "what_had_to_be_true.md").read_text(encoding="utf-8")
    for planner, arenas in bh.load_experiment("oses2010").published.items():
        for arena, said in arenas.items():
            rows = [line for line in page.splitlines() if line.startswith(f"| `{planner}` {arena}")]
            row = next(line for line in rows if " of 700" in line)
            assert f"{said.caught} of {said.runs}, {100 * said.share:.2f} %" in row
