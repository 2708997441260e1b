"""What is drawn over and under the discs."""

from collections.abc import Callable

import numpy as np
import pygame
import pytest
from lab_overlays import SIZE, Notes, camera_of_pixels, frame_of, pixels, touching_of, tree_of

from jostle_lab.draw import marks
from jostle_lab.draw.base_layers import draw_discs, draw_heat, draw_outline, draw_wall_discs
from jostle_lab.draw.marks import Trails, subset
from jostle_lab.draw.palette import ATTRACTOR, FIXED, HEAT, STAGE
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ColourBy, ViewOptions
from jostle_lab.simulate.frame import Attractor, Frame
from jostle_lab.simulate.region import Torus


def drawn(draw: Callable[..., str | None], frame: Frame) -> tuple[Notes, str | None]:
    """What a layer draws, and what it says."""
    notes = Notes()
    return notes, draw(notes, frame, camera_of_pixels())


def crowd(most: int, impulses: float | None = None) -> Frame:
    """A frame of 500 contacts more than `most`, with random impulses if their least is given."""
    many = most + 500
    rng = np.random.default_rng(0)
    places, pairs = rng.uniform(10, 230, (many + 1, 2)), np.arange(many)[:, None] + (0, 1)
    strengths = () if impulses is None else rng.uniform(impulses, impulses + 1, many)
    normals = np.tile((1.0, 0.0), (many, 1))
    return frame_of(places, contacts=touching_of(pairs, normals, np.zeros(many), strengths))


def test_heat_is_warmer_where_leaves_are_fuller() -> None:
    boxes = [(20, 20, 60, 60), (60, 20, 100, 60), (20, 60, 60, 100)]
    painter = SoftwarePainter(SIZE)
    painter.fill(STAGE)
    tree = tree_of(boxes, [1, 1, 1], [0, 8, 4], [True] * 3)
    legend = draw_heat(painter, tree, camera_of_pixels())
    canvas = painter.canvas()
    empty, full, half = (canvas.get_at(place)[:3] for place in ((40, 40), (80, 40), (40, 80)))
    assert (empty, full) == (HEAT[0], HEAT[-1]) and half in HEAT[4:8]
    assert legend is not None and (legend.low, legend.high) == ("0", "8")


def test_an_edge_of_two_neighbours_is_drawn_once_and_small_boxes_are_fainter() -> None:
    notes = Notes()
    boxes = [(0, 0, 200, 200), (0, 0, 100, 100), (100, 0, 200, 100), (0, 0, 4, 4)]
    draw_outline(
        notes, tree_of(boxes, [0, 1, 1, 2], [1] * 4, [False, True, True, True]), camera_of_pixels()
    )
    ends, colours = np.floor(notes.lines_drawn()), notes.colours_drawn()
    assert len(ends) == 4 + 5 + 4  # what goes on is joined

    def alpha(*edge: int) -> int:
        return int(colours[(ends == edge).all(axis=1)][0, 3])

    assert alpha(0, 200, 200, 200) > alpha(0, 100, 200, 100) > alpha(4, 0, 4, 4) > 0
    assert set(ends[-4:, 3] - ends[-4:, 1]) == {0, 200}  # the root last, on top


def test_a_translucent_edge_lets_the_disc_below_show_through() -> None:
    painter = SoftwarePainter(SIZE)
    painter.fill((200, 40, 40))
    painter.lines(np.array([[10.0, 50, 200, 50]]), np.array([[0, 0, 255, 128]], np.uint8))
    red, _, blue = painter.canvas().get_at((100, 50))[:3]
    assert 80 < red < 120 and 120 < blue < 160


def test_a_contact_is_a_bar_along_the_normal_and_deeper_ones_are_warmer() -> None:
    frame = frame_of([(100, 100), (120, 100)], 10.0, contacts=touching_of((0, 1), (1, 0), [0.0]))
    notes, said = drawn(marks.draw_contacts, frame)
    assert said is None
    ((x0, y0, x1, y1),) = notes.lines_drawn()
    assert (x0 + x1) / 2 == pytest.approx(110) and y0 == y1 == pytest.approx(100)
    assert 3 < x1 - x0 < 20
    pairs = touching_of([(0, 1), (0, 2)], [(1, 0), (0, 1)], [0.0, 4.0])
    frame = frame_of([(100, 100), (120, 100), (100, 116)], 10.0, contacts=pairs)
    notes, _ = drawn(marks.draw_contacts, frame)
    calm, deep = notes.colours_drawn()[:, :3].astype(int)
    assert deep[2] < calm[2] and deep[0] >= calm[0] - 10


def test_of_too_many_contacts_or_forces_some_are_drawn_and_it_is_said() -> None:
    notes, said = drawn(marks.draw_contacts, crowd(marks.MOST_CONTACTS))
    assert len(notes.lines_drawn()) == marks.MOST_CONTACTS
    assert said is not None and f"{marks.MOST_CONTACTS:,} of" in said
    notes, said = drawn(marks.draw_force_chains, crowd(marks.MOST_CHAINS, 5.0))
    assert len(notes.lines_drawn()) == marks.MOST_CHAINS
    assert said is not None and f"{marks.MOST_CHAINS:,} largest of" in said


def test_forces_are_lines_between_centres_and_to_walls_the_largest_last_and_widest() -> None:
    pairs = touching_of(
        [(0, 1), (1, 2)], [(1, 0), (1, 0)], [0.0, 0.0], [9.0, 1.0], walls=[(2, (-1, 0), 3.0)]
    )
    frame = frame_of([(100, 100), (120, 100), (140, 100)], 10.0, contacts=pairs)
    notes, said = drawn(marks.draw_force_chains, frame)
    assert said is None
    expected = [(120, 100, 140, 100), (140, 100, 150, 100), (100, 100, 120, 100)]
    np.testing.assert_allclose(notes.lines_drawn(), expected)
    widths = [v[2] for name, v, _ in notes.strokes if name == "lines" for _ in v[0]]
    assert widths == sorted(widths) and widths[-1] > widths[0]
    brightness = notes.colours_drawn().astype(int).sum(axis=1)
    assert (np.diff(brightness) > 0).all()


def test_contacts_without_impulses_are_no_force_chains() -> None:
    for touching in (touching_of([], [], []), touching_of((0, 1), (1, 0), [0.0], [0.0]), None):
        frame = frame_of([(100, 100), (120, 100)], 10.0, contacts=touching)
        notes, said = drawn(marks.draw_force_chains, frame)
        assert said is None and len(notes.lines_drawn()) == 0


def test_sensors_are_rings_and_no_walls() -> None:
    places = [(60 + 10 * k, 60) for k in range(5)]
    frame = frame_of(places, 10.0, movable=[False] * 5, sensors=np.array([1, 1, 2, 1, 1], np.int8))
    notes, _ = drawn(draw_wall_discs, frame)
    assert len(notes.lines_drawn()) == 0
    draw_discs(notes, frame, np.zeros(5, np.uint8), camera_of_pixels())
    rings = [values for name, values, _ in notes.strokes if name == "circle"]
    assert len(rings) == 5 and rings[2][2] != rings[0][2]
    (discs,) = [values for name, values, _ in notes.strokes if name == "discs"]
    assert len(discs[0]) == 0


def test_lines_show_the_angles_of_large_discs_and_springs_but_not_across_a_seam() -> None:
    angles = np.array([0, np.pi / 2, 1, 1], np.float32)
    places = [(50, 50), (150, 100), (250, 50), (200, 200)]
    frame = frame_of(places, [10, 20, 1, 10], angles=angles, movable=[True, True, True, False])
    notes, _ = drawn(marks.draw_spins, frame)
    ends = notes.lines_drawn()
    np.testing.assert_allclose(ends[:, 2:] - ends[:, :2], [(10, 0), (0, 20)], atol=1e-5)
    still, _ = drawn(marks.draw_spins, frame_of(places, 10.0))
    assert len(still.lines_drawn()) == 0
    springs = np.array([(0, 1), (1, 2)], np.int64)
    places = [(10, 50), (40, 50), (300, 50)]
    for container, count in [(None, 2), (Torus(320, 240), 1)]:
        frame = frame_of(places, springs=springs, container=container)
        notes, _ = drawn(marks.draw_springs, frame)
        assert len(notes.lines_drawn()) == count
        assert notes.lines_drawn()[0] == pytest.approx((10, 50, 40, 50))


def test_arrows_point_where_particles_go_and_of_many_the_same_are_shown() -> None:
    frame = frame_of([(50, 50), (200, 200)], 10.0, velocities=[(60, 0), (0, -120)])
    notes, said = drawn(marks.draw_velocities, frame)
    ends = notes.lines_drawn()
    assert said is None
    shafts = ends[:2, 2:] - ends[:2, :2]
    assert shafts[0, 0] > 5 and shafts[0, 1] == 0
    assert shafts[1, 1] == pytest.approx(-2 * shafts[0, 0]) and shafts[1, 0] == 0
    assert len(ends) == 6 and (ends[2:4, :2] == ends[:2, 2:]).all()  # heads begin at the tips
    places = np.random.default_rng(1).uniform(10, 230, (3_000, 2))
    frame = frame_of(places, velocities=np.tile((50.0, 0.0), (3_000, 1)))
    (notes, said), (again, _) = (drawn(marks.draw_velocities, frame) for _ in range(2))
    assert said == f"velocities: {marks.MOST_ARROWS:,} of 3,000 shown"
    assert (notes.lines_drawn() == again.lines_drawn()).all()


def test_the_few_stay_the_same_when_others_go() -> None:
    tags = np.arange(10_000)
    chosen = set(subset(tags, 100).tolist())
    left = np.delete(tags, [k for k in range(0, 10_000, 2) if k not in chosen])
    assert {int(left[k]) for k in subset(left, 100)} == chosen
    assert len(subset(np.arange(5), 100)) == 5


def test_attractors_are_rings_around_a_point_or_a_particle_that_is_there() -> None:
    painter = SoftwarePainter(SIZE)
    painter.fill(STAGE)
    attractors = (Attractor(1.0, (60, 60)), Attractor(1.0, tag=1), Attractor(1.0, tag=99))
    frame = frame_of([(200, 100), (250, 150)], 10.0, attractors=attractors)
    marks.draw_attractors(painter, frame, camera_of_pixels())
    assert painter.canvas().get_at((60, 60))[:3] == pytest.approx(ATTRACTOR, abs=30)
    lit = (pixels(painter) != np.array(STAGE)).any(axis=2)
    assert lit[40:80, 40:80].any() and lit[220:280, 120:180].any()
    lit[30:90, 30:90] = lit[210:290, 110:190] = False
    assert not lit.any()


def test_immovable_discs_in_a_row_are_one_wall_until_they_have_moved_apart() -> None:
    painter = SoftwarePainter(SIZE)
    places = [(100 + 8 * k, 100) for k in range(6)] + [(100, 200), (130, 200)]
    frame = frame_of(places, 4.0, movable=False)
    Picture().draw(painter, frame, camera_of_pixels(), ViewOptions())
    canvas = painter.canvas()
    between = [canvas.get_at((x, 103))[:3] for x in (104, 112, 128)]  # a notch of the string
    assert all(colour == pytest.approx(FIXED, abs=12) for colour in between)
    assert canvas.get_at((115, 200))[:3] == STAGE
    camera = camera_of_pixels()
    near = frame_of([(100, 100), (108, 100)], 4.0, movable=False)
    apart = frame_of([(100, 100), (150, 100)], 4.0, movable=False)
    for frame, count in [(near, 1), (apart, 0), (near, 1)]:
        notes = Notes()
        draw_wall_discs(notes, frame, camera)
        assert len(notes.lines_drawn()) == count


def trails(path: Trails, frame: Frame) -> tuple[Notes, str | None]:
    shades = np.full(len(frame), 12, np.uint8)
    return drawn(lambda notes, frame, camera: path.draw(notes, frame, shades, camera), frame)


def walk(path: Trails, steps: int, *, tags=(0, 1), begin: int = 0) -> Notes:
    """Two particles that go to the right; return what the last picture draws."""
    for step in range(begin, begin + steps):
        places = [(20 + 2 * step, 50 + 40 * k) for k in range(len(tags))]
        frame = frame_of(places, 2.0, time=step / 30, tags=tags)
        notes, _ = trails(path, frame)
    return notes


def test_trails_lead_to_the_particles_and_fade_with_age() -> None:
    notes = walk(Trails(), 40)
    ends, alpha = notes.lines_drawn(), notes.colours_drawn()[:, 3].astype(int)
    assert ends[:, 2].max() == pytest.approx(20 + 2 * 39)
    oldest = ends[:, 0].min()
    assert 20 + 2 * (39 - 30) - 4 <= oldest <= 20 + 2 * (39 - 30) + 6  # one second of the way
    assert alpha[np.argmax(ends[:, 2])] > 2 * alpha[np.argmin(ends[:, 0])]


def test_trails_rest_in_a_pause_and_can_be_cleared() -> None:
    path = Trails()
    walk(path, 30)
    frame = frame_of([(80, 50), (80, 90)], 2.0, time=1.0)
    counts = []
    for _ in range(50):
        notes, _ = trails(path, frame)
        counts.append(len(notes.lines_drawn()))
    assert counts[0] == counts[-1] > 0
    path.clear()
    notes, _ = trails(path, frame)
    assert all(x0 == x1 and y0 == y1 for x0, y0, x1, y1 in notes.lines_drawn())


def test_a_trail_follows_its_particle_when_rows_move_up() -> None:
    path = Trails()
    walk(path, 20)
    notes = walk(path, 20, tags=(1,), begin=20)  # now in the first row, at its height
    ends = notes.lines_drawn()
    assert np.abs(ends[:, 1] - ends[:, 3]).max() == pytest.approx(40, abs=1)  # it moved there
    assert len(np.unique(ends[:, 1])) == 2


def test_trails_show_as_many_as_are_cheap_and_begin_anew_after_going_back() -> None:
    places = np.random.default_rng(2).uniform(10, 230, (1_000, 2))
    _, said = trails(Trails(), frame_of(places))
    assert said == f"trails: {marks.MOST_TRAILS:,} of 1,000 shown"
    path = Trails()
    walk(path, 30)
    notes = walk(path, 1)
    assert all(x0 == x1 for x0, _, x1, _ in notes.lines_drawn())


def test_labels_stand_on_discs_that_are_large_enough_and_not_too_many() -> None:
    frame = frame_of([(60, 60), (150, 60), (240, 60)], [30.0, 8.0, 2.0])
    notes, said = drawn(marks.draw_labels, frame)
    places = notes.sheets_drawn()
    assert said is None and len(places) == 3  # tag and speed on the large one, the tag on the other
    assert all(x < 160 for x, _ in places)
    notes, said = drawn(marks.draw_labels, frame_of([(60, 60)], 1.0))
    assert said == "labels: zoom in to see them" and not notes.sheets_drawn()
    many = frame_of(np.random.default_rng(3).uniform(10, 230, (300, 2)), 8.0)
    notes, said = drawn(marks.draw_labels, many)
    assert said == "labels: 200 of 300 shown" and len(notes.sheets_drawn()) == marks.MOST_LABELS


def test_every_overlay_at_once_on_nothing_and_on_one_particle() -> None:
    shown = ViewOptions(contacts=True, velocities=True, trails=True, labels=True)
    for places in ([], [(100, 100)]):
        painter, picture = SoftwarePainter((800, 600)), Picture()
        for colour_by in ColourBy:
            shown.colour_by = colour_by
            picture.draw(painter, frame_of(places), camera_of_pixels(), shown)
        assert pixels(painter).any()


def test_a_part_of_the_canvas_is_drawn_and_the_rest_is_left() -> None:
    painter = SoftwarePainter(SIZE)
    Picture().draw(
        painter,
        frame_of([(80, 120), (240, 120)], 20.0),
        camera_of_pixels(),
        ViewOptions(),
        pygame.Rect(0, 0, 160, 240),
    )
    picture = pixels(painter)
    assert picture[80, 120].any() and not picture[160:].any()
