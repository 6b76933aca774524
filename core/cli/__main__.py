"""`python -m core.cli` for where the console script is not on the path."""

from core.cli.app import main

main()
