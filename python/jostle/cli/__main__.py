"""`python -m jostle.cli` is the command `jostle`."""

from jostle.cli import command

command()
