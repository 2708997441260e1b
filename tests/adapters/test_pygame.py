"""`jostle.pygame` compared with pygame's own functions: the same answers, in the same order.

Every scene is made twice from one seed, because kills and stored radii change it. The functions of
pygame are called on the first, those of jostle on the second. The states after the calls are
compared too.
"""

import math
import random
from collections.abc import Callable, Iterable, Iterator
from itertools import combinations, product
from typing import Any

import numpy as np
import pygame
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from pygame import FRect, Rect
from pygame.sprite import collide_circle, collide_circle_ratio, collide_rect, collide_rect_ratio
from signals import reaction_to_ctrl_c, run_child

import jostle.pygame as ours
from jostle._core import Quadtree, sprite_pairs
from jostle.pygame import collisions, groups, kills
from jostle.sprites import Near, Radii

theirs = pygame.sprite

RECTS = ["ints", "floats", "mixed"]


class Named(theirs.Sprite):
    """A sprite with a name for the messages of failing tests."""

    def __init__(self, name: str, rect: Any) -> None:
        super().__init__()
        self.name = name
        self.rect = rect

    def __repr__(self) -> str:
        return f"{self.name}: {self.rect!r}"


class Scene:
    """Two groups that may share sprites, made from a seed."""

    def __init__(self, seed: int, kind: str, *, largest: int = 12, radii: bool = False) -> None:
        draw = random.Random(seed)
        self.spread = draw.choice([4, 12, 60])
        self.every = [
            Named(f"s{row}", some_rect(draw, kind, self.spread))
            for row in range(draw.randint(0, 2 * largest))
        ]
        for sprite in self.every:
            if radii and draw.random() < 0.7:
                sprite.radius = draw.choice([0, 1, 5, 2.5, 7.0, -3, draw.uniform(0, 9), True])
        self.a = theirs.Group(s for s in self.every if draw.random() < 0.6)
        self.b = theirs.Group(s for s in self.every if draw.random() < 0.6)

    def state(self) -> Any:
        """Return everything that a call may have changed."""
        radii = [(type(r), r) for r in (getattr(s, "radius", None) for s in self.every)]
        return names(self.a), names(self.b), radii, [repr(s.rect) for s in self.every]


def some_rect(draw: random.Random, kind: str, spread: int) -> Any:
    """Return a rect that often touches others, has no area or negative sizes."""
    if kind == "mixed":
        kind = draw.choice(RECTS[:2])
    if kind == "ints":
        side = draw.choice([0, 1, 2, 3, 5, 8, -1, -4])
        other = draw.choice([side, 0, 1, 4, 7, -2])
        return Rect(draw.randint(-spread, spread), draw.randint(-spread, spread), side, other)
    if draw.random() < 0.5:  # quarters touch exactly
        place = [draw.randint(-4 * spread, 4 * spread) / 4 for _ in range(2)]
        return FRect(*place, draw.choice([0, 0.25, 1, 2.5, -1.5]), draw.choice([0.5, 3, -2, 0]))
    place = [draw.uniform(-spread, spread) for _ in range(2)]
    return FRect(*place, draw.choice([0.1, 0.3, draw.uniform(-4, 4)]), draw.uniform(-4, 4))


def names(sprites: Iterable[Any]) -> list[str]:
    return [sprite.name for sprite in sprites]


def named(answer: dict[Any, list[Any]]) -> list[tuple[str, list[str]]]:
    """Return an answer of `groupcollide` in its order."""
    return [(sprite.name, names(hits)) for sprite, hits in answer.items()]


def odd(left: Any, right: Any) -> bool:
    """A user's function."""
    return bool((left.rect.x + right.rect.y) % 2 >= 1)


Collided = Callable[[Any, Any], Any] | None
BUILT_IN: dict[str, Collided] = {
    "none": None,
    "rect": collide_rect,
    "rect ratio": collide_rect_ratio(1.5),
    "rect ratio down": collide_rect_ratio(0.3),
    "rect ratio 2": collide_rect_ratio(2),
    "rect ratio 0": collide_rect_ratio(0),
    "rect ratio -1": collide_rect_ratio(-1.0),
    "circle": collide_circle,
    "circle ratio": collide_circle_ratio(0.8),
    "circle ratio 2": collide_circle_ratio(2),
    "circle ratio -1": collide_circle_ratio(-1),
    "prefilter": ours.prefilter(odd, reach=2.5),
}


def same_groupcollide(
    make: Callable[[], Scene], kill_a: bool, kill_b: bool, collided: Collided
) -> None:
    expected, found = make(), make()
    want = theirs.groupcollide(expected.a, expected.b, kill_a, kill_b, collided)
    got = ours.groupcollide(found.a, found.b, kill_a, kill_b, collided)
    assert named(got) == named(want)
    assert found.state() == expected.state()


def same_others(make: Callable[[], Scene], kill: bool, collided: Collided) -> None:
    """Compare `spritecollide`, `spritecollideany` and `selfcollide`."""
    expected, found = make(), make()
    for mine, own in zip(expected.every[:3], found.every[:3], strict=True):
        want_any = theirs.spritecollideany(mine, expected.b, collided)
        got_any = ours.spritecollideany(own, found.b, collided)
        assert getattr(got_any, "name", None) == getattr(want_any, "name", None)
        assert found.state() == expected.state()
        want = theirs.spritecollide(mine, expected.b, kill, collided)
        assert names(ours.spritecollide(own, found.b, kill, collided)) == names(want)
        assert found.state() == expected.state()
    meet = collided or collide_rect
    want_pairs = [names(pair) for pair in combinations(expected.a, 2) if meet(*pair)]
    assert [names(pair) for pair in ours.selfcollide(found.a, collided)] == want_pairs
    assert found.state() == expected.state()


@pytest.mark.parametrize("kind", RECTS)
@pytest.mark.parametrize("rule", BUILT_IN)
def test_random_scenes(rule: str, kind: str) -> None:
    """For each of 36 cases."""
    for seed in range(100):
        kill_a, kill_b = bool(seed & 1), bool(seed & 2)

        def make(seed: int = seed) -> Scene:
            return Scene(seed, kind, radii=bool(seed & 4))

        same_groupcollide(make, kill_a, kill_b, BUILT_IN[rule])
        if seed % 5 == 0:
            same_others(make, kill_a, BUILT_IN[rule])


@pytest.mark.parametrize("kind", RECTS)
@pytest.mark.parametrize("rule", [rule for rule in BUILT_IN if rule != "prefilter"])
@pytest.mark.parametrize("kill", [False, True])
def test_groups_of_hundreds(rule: str, kind: str, kill: bool) -> None:
    """Enough sprites for trees; small groups are compared by brute force."""
    same_groupcollide(lambda: Scene(3, kind, largest=150), kill, kill, BUILT_IN[rule])
    same_others(lambda: Scene(4, kind, largest=100), kill, BUILT_IN[rule])


@pytest.mark.parametrize("kind", RECTS)
@pytest.mark.parametrize("rule", [rule for rule in BUILT_IN if rule != "rect"])
def test_pygame_has_nothing_to_do(rule: str, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The answers must not come from pygame's own functions."""
    for scene in (Scene(3, kind, largest=150), Scene(5, kind)):
        collided = BUILT_IN[rule]
        want = named(theirs.groupcollide(scene.a, scene.b, False, False, collided))
        with monkeypatch.context() as patch:
            for module in (collisions, kills):
                patch.setattr(module, "their_groupcollide", None)
                patch.setattr(module, "their_spritecollide", against_no_sprite)
            assert named(ours.groupcollide(scene.a, scene.b, False, False, collided)) == want
            ours.groupcollide(scene.a, scene.b, False, True, collided)


def against_no_sprite(sprite: Any, group: Any, *more: Any) -> list[Any]:
    """Replace pygame's function for an empty group."""
    assert len(group) == 0
    return []


small = st.integers(-6, 6)
ints = st.builds(Rect, small, small, small, small)
quarters = st.integers(-24, 24).map(lambda k: k / 4)
halves = st.builds(FRect, quarters, quarters, quarters, quarters)
floats = st.floats(-1e6, 1e6, width=32)
anything = st.builds(FRect, floats, floats, floats, floats)
extreme = st.sampled_from([2**31 - 1, -(2**31), 2**30, -(2**30), 2**24 + 1, 0, 1, -1])
far = st.builds(Rect, extreme, extreme, extreme, extreme)
wild = st.sampled_from([1e38, -1e38, 3e38, 1e-40, float("inf"), float("nan"), 0.0, -0.0, 1.0])
beyond = st.builds(FRect, wild, wild, wild, wild)
some_rects = st.lists(ints | halves | anything | far | beyond, max_size=8)
ratios = st.sampled_from([0, 1, 2, 1.5, 0.1, -1, -0.5, 1e5, 1e30, float("nan"), float("inf")])
rules = st.one_of(
    st.sampled_from([None, collide_rect, collide_circle]),
    ratios.map(collide_rect_ratio),
    ratios.map(collide_circle_ratio),
    st.sampled_from([0.0, 1.0, 3.25, 1e5, 1e30]).map(lambda reach: ours.prefilter(odd, reach)),
)
radii = st.none() | st.integers(-3, 9) | st.floats(-3, 9) | st.sampled_from([10**17, 1e200, -1e200])


@given(some_rects, some_rects, st.lists(radii, max_size=16), rules, st.booleans(), st.booleans())
@example([FRect(0, 0, 0.1, 1)], [FRect(0.1, 0, 1, 1)], [], None, False, False)
@example([Rect(0, 0, 3, 4)], [Rect(3, 4, 3, 4)], [], collide_circle, False, False)
@example([Rect(2**31 - 2, 0, 10, 10)], [Rect(0, 0, 5, 5)], [], None, False, False)
def test_any_rects_at_all(
    left: list[Any],
    right: list[Any],
    sizes: list[Any],
    collided: Collided,
    kill_a: bool,
    kill_b: bool,
) -> None:
    """Return the result of pygame, or the type of its exception."""

    def run(library: Any) -> Any:
        every = [Named(f"s{row}", rect) for row, rect in enumerate([*left, *right])]
        for sprite, radius in zip(every, sizes, strict=False):
            if radius is not None:
                sprite.radius = radius
        a, b = theirs.Group(every[: len(left)]), theirs.Group(every[len(left) :])
        try:
            found: Any = named(library.groupcollide(a, b, kill_a, kill_b, collided))
        except Exception as error:
            found = type(error)
        return found, names(a), names(b)

    assert run(ours) == run(theirs)


@given(st.lists(ints | halves | anything, max_size=9), st.lists(ints | halves, max_size=9))
def test_many_rects_at_once(rects: list[Any], others: list[Any]) -> None:
    want = [rect.collidelistall(others) for rect in rects]
    assert ours.collide_rect_lists(rects, others) == want
    sprites = [Named(f"s{row}", rect) for row, rect in enumerate(others)]
    assert ours.collide_rect_lists(rects, sprites) == want
    for found, rect in zip(ours.collide_rect_objects(rects, sprites), rects, strict=True):
        assert found == rect.collideobjectsall(sprites)
    keys = {sprite.name: sprite.rect for sprite in sprites}
    found = ours.collide_rect_objects(rects, keys, key=keys.get)
    assert found == [rect.collideobjectsall(list(keys), key=keys.get) for rect in rects]


def test_a_sequence_with_a_rect_is_read_as_pygame_does() -> None:
    class Strange(list):
        rect = Rect(0, 0, 9, 9)

    things = [Strange([50, 50, 9, 9]), Named("s", Rect(50, 0, 9, 9))]
    queries = [Rect(0, 0, 5, 5), Rect(52, 52, 5, 5), FRect(50.5, 0, 1, 1)]
    assert ours.collide_rect_lists(queries, things) == [
        rect.collidelistall(things) for rect in queries
    ]
    assert ours.collide_rect_lists(queries, things) == [[], [0], [1]]


def with_masks(seed: int, kind: str) -> Scene:
    """Return a scene whose masks may be larger or smaller than their rects."""
    scene, draw = Scene(seed, kind, largest=8), random.Random(seed)
    for sprite in scene.every:
        size = draw.randint(0, 12), draw.randint(0, 12)
        if draw.random() < 0.5:
            sprite.mask = pygame.Mask(size, fill=draw.random() < 0.5)
            for _ in range(8):
                if all(size):
                    sprite.mask.set_at((draw.randrange(size[0]), draw.randrange(size[1])))
        else:
            sprite.image = pygame.Surface(size, pygame.SRCALPHA)
            sprite.image.fill((0, 0, 0, 255), (0, 0, 5, 5))
    return scene


@pytest.mark.parametrize("kind", RECTS)
def test_masks(kind: str) -> None:
    for seed in range(150):
        kills = bool(seed & 1), bool(seed & 2)
        same_groupcollide(lambda seed=seed: with_masks(seed, kind), *kills, theirs.collide_mask)
        same_others(lambda seed=seed: with_masks(seed, kind), kills[0], theirs.collide_mask)


def test_masks_are_asked_only_where_they_may_meet() -> None:
    called = []

    class Mask(pygame.Mask):
        def overlap(self, *arguments: Any) -> Any:
            called.append(arguments)
            return super().overlap(*arguments)

    sprites = [Named(f"s{x}", Rect(x, 0, 1, 1)) for x in range(0, 1000, 10)]
    for sprite in sprites:
        sprite.mask = Mask((8, 8), fill=True)
    assert ours.selfcollide(sprites, theirs.collide_mask) == []
    assert called == []


@pytest.mark.parametrize("collided", [odd, lambda left, right: False, collide_circle])
def test_a_users_function_is_called_for_every_pair(collided: Any) -> None:
    """With pygame's arguments, in pygame's order, as often as pygame does."""
    calls: list[tuple[str, str]] = []

    def told(left: Any, right: Any) -> Any:
        calls.append((left.name, right.name))
        return collided(left, right)

    def run(library: Any, seed: int) -> Any:
        calls.clear()
        scene = Scene(seed, "mixed")
        library.groupcollide(scene.a, scene.b, bool(seed & 1), bool(seed & 2), told)
        for mine in scene.every[:2]:
            library.spritecollideany(mine, scene.b, told)
            library.spritecollide(mine, scene.b, False, told)
        return calls.copy(), scene.state()

    for seed in range(60):
        assert run(ours, seed) == run(theirs, seed)
    calls.clear()
    group = Scene(1, "mixed").a
    ours.selfcollide(group, told)
    assert calls == [(a.name, b.name) for a, b in combinations(group, 2)] != []


def calls_of(library: Any, left: list[Any], right: list[Any], collided: Any) -> list[Any]:
    """Return calls of each function of the library, also of that which pygame does not have."""
    both = [*left, *right]
    own = [lambda: ours.selfcollide(both, collided)] if library is ours else []
    return [
        lambda: library.groupcollide(left, right, False, False, collided),
        lambda: library.groupcollide(left, right, True, True, collided),
        lambda: library.spritecollide(left[0], right, False, collided),
        lambda: library.spritecollideany(left[0], right, collided),
        *own,
    ]


def test_an_exception_of_a_users_function_is_passed_on() -> None:
    class Refused(Exception):
        pass

    def refuse(left: Any, right: Any) -> Any:
        raise Refused

    sprites = [Named(f"s{x}", Rect(x, 0, 5, 5)) for x in (0, 900)]
    for collided in (refuse, ours.prefilter(refuse, reach=1000)):
        for call in calls_of(ours, sprites[:1], sprites[1:], collided):
            with pytest.raises(Refused):
                call()
    assert ours.selfcollide(sprites, ours.prefilter(refuse, reach=894)) == []


def within_100(left: Any, right: Any) -> bool:
    return abs(left.rect.x - right.rect.x) < 100


@pytest.mark.parametrize("collided", [within_100, ours.prefilter(within_100, reach=95)])
@pytest.mark.parametrize("broad_phase", [False, True])
def test_a_function_may_accept_pairs_beyond_the_rects(collided: Any, broad_phase: bool) -> None:
    a = theirs.Group(Named(f"a{x}", Rect(x, 0, 5, 5)) for x in (0, 300))
    b = theirs.Group(Named(f"b{x}", Rect(x, 0, 5, 5)) for x in (50, 60, 390))
    ship = Named("ship", Rect(0, 0, 5, 5))
    named_only: Any = {"broad_phase": broad_phase}
    found = ours.groupcollide(a, b, False, False, collided, **named_only)
    assert named(found) == [("a0", ["b50", "b60"]), ("a300", ["b390"])]
    assert names(ours.spritecollide(ship, b, False, collided, **named_only)) == ["b50", "b60"]
    assert ours.spritecollideany(ship, b, collided, **named_only).name == "b50"
    assert len(ours.selfcollide(b, collided, **named_only)) == 1


@pytest.mark.parametrize("kind", [Rect, FRect])
@pytest.mark.parametrize(
    ("place", "reach", "called"),
    [
        ((10, 0, 5, 5), 0, True),  # they touch
        ((11, 0, 5, 5), 0, False),
        ((11, 0, 5, 5), 1, True),
        ((11, 12, 5, 5), 1, False),
        ((11, 12, 5, 5), 2, True),
        ((-7, 3, 5, 5), 2, True),
        ((-7, 3, 5, 5), 1.999, False),
        ((19, 0, -5, 5), 4, True),  # negative size: from 14 to 19
        ((19, 0, -5, 5), 3.999, False),
        ((12, 5, 0, 0), 2, True),  # without area
        ((12, 5, 0, 0), 1.5, False),
        ((2, 2, 1, 1), 0, True),
    ],
)
def test_what_reach_means(kind: Any, place: Any, reach: float, called: bool) -> None:
    """A gap of exactly `reach` is included, on each axis, on both sides."""
    seen: list[Any] = []
    collided = ours.prefilter(lambda *pair: seen.append(pair) or True, reach=reach)
    left, right = Named("a", kind(0, 0, 10, 10)), Named("b", kind(place))
    for pair in ((left, right), (right, left)):
        seen.clear()
        assert bool(ours.groupcollide(pair[:1], pair[1:], False, False, collided)) == called
        assert seen == [pair] * called
        assert bool(theirs.spritecollide(pair[0], pair[1:], False, collided)) == called


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((3,), "collided must be callable, not int"),
        ((odd, -1), r"reach is -1; it must be finite and at least 0"),
        ((odd, math.nan), r"reach is nan; it must be finite and at least 0"),
        ((odd, math.inf), r"reach is inf; it must be finite and at least 0"),
        ((odd, "far"), "reach must be a number, not str"),
        ((odd, True), "reach must be a number, not bool"),
    ],
)
def test_what_a_prefilter_refuses(arguments: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        ours.prefilter(*arguments)


def test_a_prefilter_says_what_it_is() -> None:
    made = ours.prefilter(odd, reach=3)
    assert (made.collided, made.reach) == (odd, 3.0)
    assert repr(made).endswith("reach=3.0)")


def test_sprites_without_rects_are_for_a_function_that_needs_none() -> None:
    def shorter(left: Any, right: Any) -> bool:
        return len(left.name) < len(right.name)

    def groups() -> tuple[Any, Any]:
        a, b = theirs.Group(), theirs.Group()
        for name, group in (("x", a), ("xyz", a), ("xy", b), ("xyzz", b)):
            sprite = theirs.Sprite(group)
            sprite.name = name
        return a, b

    for kill_b in (False, True):
        want = theirs.groupcollide(*groups(), False, kill_b, shorter)
        assert named(ours.groupcollide(*groups(), False, kill_b, shorter)) == named(want)
    a, b = groups()
    first = next(iter(a))
    assert names(ours.spritecollide(first, b, False, shorter)) == ["xy", "xyzz"]
    assert ours.spritecollideany(first, b, shorter).name == "xy"
    assert len(ours.selfcollide(b, shorter)) == 1


def one_place(count: int, *groups: Any, kind: type = Named) -> list[Any]:
    """Return sprites that all overlap."""
    sprites = [kind(f"s{row}", Rect(0, 0, 5, 5)) for row in range(count)]
    for sprite in sprites:
        sprite.add(*groups)
    return sprites


@pytest.mark.parametrize(
    "collided", [None, collide_circle, theirs.collide_mask, odd, ours.prefilter(odd, reach=3)]
)
@pytest.mark.parametrize("kill_b", [False, True])
def test_a_kill_of_ones_own_may_do_anything(collided: Collided, kill_b: bool) -> None:
    """This `kill` moves other sprites, adds some of them to the group, and may do nothing."""

    class Bomb(Named):
        group: Any
        reserve: Any

        def kill(self) -> None:
            for sprite in self.group:
                sprite.rect.x += 1
            if self.reserve:
                self.group.add(self.reserve.pop())
            if self.name != "s2":
                super().kill()

    def run(library: Any) -> Any:
        Bomb.group = b = theirs.Group()
        a = theirs.Group()
        Bomb.reserve = [Bomb(f"r{row}", Rect(row, 0, 5, 6)) for row in range(4)]
        made = [*one_place(6, a), *one_place(5, b, kind=Bomb), *Bomb.reserve]
        for row, sprite in enumerate(made):
            sprite.rect.y = row % 3
            sprite.mask = pygame.Mask((4, 4), fill=True)
        found = named(library.groupcollide(a, b, True, kill_b, collided))
        return found, names(a), names(b), [repr(sprite) for sprite in made]

    assert run(ours) == run(theirs)


def test_groups_of_ones_own_may_do_anything() -> None:
    class Restless(theirs.Group):
        """Moves all sprites when one is removed."""

        def remove_internal(self, sprite: Any) -> None:
            super().remove_internal(sprite)
            for other in self:
                other.rect.x -= 2

    class Half(theirs.Group):
        """Iterates over every second sprite."""

        def sprites(self) -> list[Any]:
            return super().sprites()[::2]

    def run(library: Any, group: type) -> Any:
        a, b = theirs.Group(), group()
        one_place(4, a)
        for row, sprite in enumerate(one_place(9, b)):
            sprite.rect.x = 4 * row
        return named(library.groupcollide(a, b, False, True)), names(b)

    for group in (Restless, Half):
        assert run(ours, group) == run(theirs, group)


@pytest.mark.parametrize(
    "kind", [theirs.Group, theirs.LayeredUpdates, theirs.GroupSingle, ours.Group, list, set]
)
def test_kinds_of_groups(kind: Any) -> None:
    """Collections can be iterated twice; for other iterables pygame's function is called."""
    for library, kill in product((theirs, ours), (False, True)):
        hunters, hunted = one_place(3), one_place(3)
        grouped = issubclass(kind, theirs.AbstractGroup)
        b = kind() if grouped else kind(hunted)
        if grouped:
            b.add(*hunted)
        want = list(b)
        found = library.groupcollide(hunters, b, False, kill)
        assert found[hunters[0]] == want
        assert len(found) == (1 if kill and grouped else 3)
        assert library.spritecollide(hunters[0], iter(want), kill) == want
        assert library.groupcollide(iter(hunters), iter(want), False, kill) == {hunters[0]: want}


def test_duplicates_in_lists() -> None:
    x, y = one_place(2)
    assert ours.groupcollide([x, x], [y, x, y], False, False) == {x: [y, x, y]}
    assert ours.selfcollide([x, y, x]) == [(x, y), (x, x), (y, x)]


class Plain(Rect):
    """A subclass that changes nothing."""

    note = "mine"


class Never(Rect):
    """A subclass with its own `colliderect`."""

    def colliderect(self, *arguments: Any) -> bool:
        return False


class Wide(FRect):
    """A subclass whose attributes differ from its sizes."""

    width = property(lambda self: 50.0)


class Elsewhere(Rect):
    """A subclass whose attributes differ from its position."""

    def __getitem__(self, index: Any) -> Any:
        return 1000


@pytest.mark.parametrize("kind", [Plain, Never, Wide, Elsewhere, tuple, list])
@pytest.mark.parametrize("rule", BUILT_IN)
def test_subclasses_and_what_is_like_a_rect(kind: Any, rule: str) -> None:
    def run(library: Any, swap: bool) -> Any:
        numbers = [(x, x % 7, 6, 5) for x in range(0, 60, 3)]
        make = kind if issubclass(kind, (tuple, list)) else lambda four: kind(*four)
        sprites = [Named(f"s{row}", make(four)) for row, four in enumerate(numbers)]
        others = [Named(f"o{row}", Rect(four)) for row, four in enumerate(numbers[::2])]
        a, b = (others, sprites) if swap else (sprites, others)
        try:
            return named(library.groupcollide(a, b, False, False, BUILT_IN[rule]))
        except (TypeError, AttributeError) as error:
            return type(error)

    assert run(ours, True) == run(theirs, True)
    assert run(ours, False) == run(theirs, False)


def test_a_subclass_that_changes_nothing_is_searched_quickly() -> None:
    sprites = [Named("s", Plain(0, 0, 1, 1))]
    assert sprite_pairs(sprites, sprites, "rect", 1.0, (Rect, FRect)) is not None
    sprites[0].rect.colliderect = lambda other: False
    assert sprite_pairs(sprites, sprites, "rect", 1.0, (Rect, FRect)) is None
    assert ours.groupcollide(sprites, sprites, False, False) == {}


def test_a_rect_may_be_a_property() -> None:
    class Body(theirs.Sprite):
        def __init__(self, x: float) -> None:
            super().__init__()
            self.x = x

        @property
        def rect(self) -> Any:
            return FRect(self.x, 0, 2, 2)

        @property
        def radius(self) -> float:
            return 0.5

    near, far = Body(0), Body(1.5)
    assert ours.groupcollide([near], [far], False, False) == {near: [far]}
    assert ours.groupcollide([near], [far], False, False, collide_circle) == {}
    far.x = 1.0  # 0.5 + 0.5: circles that touch collide
    assert ours.groupcollide([near], [far], False, False, collide_circle) == {near: [far]}


@pytest.mark.parametrize("rule", [*BUILT_IN, "mask"])
@pytest.mark.parametrize("broken", ["left", "right"])
@pytest.mark.parametrize("kind", [theirs.Sprite, type("Bare", (), {})])
def test_a_sprite_without_a_rect_is_refused_as_pygame_does(
    rule: str, broken: str, kind: type
) -> None:
    collided = BUILT_IN.get(rule, theirs.collide_mask)
    good, bad = Named("good", Rect(0, 0, 1, 1)), kind()
    good.mask = bad.mask = pygame.Mask((1, 1), fill=True)
    left, right = ([bad], [good]) if broken == "left" else ([good], [bad])

    def refusals(library: Any) -> Iterator[str]:
        for call in calls_of(library, left, right, collided)[:4]:
            with pytest.raises((AttributeError, TypeError)) as refusal:
                call()
            yield repr(refusal.value)

    assert list(refusals(ours)) == list(refusals(theirs))


@pytest.mark.parametrize("collided", [None, collide_rect, collide_circle, odd, ours.prefilter(odd)])
def test_nothing_collides_with_nothing(collided: Collided) -> None:
    sprites = one_place(2)
    for library in (theirs, ours):
        for kill in (False, True):
            assert library.groupcollide(sprites, [], kill, kill, collided) == {}
            assert library.groupcollide([], sprites, kill, kill, collided) == {}
            assert library.spritecollide(sprites[0], [], kill, collided) == []
            assert library.spritecollideany(sprites[0], [], collided) is None
    assert ours.selfcollide([], collided) == ours.selfcollide(sprites[:1], collided) == []
    assert not any(hasattr(sprite, "radius") for sprite in sprites)


def test_a_keyboard_interrupt_gets_through() -> None:
    class Stop(theirs.Sprite):
        @property
        def rect(self) -> Any:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ours.groupcollide([Stop()], [Stop()], False, False)


@pytest.mark.parametrize("collided", [3, "rect", collide_rect_ratio("x"), collide_rect_ratio(None)])
def test_what_pygame_refuses_is_refused(collided: Any) -> None:
    left, right = one_place(1), one_place(1)
    for call in calls_of(theirs, left, right, collided) + calls_of(ours, left, right, collided):
        with pytest.raises(TypeError):
            call()


@pytest.mark.parametrize("radius", ["x", None, 10**400, float("nan"), float("inf"), 1e160])
def test_strange_radii(radius: Any) -> None:
    def run(library: Any) -> Any:
        left, right = one_place(2), one_place(2)
        left[1].radius = radius
        try:
            return named(library.groupcollide(left, right, False, False, collide_circle))
        except Exception as error:
            return type(error), str(error)

    assert run(ours) == run(theirs)


def test_radii_of_numpy_are_computed_as_numpy_does() -> None:
    for kind in (np.float32, np.float64, np.int64, np.float16):
        for gap in range(1, 40):
            left, right = one_place(1)[0], one_place(1)[0]
            right.rect.x = gap
            left.radius, right.radius = kind(gap) * kind(0.3), kind(gap) * kind(0.7)
            want = theirs.spritecollide(left, [right], False, collide_circle)
            assert ours.spritecollide(left, [right], False, collide_circle) == want


@given(some_rects, ints | halves | anything)
def test_query_rect(rects: list[Any], query: Any) -> None:
    sprites = [Named(f"s{row}", rect) for row, rect in enumerate(rects)]
    group = ours.Group(sprites)
    want = [sprite for sprite in sprites if query.colliderect(sprite.rect)]
    assert group.query_rect(query) == want
    for sprite in sprites:
        sprite.rect = Rect(0, 0, 3, 3)
    want = sprites if query.colliderect((0, 0, 3, 3)) else []
    assert group.query_rect(query) == want
    assert isinstance(group, theirs.Group) and isinstance(group.copy(), ours.Group)


def gap_to(point: tuple[float, float], rect: Any) -> float:
    """Return the distance of a rect from a point."""
    away = [
        max(min(side, side + size) - at, at - max(side, side + size), 0)
        for at, side, size in zip(point, rect[:2], rect[2:], strict=True)
    ]
    return math.hypot(*away)


places = st.tuples(quarters, quarters)


@given(st.lists(ints | halves, max_size=9), places, st.integers(1, 5), st.sampled_from([2.0, 1e9]))
def test_nearest(rects: list[Any], point: Any, k: int, reach: float) -> None:
    sprites = [Named(f"s{row}", rect) for row, rect in enumerate(rects)]
    group = ours.Group(sprites)
    order = sorted(sprites, key=lambda sprite: gap_to(point, sprite.rect))
    want = [sprite for sprite in order if gap_to(point, sprite.rect) <= reach][:k]
    assert group.nearest(point, k, max_distance=reach) == want
    assert group.nearest(pygame.Vector2(point), k, max_distance=reach) == want


@given(st.lists(ints | halves, max_size=9), places)
def test_raycast_along_an_axis(rects: list[Any], origin: Any) -> None:
    """A rect is hit if the ray crosses its interior."""
    sprites = [Named(f"s{row}", rect) for row, rect in enumerate(rects)]
    sprites = [sprite for sprite in sprites if all(sprite.rect.size)]
    for rect in (sprite.rect for sprite in sprites):  # edges are tested with the tree
        assume(origin[1] not in (rect.top, rect.bottom))
        assume(origin[0] not in (rect.left, rect.right))
    crossed = []
    for sprite in sprites:
        rect = sprite.rect.copy()
        rect.normalize()
        if rect.top < origin[1] < rect.bottom and rect.right > origin[0]:
            crossed.append((max(rect.left - origin[0], 0), sprite))
    hit, distance = ours.Group(sprites).raycast(origin, (2, 0))
    want = min((gap for gap, _ in crossed), default=math.inf)
    assert distance == want
    assert (want, hit) in crossed if crossed else hit is None


def test_a_group_is_asked_about_the_present() -> None:
    group = ours.Group()
    assert group.nearest((0, 0)) == []
    assert group.raycast((0, 0), (1, 0)) == (None, math.inf)
    first, second, third = (Named(f"s{x}", Rect(x, 0, 2, 2)) for x in (0, 10, 20))
    group.add(first, second)
    assert group.nearest((30, 1)) == [second]
    first.rect.x = 25
    assert group.nearest((30, 1)) == [first]
    group.add(third)
    assert group.nearest((22.5, 1)) == [third]
    third.kill()
    assert group.nearest((22.5, 1)) == [first]
    first.rect, second.rect = second.rect, first.rect
    assert group.nearest((22.5, 1)) == [second]
    # The same rects in reverse order: the tree may be the same, the answer may not.
    group.empty()
    group.add(second, first)
    assert group.nearest((22.5, 1)) == [second]
    assert group.raycast((0, 1), (5, 0)) == (first, 10)
    assert group.raycast((0, 1), (5, 0), max_distance=9) == (None, math.inf)
    second.rect = Never(1, 0, 2, 2)
    assert group.nearest((0, 0), k=5) == [second, first]
    second.rect = (1, 0, 2, 2)
    assert group.nearest((0, 0), k=5) == [second, first]


def test_a_tree_is_built_only_if_a_rect_has_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    built = []
    monkeypatch.setattr(groups, "Quadtree", lambda *x, **y: built.append(x) or Quadtree(*x, **y))
    group = ours.Group(one_place(3))
    group.nearest((0, 0))
    group.raycast((0, 0), (1, 0))
    group.snapshot()
    assert len(built) == 1
    group.sprites()[1].rect.x += 1
    group.nearest((0, 0))
    assert len(built) == 2


@given(st.lists(ints | halves, max_size=9), st.lists(places, max_size=5), st.integers(1, 4))
def test_many_points_and_rays_at_once(rects: list[Any], points: list[Any], k: int) -> None:
    """Each row of many answers equals the answer for that row alone."""
    sprites = [Named(f"s{row}", rect) for row, rect in enumerate(rects)]
    group = ours.Group(sprites)
    now = group.snapshot()
    vectors = [pygame.Vector2(point) for point in points]
    directions = [(1 + row, -row) for row in range(len(points))]
    near = [group.nearest(point, k, max_distance=4) for point in points]
    rays = [group.raycast(*ray) for ray in zip(points, directions, strict=True)]
    for index in (group, now):
        for many in (points, np.reshape(points, (-1, 2)), vectors):
            assert index.nearest(many, k, max_distance=4) == near
            hits, distances = index.raycast(many, directions)
            assert list(zip(hits, distances.tolist(), strict=True)) == rays
    if points:
        hits, distances = group.raycast(points[0], [(1, 0), (0, 1)])
        assert [hits[0], distances[0]] == list(group.raycast(points[0], (1, 0)))


@given(some_rects, st.lists(ints | halves | anything, max_size=4))
def test_query_many_rects(rects: list[Any], queries: list[Any]) -> None:
    group = ours.Group(Named(f"s{row}", rect) for row, rect in enumerate(rects))
    want = [group.query_rect(rect) for rect in queries]
    assert group.query_rect(queries) == group.query_rect(tuple(queries)) == want
    assert group.query_rect([Named("x", rect) for rect in queries]) == want
    if all(isinstance(rect, FRect) for rect in queries):
        rows = [tuple(rect) for rect in queries]
        assert group.query_rect(rows) == group.query_rect(np.reshape(rows, (-1, 4))) == want


@given(some_rects, st.lists(ints | halves | anything, min_size=1, max_size=4))
def test_a_snapshot_answers_as_the_group_did(rects: list[Any], queries: list[Any]) -> None:
    assume(all(math.isfinite(side) for rect in rects for side in rect))
    sprites = [Named(f"s{row}", rect.copy()) for row, rect in enumerate(rects)]
    group = ours.Group(sprites)
    want = group.query_rect(queries), group.nearest((0, 0), 3), group.raycast((0, 0), (1, 2))
    then = group.snapshot()
    for sprite in sprites:
        sprite.rect.update(7, 7, 1, 1)
    group.add(Named("late", Rect(0, 0, 5, 5)))
    if sprites:
        sprites[0].kill()
    got = then.query_rect(queries), then.nearest((0, 0), 3), then.raycast((0, 0), (1, 2))
    assert got == want
    assert then.query_rect(queries[0]) == want[0][0]
    assert len(then) == len(sprites)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda g: g.nearest((1, 2, 3)), "point"),
        (lambda g: g.nearest("here"), "point must hold real numbers"),
        (lambda g: g.nearest([(0, 0), (0, math.nan)]), r"point\[1\] is .*NaN"),
        (lambda g: g.nearest((0, 0), 0), "k is 0"),
        (lambda g: g.nearest((0, 0), max_distance=-1), "max_distance is -1"),
        (lambda g: g.raycast((0, 0), (0, 0)), "direction is"),
        (lambda g: g.raycast([(0, 0)] * 3, [(1, 0)] * 2), "direction"),
        (lambda g: g.raycast(None, (1, 0)), "origin must hold real numbers"),
        (lambda g: g.query_rect(3), "rect is 3; it must be a pygame.Rect"),
        (lambda g: g.query_rect((1, 2, 3)), r"rect is \(1, 2, 3\); it must be a pygame.Rect"),
        (lambda g: g.query_rect([Rect(0, 0, 1, 1), "abcd"]), r"rect\[1\] is 'abcd'; it must be"),
        (lambda g: g.query_rect(np.zeros((2, 3))), r"rect\[0\] is .*; it must be"),
    ],
)
def test_what_a_group_refuses_is_named(call: Any, message: str) -> None:
    group = ours.Group(one_place(2))
    for index in (group, group.snapshot()):
        with pytest.raises((TypeError, ValueError), match=message):
            call(index)


@pytest.mark.parametrize(
    ("rect", "error", "message"),
    [
        (None, TypeError, r"sprites\[1\]\.rect is None; it must be a pygame.Rect"),
        (FRect(0, math.inf, 1, 1), ValueError, r"sprites\[1\]\.rect is .*inf.*; it must be finite"),
        (FRect(0, 0, math.nan, 1), ValueError, r"sprites\[1\]\.rect is .*nan.*; it must be finite"),
    ],
)
def test_a_sprite_without_a_valid_rect_is_named(rect: Any, error: type, message: str) -> None:
    group = ours.Group(one_place(3))
    group.sprites()[1].rect = rect
    for call in (
        group.snapshot,
        lambda: group.nearest((0, 0)),
        lambda: group.raycast((0, 0), (1, 1)),
    ):
        with pytest.raises(error, match=message):
            call()


def test_ctrl_c_ends_a_long_search_among_sprites() -> None:
    """Sixteen million pairs of rects, circles and masks; the dict of them takes long as well."""
    crowd = [Named("one of many", Rect(0, 0, 5, 5)) for _ in range(4000)]
    for rule in (None, collide_circle):
        took = reaction_to_ctrl_c(lambda r=rule: ours.groupcollide(crowd, crowd, False, False, r))
        print(f"{rule}: {took:.3f} s")
        assert took < 1.0


def test_pairs_become_lists_in_parts_so_that_ctrl_c_is_handled(monkeypatch) -> None:
    lengths = []

    class Pairs(np.ndarray):
        def tolist(self) -> Any:
            lengths.append(len(self))
            return super().tolist()

    many = 70_000
    pairs = np.tile(np.array([(0, 1)], np.uint32), (many, 1)).view(Pairs)
    near = Near(pairs, np.zeros(many, np.bool_).view(Pairs), lambda a, b: True, Radii())
    monkeypatch.setattr(collisions, "find_near", lambda *arguments: near)
    assert ours.selfcollide("ab", collide_rect) == [("a", "b")] * many
    assert [(row, len(list(triples))) for row, triples in near.by_left()] == [(0, many)]
    assert max(lengths) < many


def test_ctrl_c_during_the_first_call_of_all_is_no_panic() -> None:
    code = """
import os, signal, threading
import pygame, jostle.pygame
signal.signal(signal.SIGINT, signal.default_int_handler)
crowd = [pygame.sprite.Sprite() for _ in range(3000)]
for sprite in crowd:
    sprite.rect = pygame.Rect(0, 0, 5, 5)
threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    while True:
        jostle.pygame.groupcollide(crowd, crowd, False, False)
except KeyboardInterrupt:
    print("stopped")
"""
    assert run_child(code).endswith("stopped\n")
