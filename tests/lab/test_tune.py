"""`jostle tune`: the protocol, the map, the picture and the command, with minimal work."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import jostle
from jostle_lab.tune import measure as measuring
from jostle_lab.tune.command import table
from jostle_lab.tune.measure import ARTICLE, CAPACITIES, Map, Search, Setting, measure
from jostle_lab.tune.picture import draw, in_ms

NO_LIMIT = 4096


def some_map(**changes: object) -> Map:
    """The default is 2 % slower than the best, and one setting was too slow."""
    rounds = {
        Setting(3, NO_LIMIT): [9e-3] * 3,
        Setting(3, 5): [4e-3] * 3,
        Setting(96, NO_LIMIT): [1e-3, 1.02e-3, 7e-3],
        Setting(128, NO_LIMIT): [1e-3] * 3,
        Setting(128, 5): [2e-3] * 3,
    }
    facts = {"depths": {3: 9, 96: 5, 128: 6}, "rounds": rounds, **changes}
    return Map("gas", 100, 1, Setting(96, NO_LIMIT), **facts)  # type: ignore[arg-type]


def test_every_round_times_each_tree_once_after_it_has_answered(monkeypatch) -> None:
    calls: list[Setting] = []
    pairs = Search.pairs

    def noted(self: Search, setting: Setting) -> np.ndarray:
        calls.append(setting)
        return pairs(self, setting)

    monkeypatch.setattr(Search, "pairs", noted)
    monkeypatch.setattr(measuring, "MEASUREMENT", 1e-9)  # no call is repeated
    monkeypatch.setattr(measuring, "TOO_SLOW", 1e9)
    shares: list[float] = []
    found = measure("gas", 300, rounds=3, report=shares.append)
    trees = list(found.rounds)
    first, rounds = calls[: -3 * len(trees)], calls[-3 * len(trees) :]
    assert set(first) == set(trees)
    orders = [rounds[k * len(trees) : (k + 1) * len(trees)] for k in range(3)]
    assert all(sorted(order) == sorted(trees) for order in orders)
    assert len({tuple(order) for order in orders}) == 3
    assert all(len(times) == 3 for times in found.rounds.values())
    assert shares == sorted(shares) and shares[-1] == 1.0


def test_the_trees_are_those_of_the_map_and_the_default_is_the_librarys() -> None:
    found = measure("gas", 300, rounds=1)
    positions, radii = Search.of("gas", 300).positions, Search.of("gas", 300).radii
    assert sorted(found.depths) == sorted({*CAPACITIES, found.default.leaf_capacity})
    default = jostle.Quadtree(positions, radii)
    limits = {name: getattr(found.default, name) for name in ("leaf_capacity", "max_depth")}
    limited = jostle.Quadtree(positions, radii, **limits)
    assert np.array_equal(default.nodes().boxes, limited.nodes().boxes)
    for setting in found.rounds:
        assert found.same_tree(*setting) == setting
    assert min(found.depths.values()) < max(found.rows()[:-1]) < max(found.depths.values())


def test_a_wrong_answer_ends_the_measurement(monkeypatch: pytest.MonkeyPatch) -> None:
    pairs = Search.pairs

    def wrong(self: Search, setting: Setting) -> np.ndarray:
        more = [[0, 1]] * (setting.leaf_capacity == 8)
        return np.vstack([pairs(self, setting), np.reshape(more, (-1, 2))])

    monkeypatch.setattr(Search, "pairs", wrong)
    with pytest.raises(RuntimeError, match=r"leaf_capacity=8.* find other pairs"):
        measure("gas", 300, rounds=1)


def test_below_a_depth_that_is_too_slow_no_tree_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    timed, tried = measuring._timed, set()

    def slow(search: Search, setting: Setting) -> tuple[float, np.ndarray]:
        tried.add(setting)
        return (1.0 if setting.max_depth <= 2 else 1e-3), timed(search, setting)[1]

    monkeypatch.setattr(measuring, "_timed", slow)
    found = measure("clusters", 300, rounds=1)
    assert Setting(3, 2) in tried and Setting(3, 2) not in found.rounds
    assert Setting(3, 1) not in tried and Setting(3, 3) in found.rounds


def test_a_map_and_its_table_know_the_special_settings_with_three_digits() -> None:
    found = some_map()
    assert found.best == Setting(128, NO_LIMIT)
    assert found.over_best(found.default) == pytest.approx(1.02)
    assert found.same_tree(96, 5) == found.default and found.same_tree(128, 5) == (128, 5)
    assert found.seconds(Setting(128, 4)) == np.inf
    assert found.rows() == [1, 2, 3, 4, 5, 6, 7, 8, NO_LIMIT]
    columns = [list(column.cells) for column in table(some_map()).columns]
    assert columns[0] == ["fastest", "default", "article of 2015", "slowest"]
    assert columns[2] == ["no limit", "no limit", f"{ARTICLE.max_depth}", "no limit"]
    assert columns[3:] == [["1.00", "1.02", "4.00", "9.00"], ["1.00", "1.02", "4.00", "9.00"]]
    written = [in_ms(value) for value in (1.2345, 9.996e-3, 2.832e-4, 4.3e-6)]
    assert written == ["1,230", "10.0", "0.283", "0.00430"]


def test_a_picture_frames_the_best_and_the_default_of_each_map(tmp_path: Path) -> None:
    draw([some_map()] * 3, tmp_path / "map.png")
    pixels = (255 * imread(tmp_path / "map.png")[..., :3]).round().astype(int)
    for colour in ((0xC2, 0x45, 0x3F), (0x22, 0x28, 0x2F), (0xD9, 0x8A, 0x2B)):
        assert (np.abs(pixels - colour).max(axis=2) <= 2).sum() > 1000 * 3


def test_the_command_prints_a_table_and_writes_the_picture(jostle_command, tmp_path) -> None:
    out = tmp_path / "new" / "map.svg"
    code, printed, _ = jostle_command.run("tune", "gas", "-n", 200, "--out", out)
    assert code == 0
    assert all(
        words in printed for words in ("gas, 200 particles", "default", "fastest", "map.svg")
    )
    assert "Milliseconds over leaf capacity and depth" in out.read_text(encoding="utf-8")
