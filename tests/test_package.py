"""The package as it is let out: one version everywhere, bounds that are tried, notices of what ships."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def release(version: str) -> tuple[int, ...]:
    """A version as numbers, without zeros at its end."""
    numbers = [int(part) for part in version.split(".")]
    while numbers and numbers[-1] == 0:
        numbers.pop()
    return tuple(numbers)


def test_one_version_everywhere():
    version = PROJECT["version"]
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(r"^## (\d+\.\d+\.\d+)", changelog, re.MULTILINE)[1] == version
    assert f"version: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def pinned(name: str) -> dict[str, str]:
    """The versions that a list of CI names."""
    lines = (ROOT / ".ci" / name).read_text(encoding="utf-8").splitlines()
    return dict(line.split("==") for line in lines if not line.startswith("#"))


def bounds(needed: list[str]) -> dict[str, str]:
    """The lower bounds of requirements."""
    outside = [each for each in needed if not each.startswith("bayeshunt[")]  # another extra
    return dict(re.match(r"([\w-]+)>=([\d.]+)", each).groups() for each in outside)


def test_the_oldest_dependencies_that_are_tried_are_the_lower_bounds():
    tried, least = pinned("oldest.txt"), bounds(PROJECT["dependencies"])
    assert tried.keys() == least.keys()
    for name, bound in least.items():
        assert release(tried[name]) == release(bound), name


def test_the_oldest_extras_that_are_tried_are_their_lower_bounds():
    extras = PROJECT["optional-dependencies"]
    least = {}
    for extra in ("distributed", "gym", "h5", "mujoco", "notebook", "ros"):
        least |= bounds(extras[extra])
    tried = pinned("oldest-extras.txt")
    assert tried.keys() == least.keys()
    for name, bound in least.items():
        assert release(tried[name]) == release(bound), name


def test_every_python_that_is_named_may_install_it():
    named = {line.rsplit(" ", 1)[1] for line in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", line)}
    assert named == {"3.11", "3.12", "3.13"}
    assert PROJECT["requires-python"] == ">=3.11,<3.14"


def test_no_address_stands_in_the_metadata():
    assert not re.search(r"https?://", str({key: value for key, value in PROJECT.items() if key != "readme"}))


def test_the_licence_of_everything_in_the_wheel_is_named():
    assert PROJECT["license"] == "MIT AND BSD-3-Clause"
    for path, kind in zip(PROJECT["license-files"], ("MIT License", "Neither the name of"), strict=True):
        assert kind in (ROOT / path).read_text(encoding="utf-8"), path


def test_every_recording_that_ships_has_its_licence():
    said = (ROOT / "data" / "README.md").read_text(encoding="utf-8")
    for path in (ROOT / "data").iterdir():
        if path.name != "README.md":
            assert f"`{path.name}`" in said, path.name
    assert "CC BY 4.0" in said
    assert "Redistribution and use in source and binary forms" in said


def test_no_page_installs_from_an_index_what_is_on_none():
    files = [*ROOT.glob("*.md"), *(path for folder in ("docs", "notebooks", "bayeshunt") for path in
             (ROOT / folder).rglob("*") if path.suffix in (".md", ".py", ".ipynb"))]  # fmt: skip
    wrong = [
        path.name for path in files if re.search(r"pip install [^\n]*\bbayeshunt\[", path.read_text(encoding="utf-8"))
    ]
    assert len(files) > 100
    assert not wrong


def test_no_generator_is_shared_by_tests():
    shared = re.compile(r"^\w+(?:: [^=\n]+)? = \S*default_rng\([^()\n]*\)$", re.MULTILINE)
    assert shared.search("RNG = np.random.default_rng(0)\n")
    files = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py")}
    assert [name for name, text in files.items() if shared.search(text)] == []
