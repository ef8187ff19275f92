"""The command line, started with `python -m restitution`."""

from restitution.cli import main

main()
