"""`python -m jostle_command` is the command `jostle`."""

from jostle_command import main

main()
