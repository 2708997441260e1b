"""`python -m jostle` is the command `jostle`."""

from jostle_command import main

main()
