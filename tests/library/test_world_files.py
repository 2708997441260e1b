"""`World.save` and `World.load`: permissions, links, failures and damaged files."""

import os
import re
import stat
import threading
from pathlib import Path

import pytest
from signals import full_disk

import jostle

pytestmark = pytest.mark.skipif(os.name != "posix", reason="permissions and links are POSIX's")


def small() -> jostle.World:
    return jostle.scenes.create("gas", n=20)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("permissions", [0o600, 0o640, 0o666, 0o755])
def test_a_file_keeps_its_permissions(permissions: int, tmp_path: Path) -> None:
    path = tmp_path / "world.jostle"
    path.write_text("old")
    path.chmod(permissions)
    small().save(path)
    assert mode(path) == permissions
    assert path.read_bytes() == small().snapshot()
    assert os.listdir(tmp_path) == ["world.jostle"]


def test_a_new_file_honours_the_umask(tmp_path: Path) -> None:
    old = os.umask(0o027)
    try:
        small().save(tmp_path / "world.jostle")
    finally:
        os.umask(old)
    assert mode(tmp_path / "world.jostle") == 0o640


@pytest.mark.parametrize("there", [True, False])
def test_a_symbolic_link_stays_and_its_target_is_written(there: bool, tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    target, link = folder / "world.jostle", tmp_path / "latest"
    if there:
        target.write_text("old")
        target.chmod(0o600)
    middle = tmp_path / "middle"
    middle.symlink_to("folder/world.jostle")
    link.symlink_to(middle)
    small().save(link)
    assert link.is_symlink()
    assert middle.is_symlink()
    assert not target.is_symlink()
    assert target.read_bytes() == small().snapshot()
    if there:
        assert mode(target) == 0o600
    assert len(jostle.World.load(link)) == 20
    assert os.listdir(folder) == ["world.jostle"]


def test_a_circle_of_links_is_refused(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.symlink_to(other)
    other.symlink_to(one)
    with pytest.raises(OSError, match="symbolic links"):
        small().save(one)
    assert sorted(os.listdir(tmp_path)) == ["one", "other"]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everything")
def test_a_file_without_write_permission_is_unchanged(tmp_path: Path) -> None:
    path = tmp_path / "world.jostle"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(PermissionError):
        small().save(path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["world.jostle"]


def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "world.jostle"
    path.write_text("old")
    with full_disk(100), pytest.raises(OSError, match="large"):
        small().save(path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["world.jostle"]


def test_a_pipe_is_written_and_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    found: list[bytes] = []
    reader = threading.Thread(target=lambda: found.append(pipe.read_bytes()))
    reader.start()
    small().save(pipe)
    reader.join()
    assert found == [small().snapshot()]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_a_long_name_is_allowed(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 255)
    small().save(path)
    assert len(jostle.World.load(path)) == 20


@pytest.mark.parametrize("name", ["x\udcff", b"y\xfe", "z"], ids=["surrogate", "bytes", "str"])
def test_a_name_may_be_bytes_and_need_not_be_utf_8(name: str | bytes, tmp_path: Path) -> None:
    folder = os.fspath(tmp_path)
    path = os.path.join(os.fsencode(folder) if isinstance(name, bytes) else folder, name)
    small().save(path)
    assert os.path.exists(path)
    assert len(jostle.World.load(path)) == 20
    with pytest.raises(TypeError, match=r"expected str, bytes or os.PathLike"):
        small().save(3)


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/full", "pipe"])
def test_what_may_have_no_end_is_not_read(device: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match=r"it is a pipe or a device, not a file"):
        jostle.World.load(tmp_path / device)


def test_only_the_first_bytes_of_another_file_are_read(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(1 << 40)  # more than fits into memory
    with pytest.raises(ValueError, match=f"holds {1 << 40} bytes of something else"):
        jostle.World.load(tmp_path / "large")


WHOLE = small().snapshot()


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", "nothing; a snapshot has at least its head"),
        (WHOLE[:5], "a damaged snapshot; it is cut off: 5 of at least 28 bytes are there"),
        (WHOLE[:20], "a damaged snapshot; it is cut off: 20 of at least 28 bytes are there"),
        (
            WHOLE[:-7],
            "a damaged snapshot; it is cut off: "
            f"{len(WHOLE) - 7} of at least {len(WHOLE)} bytes are there",
        ),
        (b"words", "5 bytes of something else; it does not begin as a snapshot does"),
        (WHOLE[:-1] + b"?", "a damaged snapshot; its checksum is wrong"),
        (WHOLE + b"!", "a damaged snapshot; its checksum is wrong"),
    ],
    ids=["empty", "in the magic", "in the head", "in the body", "foreign", "changed", "longer"],
)
def test_what_is_wrong_with_a_file_names_the_file(data: bytes, sentence: str, tmp_path) -> None:
    path = tmp_path / "a world"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=f"^{re.escape(f'{path} holds {sentence}')}$"):
        jostle.World.load(path)
    with pytest.raises(ValueError, match=f"^{re.escape(f'data is {sentence}')}$"):
        jostle.World.restore(data)
