"""Scenes in TOML: what is right arrives, what is wrong is refused by its key."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.view_options import ColourBy, TreeView, ViewOptions
from jostle_lab.schema import Group, Polyline, Settings
from jostle_lab.simulate import start as start_module
from jostle_lab.simulate.frame import Attractor
from jostle_lab.simulate.region import Torus
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.start import start
from jostle_lab.storage.config import Config, ConfigError, config_text, read_config
from jostle_lab.storage.scene_file import read_scene, scene_bytes

REALS, SHARES = st.floats(-1e18, 1e18), st.floats(0, 1)
EXAMPLE = Path(__file__).parents[2] / "examples" / "scene.toml"


def read(folder: Path, text: str) -> Config:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return read_config(path)


def refusal(folder: Path, text: str) -> str:
    with pytest.raises(ConfigError) as caught:
        read(folder, text)
    return str(caught.value)


def saved_and_read(simulation: Any, folder: Path) -> Any:
    """The simulation of a scene file."""
    path = folder / "scene.jostle"
    path.write_bytes(scene_bytes(simulation, Camera((640, 480), simulation.view), ViewOptions()))
    return read_scene(path).simulation


def test_the_example_makes_the_scene_that_it_describes() -> None:
    config = read_config(EXAMPLE)
    assert (config.settings.scene, config.settings.n, config.size) == ("gas", 1500, (1280, 720))
    shown = ViewOptions(velocities=True)
    shown.update(config.view_options)
    assert (shown.tree, shown.colour_by) == (TreeView.OUTLINE, ColourBy.VELOCITY)
    assert not shown.velocities
    simulation = start(config.settings)
    frame = simulation.frame()
    assert len(frame) == 1500 + 12 + 4
    assert simulation.world.gravity.tolist() == [0, 120]
    assert (simulation.world.restitution == np.float32(0.98)).all()
    assert not frame.movable[-4:].any() and frame.movable[:-4].all()
    assert ((frame.radii[1500:1512] >= 12) & (frame.radii[1500:1512] <= 20)).all()
    assert (frame.velocities[1500:1512] == (60, 0)).all()
    np.testing.assert_array_equal(start(config.settings).frame().positions, frame.positions)


def test_every_setting_arrives(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        """
        scene = "pile"
        n = 10
        seed = 3
        method = "brute"
        leaf_capacity = 5
        max_depth = 4
        world_size = 2
        container = "circle"
        gravity = [0.0, -1]
        drag = 0.25
        restitution = 1
        substeps = 2
        threads = 1
        on_touch = "merge"
        time_scale = 0.5
        friction = 0.75
        sleeping = false
        """,
    )
    expected = Settings(
        "pile", 10, 3, "brute", 5, 4, 2, "circle", (0.0, -1.0), 0.25, 1, 2, 1, "merge", 0.5
    )
    assert config.settings == replace(expected, friction=0.75, sleeping=False)


def test_a_file_may_be_empty_and_ranges_of_particles_one_number(tmp_path: Path) -> None:
    config = read(tmp_path, "[[particles]]\nradius = 3\nspeed = [1, 2]\n[[particles]]\ncount = 2")
    assert config.settings.particles == (Group(radius=(3, 3), speed=(1.0, 2.0)), Group(count=2))
    assert read(tmp_path, "").settings == Settings()


WALL = "[[walls]]\npoints = [[0, 0], [1, 2]]\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "# a comment\n\ngravitas = [0, 1]",
            "scene.toml: gravitas is not a setting; did you mean gravity?",
        ),
        (
            'scene = "gas"\nrestitution = "high"',
            "scene.toml: restitution is 'high'; it must be a number",
        ),
        ("n = true", "scene.toml: n is true; it must be a whole number"),
        ("n = 1.5", "n is 1.5; it must be a whole number"),
        ("n = -1", "n is -1; it must be at least 0"),
        ("drag = nan", "drag is nan; it must be at most 1e+18"),
        (
            "gravity = [\n  0,\n  1,\n  2,\n]",
            "gravity is [0, 1, 2]; it may have at most 2 entries",
        ),
        (
            "n = 1\n\n[window]\nsize = [\n 0, 10]",
            "window.size[0] is 0; it must be at least 64",
        ),
        ("window = 3", "window is 3; it must be a table"),
        ("window.size = 3", "window.size is 3; it must be a list"),
        ("[shown]\ntrees = true", "shown.trees is not a setting; did you mean tree?"),
        ("[shown]\ntree = true", "shown.tree is true; it must be 'off', 'outline',"),
        ('[shown]\nlabels = "yes"', "shown.labels is 'yes'; it must be true or false"),
        ("walls = 3", "walls is 3; it must be a list"),
        ("[[walls]]\nclosed = true", "walls[0].points is missing"),
        (
            "[[walls]]\npoints = [[0, 0], [1]]",
            "walls[0].points[1][1] is missing",
        ),
        (
            WALL + "[[walls]]\npoints = [[0, 0], [1, 2], [1, 2]]",
            "walls[1].points[2] is [1, 2], like points[1]; a wall needs length",
        ),
        (
            "[[walls]]\npoints = [[0, 0], [1, 2], [3, 0], [0, 0]]\nclosed = true",
            "walls[0].points[0] is [0, 0], like points[3]; a wall needs length",
        ),
        (
            WALL + "closed = true",
            "walls[0].points has 2 entries; a closed polyline needs at least 3",
        ),
        (
            WALL + "restitution = 2",
            "walls[0].restitution is 2; it must be at most 1",
        ),
        (WALL + "friction = -1", "walls[0].friction is -1; it must be at least 0"),
        (WALL + "velocity = 3", "walls[0].velocity is 3; it must be a list"),
        (WALL + "cycle = 0", "walls[0].cycle is 0; it must be at least 0.001"),
        (
            "container_restitution = [1, 1, 2, 1]",
            "container_restitution[2] is 2; it must be at most 1",
        ),
        (
            "[[walls]]\nbounce = 1\npoints = [[0, 0], [1, 2]]",
            "walls[0].bounce is not a setting; there are points, closed,",
        ),
        ("particles = 3", "particles is 3; it must be a list"),
        (
            "[[particles]]\ncount = 1\n[[particles]]\n# two\ncolour = 2",
            "particles[1].colour is not a setting; did you mean count?",
        ),
        (
            "[[particles]]\n[[particles]]\ncount = 2\nmasks = [1, -1]",
            "particles[1].masks[1] is -1; it must be at least 0",
        ),
        (
            "[[particles]]\ncount = 3\ncategories = [1, 2]",
            "particles[0].categories has 2 entries; the group has 3 particles",
        ),
        (
            "[[particles]]\ncategories = 1.0",
            "particles[0].categories is 1.0; it must be a whole number",
        ),
        (
            "[[particles]]\nmasks = 4294967296",
            "particles[0].masks is 4294967296; it must be at most 4,294,967,295",
        ),
        (
            "[[particles]]\nradius = [3, 1]",
            "particles[0].radius is [3, 1]; it must be [smallest, largest]",
        ),
        ("[[particles]]\nregion = [0, 0, -1, 1]", "particles[0].region is [0, 0, -1, 1]; it must"),
        ("gravity = [nan, 0]", "gravity[0] is nan; it must be at most 1e+18"),
        (
            'scene = "life"\nmatrix = "chess"',
            "matrix is 'chess', which is not a matrix; did you mean",
        ),
        ("matrix = [[1, 2], [0, 0]]", "matrix[0][1] is 2; it must be at most 1"),
        ("matrix = [[1, 0]]", "matrix is [[1, 0]]"),
        ("matrix = []", "matrix is []"),
        (
            'method = "article-quadtree"',
            "method is 'article-quadtree'; it must be 'quadtree' or 'brute'",
        ),
        ('scene = "gases"', "gases is not a scene; did you mean gas?"),
        ('scene = "pile\nn = 2', "scene.toml: Illegal character '\\n' (at line 1,"),
        ("n = 1\nn = 2", "scene.toml: Cannot overwrite a value (at "),
        ("n =\nseed = 1", "scene.toml: Invalid value (at line 1,"),
        ("n = 1\ngravity = [1,\n", "scene.toml: "),
        ("\n['a (at b']\n['a (at b']", "scene.toml: Cannot declare ('a (at b',) twice (at line 3,"),
    ],
)
def test_what_is_wrong_is_refused_by_its_key(tmp_path, text: str, sentence: str) -> None:
    assert sentence in refusal(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("radius = [1, 20]", "particles[1].radius is 20; a disc must fit between the walls, from"),
        (
            "region = [40, 0, 50, 10]",
            "particles[1].region is [40, 0, 50, 10]; it must overlap the walls, from (0, 0) to",
        ),
        (
            "count = 100\nregion = [9, 9, 10, 10]\nradius = 1",
            "particles[1].count is 100; discs of radius 1 at least need more area than there is in "
            "its region",
        ),
        (
            "count = 2000\nradius = [1, 2]",
            "particles[1].count is 2000; discs of radius 1 at least need more area than there is",
        ),
    ],
)
def test_a_group_that_cannot_be_between_the_walls_is_refused(
    tmp_path: Path, text: str, sentence: str
) -> None:
    text = f'scene = "gas"\nn = 0\n[[particles]]\n[[particles]]\n{text}'
    with pytest.raises(ValueError) as caught:
        start(read(tmp_path, text).settings)
    assert sentence in str(caught.value)


@pytest.mark.parametrize("allowed", ["sensor = true", "categories = 0b10\nmasks = 0b01"])
def test_particles_that_do_not_push_each_other_may_share_a_region(tmp_path, allowed: str) -> None:
    text = "scene = 'gas'\nn = 0\n[[particles]]\ncount = 100\nregion = [9, 9, 10, 10]\nradius = 1\n"
    assert len(start(read(tmp_path, text + allowed).settings)) == 100


def test_more_particles_than_the_memory_can_have_are_refused(monkeypatch) -> None:
    monkeypatch.setattr(start_module, "_memory", lambda: 10**9)
    with pytest.raises(ValueError, match=r"^99,999,999 particles are too many: .* 35 GB"):
        start(Settings("gas", 99_999_999))
    assert len(start(Settings("gas", 5))) == 5


def test_walls_of_a_file_are_those_of_the_world(tmp_path: Path) -> None:
    text = """scene = "gas"
n = 50
[[walls]]
points = [[10, 10], [60, 10], [60, 40]]
restitution = 0.5
[[walls]]
points = [[5, 50], [20, 50], [20.5, 60]]
closed = true
friction = 0.25
"""
    simulation = start(read(tmp_path, text).settings)
    world = simulation.world
    assert world.walls.segments[:, 0].tolist() == [
        [10, 10],
        [60, 10],
        [5, 50],
        [20, 50],
        [20.5, 60],
    ]
    nan = np.nan  # the coefficient of the disc
    np.testing.assert_array_equal(world.walls.restitution, [0.5, 0.5, nan, nan, nan])
    assert np.nan_to_num(world.walls.friction, nan=-1).tolist() == [-1, -1, 0.25, 0.25, 0.25]
    frame = simulation.frame()
    assert frame.own_walls == len(frame.walls) == 5


def test_the_walls_of_a_file_are_saved_with_the_scene(tmp_path: Path) -> None:
    text = 'scene = "gas"\nn = 50\n[[walls]]\npoints = [[10, 10], [60, 10]]\nrestitution = 0.5'
    simulation = start(read(tmp_path, text).settings)
    simulation.add_wall(Polyline(((5, 5), (9, 9)), friction=0.5))
    again = saved_and_read(simulation, tmp_path)
    assert again.settings == simulation.settings and len(again.settings.walls) == 1
    frame = again.frame()
    assert (len(frame.walls), frame.own_walls) == (2, 1)
    np.testing.assert_array_equal(again.world.walls.restitution, [0.5, np.nan])
    for one in (simulation, again):
        one.step()
    np.testing.assert_array_equal(again.frame().positions, simulation.frame().positions)


def test_walls_of_a_file_may_have_temperatures(tmp_path: Path) -> None:
    text = """scene = "gas"
n = 20
[[walls]]
points = [[10, 10], [60, 10]]
[[walls]]
points = [[10, 20], [60, 20], [60, 40]]
temperature = 900
velocity = [30, 0]
cycle = 1
[[walls]]
points = [[5, 50], [20, 50]]
temperature = 4
"""
    simulation = start(read(tmp_path, text).settings)
    hot, cold = jostle.ThermalWalls(900, walls=[1, 2]), jostle.ThermalWalls(4, walls=[3])
    assert simulation.world.forces[1:] == (hot, cold)
    simulation.attract((Attractor(3.0, point=(1.0, 2.0)),))
    simulation.remove_walls([1, 3])
    motor, only, attractor = simulation.world.forces
    assert motor.walls.tolist() == [2] and only == jostle.ThermalWalls(900, walls=[2])
    assert isinstance(attractor, jostle.Attractor)
    simulation.attract(())
    assert simulation.world.forces == (motor, only)
    again = Simulation.resume(simulation.save())
    for one in (simulation, again):
        one.step()
    assert again.world.state_hash() == simulation.world.state_hash()


def test_walls_of_a_file_may_move_there_and_back(tmp_path: Path) -> None:
    text = """scene = "gas"
n = 20
[[walls]]
points = [[10, 10], [60, 10], [60, 40]]
velocity = [30, 0]
cycle = 1
[[walls]]
points = [[5, 50], [20, 50]]
"""
    simulation = start(read(tmp_path, text).settings)
    begin = simulation.frame().walls
    for _ in range(30):
        simulation.step()
    there = simulation.frame().walls
    np.testing.assert_allclose(there[:2], begin[:2] + np.array([15, 0]), atol=1e-4)
    np.testing.assert_array_equal(there[2], begin[2])
    simulation.attract(())  # the motor is not one of the user's attractors
    simulation.remove_walls([0])
    again = saved_and_read(simulation, tmp_path)
    for one in (simulation, again):
        for _ in range(30):
            one.step()
        np.testing.assert_allclose(one.frame().walls[0], begin[1], atol=1e-4)
    np.testing.assert_array_equal(again.frame().positions, simulation.frame().positions)


def test_sides_of_a_file_have_their_own_restitution_and_a_circle_has_one(tmp_path: Path) -> None:
    text = 'scene = "gas"\nn = 20\ncontainer_restitution = '
    simulation = start(read(tmp_path, text + "[0.5, 1, 0.25, 0]").settings)
    before = simulation.world.container
    assert before.restitution == (0.5, 1, 0.25, 0)
    why = "container_restitution is [0.5, 1, 0.25, 0]; a circle has one side"
    assert simulation.adjust("container", "circle") == why
    assert simulation.world.container == before and simulation.settings.container is None
    assert simulation.adjust("container", "torus") is None
    simulation.step()
    again = saved_and_read(simulation, tmp_path)
    assert again.settings == simulation.settings
    again.adjust("world_size", 2.0)
    assert again.adjust("container", "box") is None
    assert again.world.container.restitution == (0.5, 1, 0.25, 0)
    one = start(read(tmp_path, text + "0.5").settings)
    assert one.world.container.restitution == 0.5
    assert one.adjust("container", "circle") is None
    assert one.world.container.restitution == 0.5


def test_a_wall_of_a_file_has_its_restitution_or_that_of_the_disc(tmp_path: Path) -> None:
    """A contact has the square root of the product of both."""
    for own, expected in (("", 0.5), ("restitution = 0.125", 0.25), ("restitution = 0", 0.0)):
        text = f"""scene = "gas"
n = 0
container = "none"
restitution = 0.5
[[walls]]
points = [[0, 0], [0, 9]]
{own}
[[particles]]
region = [1, 4, 1, 4]
radius = 0.5
velocity = [-60, 0]
"""
        simulation = start(read(tmp_path, text).settings)
        simulation.step()
        speed = simulation.world.velocities[0, 0]
        assert speed == pytest.approx(60 * expected, abs=1e-4), own


def test_groups_of_a_file_do_not_overlap_its_walls(tmp_path: Path) -> None:
    text = """scene = "gas"
n = 0
[[walls]]
points = [[0, 0], [20, 20], [0, 20], [20, 0]]
[[particles]]
count = 60
radius = 0.5
"""
    simulation = start(read(tmp_path, text).settings)
    frame = simulation.frame()
    assert len(frame) == 60
    assert len(simulation.world.walls.query_circle(frame.positions, frame.radii).ids) == 0


def test_walls_on_a_torus_are_those_of_the_world_or_refused(tmp_path: Path) -> None:
    text = 'scene = "gas"\nn = 5\ncontainer = "torus"\n[[walls]]\npoints = [[-5, 0], [9, 9]]'
    simulation = start(read(tmp_path, text).settings)
    simulation.step()
    assert simulation.world.walls.segments.tolist() == [[[-5, 0], [9, 9]]]
    long = text.replace("-5", "-5e4")
    with pytest.raises(ValueError, match=r"^walls\[0\] cannot be added: segments\[0\] .* periodic"):
        start(read(tmp_path, long).settings)


def test_groups_do_not_overlap_images_of_walls_on_a_torus(tmp_path: Path) -> None:
    """A wall along one side acts along the opposite one, too."""
    walls = "[[walls]]\npoints = [[0, 0], [20, 0]]"
    group = "[[particles]]\nradius = 0.3\ncount = 60\nregion = [0, 17, 20, 20]"
    text = f'scene = "gas"\nn = 0\ncontainer = "torus"\n{walls}\n{group}'
    frame = start(read(tmp_path, text).settings).frame()
    assert frame.container == Torus(20, 20) and len(frame) == 60
    assert (frame.positions[:, 1] <= 20 - 0.3).all()


def test_a_group_that_the_library_refuses_is_named(tmp_path: Path) -> None:
    text = 'scene = "gas"\nn = 0\ncontainer = "none"\n[[particles]]\nradius = 1e18'
    with pytest.raises(ValueError, match=r"^particles\[0\] cannot be added: masses\[0\] is 1e36"):
        start(read(tmp_path, text).settings)


FILTERS = """scene = "gas"
n = 40
[[particles]]
count = 30
radius = 0.5
categories = 0b10
masks = 0xFFFFFFFD
[[particles]]
count = 3
radius = 0.5
categories = [4, 0, 0x80000000]
masks = [1, 0, 4294967295]
"""


def test_groups_of_a_file_have_collision_filters_which_are_saved_with_the_scene(
    tmp_path: Path,
) -> None:
    """Those of the second category do not touch each other, and others touch them."""
    simulation = start(read(tmp_path, FILTERS).settings)
    world = simulation.world
    assert world.categories.tolist() == [1] * 40 + [2] * 30 + [4, 0, 2**31]
    assert world.masks.tolist() == [2**32 - 1] * 40 + [2**32 - 3] * 30 + [1, 0, 2**32 - 1]
    seen = set()
    for _ in range(120):
        simulation.step()
        pairs = world.last_step.contacts.pairs
        assert 71 not in pairs
        seen |= {(a >= 40, b >= 40) for a, b in pairs.tolist() if max(a, b) < 70}
    assert seen == {(False, False), (False, True)}
    simulation.change([0, 999], categories=[8, 1], masks=[16, 1])
    again = saved_and_read(simulation, tmp_path)
    assert again.settings == simulation.settings
    assert again.frame().categories[:2].tolist() == [8, 1]
    assert again.frame().masks[:2].tolist() == [16, 2**32 - 1]
    for one in (simulation, again):
        one.step()
    assert again.world.state_hash() == simulation.world.state_hash()


def test_a_group_may_fill_the_walls_and_overlap_them(tmp_path: Path) -> None:
    text = "[[particles]]\nradius = 10\nregion = [15, 15, 99, 99]"
    simulation = start(read(tmp_path, f'scene = "gas"\nn = 0\n{text}').settings)
    assert len(simulation.frame()) == 1


def test_a_file_is_text_in_utf_8_with_or_without_the_mark_that_some_editors_put_first(
    tmp_path: Path,
) -> None:
    (tmp_path / "film.mp4").write_bytes(b"\x00\xff\xfe")
    with pytest.raises(ConfigError, match=r"film\.mp4: it is not a text in UTF-8"):
        read_config(tmp_path / "film.mp4")
    with pytest.raises(FileNotFoundError):
        read_config(tmp_path / "missing.toml")
    path = tmp_path / "scene.toml"
    path.write_bytes(b'\xef\xbb\xbfscene = "gas"\nn = 5\n')
    assert read_config(path).settings.n == 5


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("seed = 1\nn = 1" + "0" * 400, "n is 1000000000000"),
        ("n = 0x1" + "0" * 900, "n is 51048665"),
        ("n = 1" + "0" * 5_000, "digits"),
        ("gravity = [1, 1" + "0" * 400 + "]", "gravity[1] is 10000"),
        ("# [[[\nn = " + "[" * 3_000, "too many brackets are open"),
        ("n = " + "{a=" * 3_000, "too many brackets are open"),
        ('"' + "x" * 10_000 + '" = 1', "is not a setting; there are scene, n,"),
        ('"line\\nbreak" = 1', r"'line\nbreak' is not a setting"),
        ("[[particles]]\n" * 1_001, "it may have at most 1,000 entries"),
        ("drag = 1e400", "drag is inf; it must be at most"),
        ('a = """\n\\', "scene.toml: "),
    ],
    ids=map(str, range(12)),
)
def test_a_file_beyond_the_limits_is_refused_in_one_sentence(
    tmp_path: Path, text: str, sentence: str
) -> None:
    said = refusal(tmp_path, text)
    assert sentence in said
    assert said.startswith("scene.toml") and len(said) < 400 and "\n" not in said


def test_a_group_of_sensors_reports_and_does_not_push(tmp_path) -> None:
    text = 'scene = "gas"\nn = 300\n[[particles]]\nsensor = true\nmovable = false\nradius = 60\n'
    simulation = start(read(tmp_path, text).settings)
    assert simulation.world.sensors.sum() == 1
    simulation.step()
    frame = simulation.frame()
    assert frame.sensors is not None
    assert frame.sensors.tolist() == [0] * 300 + [2]  # gas flows through it


SETTINGS = st.builds(
    Settings,
    scene=st.sampled_from(jostle.scenes.names()),
    n=st.none() | st.integers(0, 10**8),
    seed=st.integers(0, 2**63 - 1),
    container=st.none() | st.sampled_from(["box", "circle", "torus", "none"]),
    gravity=st.none() | st.tuples(REALS, REALS),
    drag=st.none() | st.floats(0, 1e18),
    sleeping=st.none() | st.booleans(),
    container_restitution=st.none() | SHARES | st.tuples(SHARES, SHARES, SHARES, SHARES),
    matrix=st.none()
    | st.sampled_from([*jostle.life.MATRICES])
    | st.just(((0.5, -1.0), (1.0, 0.0))),
    particles=st.lists(
        st.builds(
            Group,
            count=st.just(2),
            velocity=st.tuples(REALS, REALS),
            categories=st.integers(0, 2**32 - 1) | st.tuples(*[st.integers(0, 2**32 - 1)] * 2),
        ),
        max_size=2,
    ).map(tuple),
    walls=st.lists(
        st.builds(Polyline, points=st.just(((0.0, 1.0), (2.5, 3.0))), friction=st.none() | SHARES),
        max_size=2,
    ).map(tuple),
)
OPTIONS = st.builds(
    ViewOptions,
    tree=st.sampled_from(TreeView),
    colour_by=st.sampled_from(ColourBy),
    trails=st.booleans(),
    panels=st.booleans(),
)


@given(settings=SETTINGS, options=OPTIONS)
def test_what_is_written_is_read_again(tmp_path_factory, settings, options) -> None:
    text = config_text(settings, options)
    config = read(tmp_path_factory.mktemp("written"), text)
    assert config.settings == settings
    shown = ViewOptions()
    shown.update(config.view_options)
    assert shown == options
