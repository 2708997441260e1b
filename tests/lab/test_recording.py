"""Films: they play, keep the time, and never hold up the window."""

import threading
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pygame
import pytest
from outputs import frames_of

from jostle.record import Film
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.palette import RECORDING
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.start import start
from jostle_lab.storage import files, recording
from jostle_lab.storage.recording import MOST_QUEUED, Recording
from jostle_lab.window import Window

SIZE = (320, 180)


def blurred(picture: np.ndarray, side: int) -> np.ndarray:
    """The means of squares of the picture, as one column."""
    height, width = picture.shape[0] // side * side, picture.shape[1] // side * side
    grey = picture[:height, :width].mean(axis=2)
    return grey.reshape(height // side, side, width // side, side).mean(axis=(1, 3)).ravel()


@pytest.fixture
def session(open_session, tmp_path: Path) -> Session:
    session = open_session("gas", 100, size=SIZE)
    session.files.folder = tmp_path
    return session


def run(session: Session, seconds: float, rate: float = 60.0) -> None:
    for _ in range(round(seconds * rate)):
        session.messages.now += 1 / rate
        session.advance(1 / rate)


def finish(session: Session) -> Recording:
    """End the film and wait for it; return what it was."""
    film = session.files.recording
    film.close()
    session.advance(0.0)
    assert session.files.recording is None
    return film


@pytest.mark.parametrize(("suffix", "rate"), [(".mp4", 30), (".gif", 25)])
def test_a_film_has_the_length_of_what_was_seen(session: Session, suffix: str, rate: int) -> None:
    session.files.options.suffix = suffix
    session.files.toggle_recording()
    assert "Recording" in session.message
    run(session, 1.0)
    session.files.toggle_recording()
    film = finish(session)
    assert film.error == ""
    pictures = frames_of(film.path)
    assert len(pictures) == film.written
    assert len(pictures) == pytest.approx(rate, abs=1)
    assert (pictures[0] != pictures[-1]).any()
    assert "Saved" in session.message and film.path.name in session.message
    assert film.path.parent == session.files.folder


@pytest.mark.parametrize("rate", [10.0, 144.0])
def test_a_film_keeps_the_time_of_slow_and_fast_windows(session: Session, rate: float) -> None:
    session.files.toggle_recording()
    run(session, 1.0, rate)
    film = finish(session)
    assert len(frames_of(film.path)) == pytest.approx(30, abs=3)
    if rate < 30:
        assert film.repeated > 15
        assert "repeated" in session.message


def test_a_film_has_a_size_of_its_own_and_shows_the_same(session: Session) -> None:
    session.files.options.size = (640, 360)
    session.files.toggle_recording()
    run(session, 0.2)
    film = finish(session)
    picture = frames_of(film.path)[-1]
    assert picture.shape == (360, 640, 3)
    session.files.screenshot()
    (still,) = session.files.folder.glob("*.png")
    small = pygame.surfarray.array3d(pygame.image.load(still)).swapaxes(0, 1)
    assert np.corrcoef(blurred(picture, 40), blurred(small, 20))[0, 1] > 0.8


def test_a_film_of_a_fixed_length_ends_by_itself(session: Session) -> None:
    session.files.options.seconds = 0.5
    session.files.toggle_recording()
    film = session.files.recording
    assert film.progress == 0.0
    run(session, 2.0)
    film.close()
    assert len(frames_of(film.path)) == film.written == 15
    assert film.progress == 1.0


def test_the_window_never_waits_for_the_film(session: Session, monkeypatch) -> None:
    """While the encoder is stuck the window goes on; the film then has the right length."""
    gate, add = threading.Event(), Film.add
    stuck = threading.Event()

    def wait(self: Film, picture: np.ndarray) -> None:
        stuck.set()
        assert gate.wait(60)
        add(self, picture)

    monkeypatch.setattr(Film, "add", wait)
    session.files.toggle_recording()
    run(session, 0.1)
    assert stuck.wait(60)
    run(session, 3.0)  # does not block, though nothing is written
    film = session.files.recording
    assert film.written == 0
    assert film.queued <= MOST_QUEUED + 1
    gate.set()
    while film.queued > 0:
        threading.Event().wait(0.01)
    run(session, 0.2)
    film = finish(session)
    assert len(frames_of(film.path)) == pytest.approx(99, abs=2)
    assert film.repeated > 60


def red_pixels(window: Window) -> int:
    """Return how many pixels in the right corner have the colour of the mark of a film."""
    picture = pygame.surfarray.array3d(window.screen.canvas())[-300:, -60:].astype(int)
    return int((np.abs(picture - np.array(RECORDING)).sum(axis=2) < 30).sum())


def test_closing_the_window_while_recording_leaves_a_film_that_plays(tmp_path: Path) -> None:
    window = Window(start(Settings("gas", 100)), SIZE, synchronous=True)
    window.session.files.folder = tmp_path
    window.session.files.toggle_recording()
    for _ in range(30):
        window.frame(1 / 60)
    film = window.session.files.recording
    assert red_pixels(window) > 40, "a dot says that a film is made"
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    window.run()
    assert film.done and film.error == ""
    assert len(frames_of(film.path)) == film.written >= 15


def test_an_encoder_that_dies_becomes_a_notice(session: Session, monkeypatch, tmp_path) -> None:
    dying = tmp_path / "ffmpeg"
    dying.write_text("#!/bin/sh\nhead -c 1000 > /dev/null\nexit 1\n")
    dying.chmod(0o755)
    with monkeypatch.context() as patched:
        patched.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(dying))
        session.files.toggle_recording()
    for _ in range(200):
        run(session, 0.1)
        if session.files.recording is None:
            break
        threading.Event().wait(0.01)
    assert session.files.recording is None
    assert "ended early" in session.message
    session.files.toggle_recording()  # and another can begin
    run(session, 0.1)
    assert finish(session).error == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no disk that is always full")
def test_a_full_disk_becomes_a_notice(session: Session, tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "film.mp4").symlink_to("/dev/full")
    monkeypatch.setattr(files, "new_path", lambda *_: tmp_path / "film.mp4")
    session.files.toggle_recording()
    film = session.files.recording
    run(session, 1.0)
    film.close()
    session.advance(0.0)
    assert "No space left" in film.error
    assert "No space left" in session.message


def test_without_a_folder_or_an_ffmpeg_a_notice_says_so(
    session: Session, tmp_path: Path, monkeypatch
) -> None:
    (tmp_path / "file").write_text("")
    session.files.folder = tmp_path / "file" / "out"
    session.files.toggle_recording()
    assert session.files.recording is None
    assert session.message
    session.files.screenshot()
    session.files.save()
    session.files.folder = tmp_path

    def missing() -> str:
        raise RuntimeError("No ffmpeg exe could be found.")

    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", missing)
    session.files.toggle_recording()
    assert session.files.recording is None
    assert "no ffmpeg can be started" in session.message


def test_what_takes_too_long_at_the_end_is_left_out(tmp_path: Path, monkeypatch) -> None:
    gate = threading.Event()
    monkeypatch.setattr(recording.Picture, "draw", lambda *_: gate.wait(5))
    simulation = start(Settings("gas", 10))
    film = Recording(tmp_path / "film.mp4", SIZE)
    camera = Camera(SIZE, simulation.view)
    for number in range(MOST_QUEUED):
        film.offer(simulation.frame(), camera, ViewOptions(), number / 30)
    threading.Timer(0.3, gate.set).start()
    film.close(patience=0.05)
    assert film.done
    assert 1 <= len(frames_of(film.path)) < MOST_QUEUED
