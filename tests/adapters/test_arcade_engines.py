"""The engines of `jostle.arcade` move a player as those of arcade do; the tests say where not."""

from typing import Any

import arcade
import numpy as np
import pytest

import jostle.arcade as ours


def boxes(*rows: tuple[float, float, float, float]) -> Any:
    """Return sprites of some width and height around some centres."""
    made = arcade.SpriteList(lazy=True)
    for x, y, width, height in rows:
        made.append(arcade.SpriteSolidColor(width, height, x, y))
    return made


def player(x: float = 0, y: float = 0) -> Any:
    return arcade.SpriteSolidColor(20, 30, x, y)


def shaped(points: list[tuple[float, float]], x: float = 0, y: float = 0) -> Any:
    """Return a sprite whose hit box is a polygon around its centre."""
    made = arcade.SpriteSolidColor(100, 100, x, y)
    made.hit_box = arcade.hitbox.RotatableHitBox(points, position=made.position)
    return made


def both(**lists: Any) -> list[tuple[Any, Any]]:
    """Return arcade's engine and ours, each with a player of its own."""
    classes = arcade.PhysicsEnginePlatformer, ours.PhysicsEnginePlatformer
    return [(one := player(), engine(one, **lists)) for engine in classes]


def difference(a: Any, b: Any) -> Any:
    return np.subtract(a.position, b.position)


@pytest.mark.parametrize("seed", range(20))
def test_the_simple_engine_stops_where_that_of_arcade_does(seed: int) -> None:
    """arcade stops up to a pixel before a wall."""
    rng = np.random.default_rng(seed)
    places = rng.integers(-6, 7, (30, 2)) * 40
    walls = boxes(*((x, y, 40, 40) for x, y in places.tolist() if (x, y) != (0, 0)))
    one, other = (arcade.SpriteSolidColor(20, 20, 0, 0) for _ in range(2))
    theirs = arcade.PhysicsEngineSimple(one, walls)
    engine = ours.PhysicsEngineSimple(other, walls)
    for _ in range(60):
        for sprite in (one, other):
            sprite.change_x, sprite.change_y = 0, 0
        step = rng.integers(-8, 9, 2).tolist()
        for sprite, physics in ((one, theirs), (other, engine)):
            sprite.change_x, sprite.change_y = step
            physics.update()
        assert not arcade.check_for_collision_with_list(other, walls)
        assert abs(difference(one, other)).max() <= 1
        other.position = one.position  # so that differences do not add up


@pytest.mark.parametrize("seed", range(30))
def test_walks_jumps_and_falls_as_in_arcade(seed: int) -> None:
    """Within a pixel, except that arcade lifts a player in the air over edges."""
    rng = np.random.default_rng(seed)
    frame_of_walls = [(0, -300, 800, 40), (-300, 0, 40, 640), (300, 0, 40, 640)]
    places = (rng.integers(-6, 7, (40, 2)) * 40).tolist()
    walls = boxes(*frame_of_walls, *((x, y, 40, 40) for x, y in places if abs(x) + abs(y) > 40))
    (one, theirs), (other, engine) = both(walls=walls)
    lifted = speed = 0
    for _ in range(200):
        speed = int(rng.integers(-5, 6)) if rng.random() < 0.1 else speed
        jumps = rng.random() < 0.1 and theirs.can_jump()
        in_air = not theirs.can_jump(1)
        for sprite, physics in ((one, theirs), (other, engine)):
            sprite.change_x = speed
            if jumps:
                physics.jump(11)
            physics.update()
        assert not arcade.check_for_collision_with_list(other, walls)
        x, y = difference(one, other)
        if abs(x) > 1 or abs(y) > 1:
            assert in_air and abs(x) <= abs(speed) + 1e-9
            lifted += 1  # sometimes into the wall
            one.position, one.change_y = other.position, other.change_y
        other.position, other.change_y = one.position, one.change_y
    assert lifted <= 4


def test_a_course_without_a_difference_of_a_pixel() -> None:
    """Falls, walks, jumps onto a block and off it; nothing corrects the player."""
    walls = boxes((0, 0, 2000, 40), (290, 60, 80, 80))
    (one, theirs), (other, engine) = both(walls=walls, gravity_constant=0.7)
    for frame in range(250):
        for sprite, physics in ((one, theirs), (other, engine)):
            if frame == 0:
                sprite.position = 0, 200
            sprite.change_x = 3
            if frame == 60:
                assert physics.can_jump()
                physics.jump(12)
            physics.update()
        x, y = difference(one, other)
        assert abs(x) <= 1e-6 and abs(y) <= 0.26
        assert one.change_y == pytest.approx(other.change_y)
        assert theirs.can_jump(1.5) == engine.can_jump(1.5)
    assert other.bottom == pytest.approx(20) and other.center_x == pytest.approx(750)


@pytest.mark.parametrize(("height", "speed"), [(30, 2), (30, 5), (60, 2), (60, 5), (100, 2)])
def test_climbs_ramps_as_fast_as_in_arcade(height: int, speed: int) -> None:
    walls = boxes((-300, -60, 600, 20), (250, -50 + height / 2, 300, height))
    walls.append(shaped([(-50, -50), (50, -50), (50, -50 + height)], 50, 0))
    (one, theirs), (other, engine) = both(walls=walls)
    one.position = other.position = (-40, -35)
    for _ in range(240 // speed):
        for sprite, physics in ((one, theirs), (other, engine)):
            sprite.change_x = speed
            physics.update()
        x, y = difference(one, other)
        assert abs(x) <= 1 and abs(y) <= speed + 1
    assert other.bottom == pytest.approx(-50 + height)
    bottoms = []
    for _ in range(280 // speed):  # down again: arcade's player hops, ours stays on the ramp
        other.change_x = -speed
        engine.update()
        bottoms.append(other.bottom)
    assert bottoms[-1] == pytest.approx(-50) and np.diff(bottoms).max() < 1e-9


def test_steeper_ramps_are_walls() -> None:
    walls = boxes((-300, -60, 600, 20))
    walls.append(shaped([(-50, -50), (50, -50), (50, 80)], 50, 0))
    (sprite, engine) = both(walls=walls)[1]
    sprite.position = (-40, -35)
    for _ in range(60):
        sprite.change_x = 2
        met = engine.update()
    assert sprite.position == pytest.approx((-10, -35)) and walls[1] in met


def test_steps_as_high_as_the_speed_are_climbed() -> None:
    walls = boxes((0, -25, 400, 20), (70, -13, 100, 4))
    (one, theirs), (other, engine) = both(walls=walls)
    for speed, top in ((3, -15), (4, -11)):
        for sprite, physics in ((one, theirs), (other, engine)):
            sprite.position, sprite.change_y = (0, 0), 0
            for _ in range(15):
                sprite.change_x = speed
                physics.update()
        assert other.bottom == pytest.approx(top)
        assert abs(difference(one, other)).max() <= 1


@pytest.mark.parametrize("change", [(2, 0), (0, 2), (0, -2), (1.5, 1), (-3, 1)])
def test_platforms_move_and_carry(change: tuple[float, float]) -> None:
    """A platform is where that of arcade is, to the last bit; a player on it stays on it."""
    places = []
    for kind in (arcade.PhysicsEnginePlatformer, ours.PhysicsEnginePlatformer):
        platforms = boxes((0, 0, 300, 10))
        lift = platforms[0]
        lift.change_x, lift.change_y = change
        lift.boundary_left, lift.boundary_right = -250, 260
        lift.boundary_bottom, lift.boundary_top = -101, 103
        sprite = player(0, 20)
        engine = kind(sprite, platforms)
        places.append([])
        for _ in range(300):
            engine.update()
            places[-1].append((lift.position, sprite.position))
    theirs, mine = np.array(places)
    assert np.array_equal(theirs[:, 0], mine[:, 0])
    assert np.ptp(mine[:, 0], axis=0).max() > 100
    relative = mine[:, 1] - mine[:, 0]
    assert np.abs(np.diff(relative[10:], axis=0)).max() < 1e-6
    assert np.allclose(relative[10:, 1], 20)


def test_a_walk_on_a_platform_is_added_to_its_motion() -> None:
    """In arcade the motion of the platform is lost while the player walks."""
    platforms = boxes((0, 0, 300, 10))
    platforms[0].change_x = 2
    sprite = player(0, 20)
    engine = ours.PhysicsEnginePlatformer(sprite, platforms)
    engine.update()
    sprite.change_x = -1
    before = sprite.center_x
    engine.update()
    assert sprite.center_x - before == pytest.approx(1)


def test_a_ramp_that_moves_carries_too() -> None:
    """Also one that comes later, and whose centre is not that of its hit box."""
    sprite, platforms = player(0, 0), boxes((0, -25, 200, 20))
    engine = ours.PhysicsEnginePlatformer(sprite, platforms)
    engine.update()
    platforms.append(shaped([(-10, -15), (90, -15), (90, 35)], 5, 0))
    sprite.position = (40, 40)
    for _ in range(30):
        engine.update()
    bottom = sprite.bottom
    assert -15 < bottom < 35 and sprite.center_x == pytest.approx(40)
    for platform in platforms:
        platform.change_x, platform.change_y = 3, 1
    for _ in range(20):
        engine.update()
    assert sprite.center_x == pytest.approx(100) and sprite.bottom == pytest.approx(bottom + 20)


def test_a_platform_that_comes_back_is_read_again() -> None:
    platforms = boxes((0, 0, 300, 10))
    sprite, lift = player(0, 20), platforms[0]
    engine = ours.PhysicsEnginePlatformer(sprite, platforms)
    engine.update()
    platforms.pop()
    assert not engine.can_jump()
    lift.hit_box = shaped([(-150, 5), (150, 5), (150, 7), (-150, 7)]).hit_box
    platforms.append(lift)
    sprite.position = (0, 30)
    for _ in range(20):
        engine.update()
    assert sprite.bottom == pytest.approx(7)


def test_the_velocity_on_a_lift_is_that_of_arcade() -> None:
    for change in (-2, 2):
        found = []
        for kind in (arcade.PhysicsEnginePlatformer, ours.PhysicsEnginePlatformer):
            platforms = boxes((0, 0, 300, 10))
            platforms[0].change_y = change
            sprite = player(0, 21)
            engine = kind(sprite, platforms)
            for _ in range(20):
                engine.update()
            found.append((sprite.change_y, sprite.center_y))
        assert found[0][0] == found[1][0] == min(0, change)
        assert found[0][1] == pytest.approx(found[1][1], abs=1)


def test_a_wall_pushes_nobody_through_another() -> None:
    platforms, walls = boxes((-60, 0, 40, 100)), boxes((60, 0, 40, 100))
    platforms[0].change_x = 3
    sprite = player()
    engine = ours.PhysicsEnginePlatformer(sprite, platforms, gravity_constant=0, walls=walls)
    for _ in range(20):
        engine.update()
        assert sprite.right <= 40 + 1e-9
    assert sprite.right == pytest.approx(40)


def test_nothing_falls_through_the_ground_at_any_speed() -> None:
    sprite = arcade.SpriteSolidColor(4, 4, 0, 1e6)
    engine = ours.PhysicsEnginePlatformer(sprite, walls=boxes((0, 0, 100, 1)))
    sprite.change_y = -3e6
    assert len(engine.update()) == 1
    assert (sprite.bottom, sprite.change_y) == (pytest.approx(0.5), 0)


def test_jumps_are_counted_as_in_arcade() -> None:
    walls = boxes((0, -20, 100, 10))
    for sprite, engine in both(walls=walls):
        engine.enable_multi_jump(2)
        engine.update()
        for jumps in (1, 2):
            assert engine.can_jump()
            engine.jump(8)
            assert (engine.jumps_since_ground, sprite.change_y) == (jumps, 8)
            for _ in range(3):
                engine.update()
        assert not engine.can_jump() and engine.can_jump(45) and engine.jumps_since_ground == 0
        engine.increment_jump_counter()
        engine.disable_multi_jump()
        assert not engine.can_jump() and engine.allowed_jumps == 1
        engine.increment_jump_counter()
        assert engine.jumps_since_ground == 0


@pytest.mark.parametrize("climb", [0, 4, -4])
def test_ladders_hold_as_in_arcade(climb: int) -> None:
    (one, theirs), (other, engine) = both(ladders=boxes((0, 50, 30, 200)))
    for sprite in (one, other):
        sprite.position = (0, 50)
    for frame in range(60):
        for sprite, physics in ((one, theirs), (other, engine)):
            if physics.is_on_ladder():
                sprite.change_y = climb if frame % 30 < 20 else 0
            physics.update()
        assert theirs.is_on_ladder() == engine.is_on_ladder()
        assert one.position == pytest.approx(other.position) and one.change_y == other.change_y


def test_turned_and_round_walls_keep_their_outlines() -> None:
    walls = boxes((60, 0, 60, 60))
    walls[0].angle = 45
    sprite = arcade.SpriteSolidColor(2, 2, 0, 25)
    engine = ours.PhysicsEngineSimple(sprite, walls)
    sprite.change_x = 30  # beside the corner, inside the bounding box
    assert engine.update() == [] and sprite.center_x == 30
    sprite.change_x = 100
    assert engine.update() == [walls[0]] and sprite.center_y > 25  # it slides along the side


def test_sprites_that_come_and_go_are_noticed() -> None:
    walls = boxes((0, -25, 40, 20), (30, 0, 20, 30))
    sprite = player()
    engine = ours.PhysicsEnginePlatformer(sprite, walls=walls)
    sprite.change_x = 50
    assert walls[1] in engine.update() and sprite.right == pytest.approx(20)
    walls.pop()
    assert engine.can_jump()
    walls.append(arcade.SpriteSolidColor(20, 400, 90, 0))
    engine.update()
    assert sprite.right > 50
    engine.update()
    assert sprite.right == pytest.approx(80)


def test_walls_that_have_moved_are_read_again() -> None:
    sprite, walls = arcade.SpriteSolidColor(10, 10, 0, 0), boxes((30, 0, 10, 10))
    engine = ours.PhysicsEngineSimple(sprite, walls)
    walls[0].center_y = 500
    engine.read_walls()
    sprite.change_x = 100
    assert engine.update() == [] and sprite.center_x == 100
    engine.walls = boxes((200, 0, 10, 10))
    assert len(engine.update()) == 1 and len(engine.walls) == 1
    engine.walls = None
    assert engine.update() == []


@pytest.mark.parametrize(
    ("hit_box", "y"), [([], -100), ([(0, 0)], -100), ([(-20, 0), (20, 0)], -15)]
)
def test_a_hit_box_without_corners_stops_nothing(hit_box: Any, y: float) -> None:
    walls = boxes()
    walls.append(shaped(hit_box, 0, -30))
    sprite = player()
    engine = ours.PhysicsEngineSimple(sprite, walls)
    sprite.change_y = -100
    assert len(engine.update()) == (y > -100) and sprite.center_y == pytest.approx(y)


def test_a_player_that_is_no_sprite_is_refused() -> None:
    with pytest.raises(TypeError, match=r"^player_sprite is a list, must be a Sprite$"):
        ours.PhysicsEngineSimple([])
