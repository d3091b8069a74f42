"""``python -m bayeshunt``."""

from bayeshunt.cli import main

main()
