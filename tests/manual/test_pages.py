"""Every code block of the manual runs, none excused; those of the quick pages by default, all of them with -m slow."""

from pathlib import Path

import pytest
import typer
from blocks import KINDS, NOTEBOOKS, PAGES, ROOT, SHELLS, blocks, inline, lines, name_of, notebook_blocks
from brought import bring, stand_in
from reader import Reader, is_set_up

import bayeshunt.cli  # noqa: F401  the commands
from bayeshunt.cli.app import app

QUICK = ("docs/howto/own_structure.md",)
each_page = pytest.mark.parametrize("page", PAGES, ids=name_of)


@pytest.fixture
def reader(tmp_path, monkeypatch, bayeshunt):
    """Somebody in a folder with the project's data and files of their own."""
    bring(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    stand_in(tmp_path, monkeypatch)
    someone = Reader(tmp_path, bayeshunt)
    yield someone
    someone.close()


def taken_in(words: list[str]) -> None:
    """See that the command line takes names, options and values, without running it."""
    command = typer.main.get_command(app)
    rest = words[2:] if words[:1] == ["--plugin"] else words
    here = command
    while rest and rest[0] in getattr(here, "commands", {}):
        here, rest = here.commands[rest[0]], rest[1:]
    assert here is not command or (rest and rest[0].startswith("--")), words
    here.make_context(here.name, [*rest], resilient_parsing=here is command)


@each_page
def test_every_command_of_a_page_is_one_that_there_is(page):
    for block in blocks(page):
        if block.kind in SHELLS:
            for line in lines(block):
                if line.program == "bayeshunt":
                    taken_in(line.words[1:])
                else:
                    assert line.program in ("dask", "sha256sum", "python") or is_set_up(line), line.words


@each_page
def test_every_command_in_a_sentence_is_one_that_there_is(page):
    names = typer.main.get_command(app).commands
    for words in inline(page):
        rest = words[2:] if words[:1] == ["--plugin"] else words
        assert rest[0] in names or rest[0].startswith("--"), words


@each_page
def test_no_code_of_a_page_is_excused(page):
    """A block says what it is, and shows as code only what runs: no mark, no indented blocks beside them."""
    text = page.read_text(encoding="utf-8")
    assert all(block.kind in KINDS for block in blocks(page))
    assert text.count("```") == 2 * len(blocks(page))
    assert "<!-- elsewhere" not in text
    assert not [line for line in text.splitlines() if line.startswith(("    bayeshunt ", "    pip ", "    python "))]
    for block in blocks(page):
        if block.kind in SHELLS:
            assert list(lines(block)), f"{block.text}: no command in it; output alone is text"
        if block.kind == "text":
            assert not block.text.startswith(("$ ", "bayeshunt ", "import ")), f"{block.text}: code that does not run"
        if block.kind == "python":
            compile(block.text, page.name, "exec")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=name_of)
def test_blocks_in_the_text_of_a_notebook_are_commands(path):
    """The cells run elsewhere (tests/test_notebooks.py)."""
    for block in notebook_blocks(path):
        assert block.kind in KINDS, block
        for line in lines(block) if block.kind in SHELLS else []:
            assert line.program == "bayeshunt", line.words
            taken_in(line.words[1:])


@pytest.mark.parametrize("name", QUICK)
def test_a_page_runs(name, reader):
    assert sum(reader.read(block) for block in blocks(ROOT / name)) > 1


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page)], ids=name_of)
def test_all_pages_run(page, reader):
    for block in blocks(page):
        assert reader.read(block) or block.kind == "text", block.text
    assert Path.cwd() == reader.folder


@pytest.mark.slow
@pytest.mark.parametrize(
    "path", [p for p in NOTEBOOKS if any(b.kind in SHELLS for b in notebook_blocks(p))], ids=name_of
)
def test_commands_in_the_text_of_a_notebook_run(path, reader, monkeypatch):
    """After the cells before them, whose files they use."""
    monkeypatch.setattr("tempfile.mkdtemp", lambda: str(reader.folder))
    (reader.folder / "notebooks").mkdir()
    reader.names["display"] = print
    for block in notebook_blocks(path):
        monkeypatch.chdir(reader.folder / ("notebooks" if block.kind == "python" else ""))
        assert reader.read(block)
