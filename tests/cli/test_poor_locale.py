"""Output in a locale that lacks a letter: a question mark, never a Python error."""

import os
import subprocess
import sys

import pytest

CODE = (
    "import sys; from bayeshunt.cli.outputs import remembered_output\n"
    "with remembered_output() as out:\n"
    "    print('robot \\u00fc'); print('-> \\u00fc \\udcfc', file=sys.stderr)"
)


@pytest.mark.parametrize("encoding", ["ascii", "ascii:strict", "ascii:surrogateescape"])
def test_a_letter_that_the_locale_lacks_is_a_question_mark(encoding):
    environment = {**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": encoding}
    done = subprocess.run([sys.executable, "-c", CODE], env=environment, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == b"robot ?\n"
    assert b"Traceback" not in done.stderr


def test_the_posix_locale_itself():
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("LC_", "LANG", "PYTHONIO", "PYTHONUTF8"))}
    environment |= {"LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    done = subprocess.run([sys.executable, "-c", CODE], env=environment, capture_output=True)
    assert (done.returncode, done.stdout) == (0, b"robot ?\n")
