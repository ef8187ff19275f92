"""`python -m restitution` is the command line."""

from restitution.cli import main

main()
