"""pygame-ce's own tests of sprites, with the functions and the group of `jostle.pygame`."""

import json
import os
from importlib.util import find_spec

import pygame
import pytest
from signals import printed_by

# In a separate process, because the tests initialise pygame.
PROGRAM = """
import json, sys, unittest
import pygame, jostle.pygame
from pygame.tests import sprite_test

called = set()

def counted(name):
    ours = getattr(jostle.pygame, name)
    def call(*arguments, **named):
        called.add(name)
        return ours(*arguments, **named)
    return call

for name in ("groupcollide", "spritecollide", "spritecollideany"):
    setattr(pygame.sprite, name, counted(name))
pygame.sprite.Group = jostle.pygame.Group
tests = unittest.defaultTestLoader.loadTestsFromModule(sprite_test)
result = unittest.TextTestRunner(stream=sys.stderr).run(tests)
wrong = [(case.id(), text) for case, text in result.failures + result.errors + result.skipped]
wrong += [case.id() for case in result.unexpectedSuccesses]
print(json.dumps({"run": result.testsRun, "wrong": wrong, "called": sorted(called)}))
"""


def test_pygames_own_tests_pass() -> None:
    if find_spec("pygame.tests") is None:
        assert os.environ.get("CI") != "true", "the pinned pygame-ce brings its tests"
        pytest.skip("this pygame-ce was installed without its tests")
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}
    printed = printed_by("-c", PROGRAM, env=environment, timeout=120)
    found = json.loads(printed.splitlines()[-1])
    assert found["wrong"] == []
    assert found["called"] == ["groupcollide", "spritecollide", "spritecollideany"]
    expected = {"2.5.8": 143}.get(pygame.version.ver, 100)
    assert found["run"] >= expected
