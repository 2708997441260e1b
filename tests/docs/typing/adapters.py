"""Types of the adapters, the scenes and the article."""

from typing import Any

import pygame
from typing_extensions import assert_type

from jostle import World, scenes
from jostle.pygame import Group, collide_rect_lists, groupcollide, selfcollide, spritecollide
from jostle.pyqtree import Index
from jostle_lab import article


class Ship(pygame.sprite.Sprite):
    def __init__(self, *groups: Any) -> None:
        super().__init__(*groups)
        self.rect = pygame.Rect(0, 0, 9, 9)
        self.lives = 3


def sprites(ships: list[Ship]) -> None:
    fleet = Group(ships)
    for ship, others in groupcollide(fleet, ships, False, False).items():
        print(ship.lives, [other.lives for other in others])
    for ship in spritecollide(ships[0], fleet, dokill=True):
        print(ship.lives)
    for one, other in selfcollide(ships):
        print(one.lives, other.lives)
    for ship in fleet:
        print(ship.lives)
    print([ship.lives for ship in fleet.sprites()])
    print([ship.lives for ship in fleet.query_rect(pygame.Rect(0, 0, 5, 5))])
    print([ship.lives for ship in fleet.nearest((0, 0), k=2)])
    hit, distance = fleet.raycast((0, 0), pygame.Vector2(1, 0))
    assert_type(distance, float)
    if hit:
        print(hit.lives)
    assert_type(collide_rect_lists([ships[0].rect], ships), list[list[int]])


def index() -> None:
    boxes = Index(bbox=(0, 0, 100, 100))
    boxes.insert("duck", (50, 30, 53, 60))
    for item in boxes.intersect((51, 51, 86, 86)):
        print(item)
    for items in boxes.intersect_many([(0, 0, 1, 1), (2, 2)]):
        print(items[0])


def others() -> None:
    assert_type(scenes.create("gas"), World)
    assert_type(scenes.names(), list[str])
    assert_type(scenes.view("gas"), tuple[float, float, float, float])
    program = article.Simulation(10, seed=1)
    program.frame()
    for particle in program.particles:
        assert_type(particle.x, float)
