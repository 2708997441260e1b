"""Files are whole: after an error the old file is as before, and nothing else is left."""

import os
import stat
from pathlib import Path

import pytest
from machine import Results
from signals import full_disk

from jostle.writing import NewFile, append, write
from jostle_lab.sweep.plan import plan
from jostle_lab.sweep.table import Table
from jostle_lab.tune.measure import Map, Setting
from jostle_lab.tune.picture import draw

MOST = 200  # bytes of a file on the full disk


def plot(path: Path) -> None:
    setting = Setting(96, 4096)
    draw([Map("gas", 10, 1, setting, {3: 2, 96: 1}, {setting: [1e-3]})], path)


@pytest.mark.parametrize("is_there", [True, False])
def test_a_full_disk_leaves_the_old_file(is_there: bool, tmp_path: Path) -> None:
    path = tmp_path / "map.png"
    if is_there:
        path.write_bytes(b"old")
    with full_disk(), pytest.raises(OSError):
        plot(path)
    assert [*tmp_path.iterdir()] == ([path] if is_there else [])
    assert not is_there or path.read_bytes() == b"old"
    plot(path)
    assert path.stat().st_size > MOST
    assert [*tmp_path.iterdir()] == [path]


def test_rows_that_do_not_fit_are_not_there_in_part(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    results = Results(path)
    with full_disk(), pytest.raises(OSError):
        results.add([{"name": "n" * MOST}])
    assert not [*tmp_path.iterdir()]
    results = Results(path)
    results.add([{"name": "n"}])
    before = path.read_bytes()
    with full_disk(), pytest.raises(OSError):
        results.add([{"name": "n" * MOST}])
    assert path.read_bytes() == before


def test_a_sweep_goes_on_after_a_full_disk(tmp_path: Path) -> None:
    runs = plan("gas", 20, [], 3, 5, 0, ["energy"])
    path = tmp_path / "table.csv"
    table = Table(path, runs)
    row = dict.fromkeys(path.read_text().strip().split(","), "1")
    before = path.read_bytes()
    with full_disk(), pytest.raises(OSError):
        for _ in range(MOST):
            table.add(row)
    after = path.read_bytes()
    assert after.startswith(before) and after.endswith(b"\n")
    assert len(Table(path, runs).left) == 3


def test_a_new_file_has_the_permissions_and_the_place_of_the_old_one(tmp_path: Path) -> None:
    path, link = tmp_path / "old", tmp_path / "link"
    path.write_bytes(b"old")
    path.chmod(0o640)
    link.symlink_to(path)
    write(link, b"new")
    assert link.is_symlink() and path.read_bytes() == b"new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    before = os.umask(0o027)
    try:
        write(tmp_path / "new", b"new")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640
    with pytest.raises(FileNotFoundError):
        write(tmp_path / "nowhere" / "new", b"new")


def test_a_device_is_written_and_stays_and_a_name_need_not_be_utf_8(tmp_path: Path) -> None:
    write(Path("/dev/null"), b"new")
    append(Path("/dev/null"), b"new")
    assert not Path("/dev/null").is_file()
    with pytest.raises(OSError, match="No space"):
        write(Path("/dev/full"), b"new")
    assert Path("/dev/full").exists()
    path = tmp_path / os.fsdecode(b"x\xff\xfe.png")
    plot(path)
    assert path.stat().st_size > MOST


def test_an_interruption_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "old"
    write(path, b"old")
    with pytest.raises(KeyboardInterrupt), NewFile(path) as new:
        new.path.write_bytes(b"half")
        raise KeyboardInterrupt
    assert [*tmp_path.iterdir()] == [path] and path.read_bytes() == b"old"
