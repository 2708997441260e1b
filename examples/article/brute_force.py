"""The article's first program: every ball is tested against every other one.

Drag a ball with the mouse and let go to throw it. What is wrong (the numbers are those in
docs/article.md):

1.  A ball that hits a resting one of the same mass stops, and so does the other one.
7.  The result depends on the order of the balls in the list.
8.  A ball that is thrown fast jumps over others.
9.  Balls on the ground never rest; with `-n 200` they lie in each other.
11. n balls need n(n-1)/2 tests: with `-n 500` the window stutters.
"""

from time import perf_counter

import window

from jostle_lab.article import Simulation

chosen = window.options("brute_force", n=10)
simulation = Simulation(chosen.n, "brute", chosen.seed)

for screen, _ in window.frames(simulation, chosen):
    start = perf_counter()
    simulation.frame()  # for each ball: move, reflect off the walls, collide with all after it
    spent = 1000 * (perf_counter() - start)

    for ball in simulation.particles:
        window.draw_ball(screen, ball)
    window.write(screen, f"{simulation.tests:,} tests, {simulation.hits} hits, {spent:.1f} ms")
