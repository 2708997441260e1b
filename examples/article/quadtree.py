"""The article's second program: only balls in the same leaf of a quadtree are tested.

T shows the leaves. Drag a ball with the mouse and let go to throw it. In addition to what is wrong
with brute force (the numbers are those in docs/article.md):

2. White lines between the boxes: these pixels are in no leaf, because sides are cut to integers.
3. A ball on a border is in several leaves, so a third of the tests are repeated.
4. The limit is four subdivisions, but a fifth one is made.
5. A ball outside the window is in no leaf, so nothing hits it.
6. Balls at one place are in several leaves, and need more tests than brute force.
7. The tree contains the rectangles of the frame before.
"""

from time import perf_counter

import window

from jostle_lab.article import Simulation

chosen = window.options("quadtree", n=500)
simulation = Simulation(chosen.n, "quadtree", chosen.seed)

for screen, boxes in window.frames(simulation, chosen):
    start = perf_counter()
    simulation.frame()  # build the tree, collide the balls of each leaf, then move all of them
    spent = 1000 * (perf_counter() - start)

    if boxes:
        for leaf in simulation.leaves:
            window.draw_box(screen, leaf)
    for ball in simulation.particles:
        window.draw_ball(screen, ball)
    pairs = f"{simulation.tests:,} tests, {simulation.repeats:,} of them repeated"
    window.write(screen, f"{pairs}, {simulation.hits} hits, {spent:.1f} ms")
