"""Every code block of the manual runs; those of the quick pages by default, all of them with -m slow."""

import shutil
from pathlib import Path

import pytest
import typer
from blocks import PAGES, ROOT, blocks, lines, run_page

import bayeshunt.cli  # noqa: F401  the commands
from bayeshunt.cli.app import app

QUICK = ("own_structure",)
each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT / "docs").as_posix())


@pytest.fixture
def readers_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the project's data in it, as the README's reader has."""
    shutil.copytree(ROOT / "data", tmp_path / "data")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    return tmp_path


@each_page
def test_every_command_of_a_page_is_one_that_there_is(page):
    """Names, options and values are taken in by the command line, without running it."""
    command = typer.main.get_command(app)
    for block in blocks(page):
        if block.kind not in ("sh", "console", ""):
            continue
        for words, _ in lines(block):
            rest = words[2:] if words[0] == "--plugin" else words
            here = command
            while rest and rest[0] in getattr(here, "commands", {}):
                here, rest = here.commands[rest[0]], rest[1:]
            assert here is not command, words
            here.make_context(here.name, list(rest))


@each_page
def test_python_of_a_page_is_python(page):
    for block in blocks(page):
        if block.kind == "python":
            compile(block.text, page.name, "exec")


@pytest.mark.parametrize("name", QUICK)
def test_a_page_runs(name, readers_folder, bayeshunt):
    assert run_page(ROOT / "docs" / "howto" / f"{name}.md", readers_folder, bayeshunt) > 1


def has_a_test_of_its_own(page):
    """Whether another test names the page: it has to set something up, or to compare."""
    others = [path for path in (ROOT / "tests").rglob("*.py") if path.parent.name != "manual"]
    return any(f'"{page.name}"' in path.read_text(encoding="utf-8") for path in others)


@pytest.mark.slow
@each_page
def test_all_pages_run(page, readers_folder, bayeshunt):
    if has_a_test_of_its_own(page):
        pytest.skip("run by a test of its own")
    run_page(page, readers_folder, bayeshunt)
