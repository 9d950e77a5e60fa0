"""Who looks at a camera of the robot from a terminal: what is asked for, shown, saved and recorded."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest

from giraff_cli.camera import look
from giraff_cli.camera.look import Cameras, choose_camera, report_of, rows_of
from giraff_cli.camera.window import CameraWindow, show
from giraff_cli.record.recorder import RecordedPictures, wanted_topics
from giraff_core.picture.receiver import PictureReceiver
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording
from giraff_node.network.consent import NoRobotError
from giraff_schemas.camera import Picture
from giraff_schemas.codec import encode
from giraff_schemas.messages import Tick
from giraff_schemas.topics import CAMERA_STATE, TICK
from giraff_schemas.trouble import Trouble
from giraff_tools.terminal.signals import StopSignal
from tests.support.picture_source import Source, Sources
from tests.unit.cli.samples import at, camera
from tests.unit.cli.typed import Giraff
from tests.unit.mcap.recordings import ROBOT, record


def picture(seq: int, width: int = 320) -> Picture:
    return Picture(
        seq=seq,
        stamp_ns=seq,
        instance="c",
        camera="head",
        jpeg=bytes(range(256)) * 2,
        width=width,
        height=width * 3 // 4,
        tick=at(seq),
    )


def test_which_camera_is_meant() -> None:
    both = {"head": camera(), "rear": camera()}
    assert choose_camera("giraff", {"head": camera()}, None) == "head"
    assert choose_camera("giraff", both, "rear") == "rear"
    with pytest.raises(NoRobotError, match="giraff has several cameras; name one of head, rear"):
        choose_camera("giraff", both, None)
    with pytest.raises(NoRobotError, match="giraff has no camera 'eye'; there are: head, rear"):
        choose_camera("giraff", both, "eye")


def test_a_list_says_who_looks_and_what_is_wrong() -> None:
    states = (camera("ann@desk (giraff view)"), camera(reason="no device at /dev/video0; plug it in"))
    off, on = sorted(rows_of(Cameras(robot="giraff", cameras=tuple(map(report_of, states)))), key=lambda row: row[1])
    assert on == ("head", "on", "320 x 240", "14.9", "ann@desk (giraff view) (full)", "")
    assert off == ("head", "off", "320 x 240", "-", "", "no device at /dev/video0; plug it in")


def test_pictures_that_were_asked_for_are_recorded_byte_for_byte(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = [picture(0, 160), picture(1), picture(2)]
    source = Source("head", "", *sent)
    pictures = PictureReceiver(lambda *_: source)
    pictures.on_sample(CAMERA_STATE, "", camera(), 0)
    connection: Any = SimpleNamespace(robot=ROBOT, subscribe=lambda _: None, dispatch=lambda _: None)
    kept = RecordedPictures(connection, pictures)
    monkeypatch.setattr(StopSignal, "wait", lambda *_: False)
    with StopSignal() as stopping:
        while source.coming:
            assert not kept.wait(stopping, 0.001)
    samples: list[RawSample] = kept.pop_all()
    assert kept.pop_all() == []
    record(tmp_path / "a.mcap", samples)
    read = list(Recording(tmp_path / "a.mcap").samples())
    assert [each.key for each in read] == ["camera/head/@small", "camera/head/@full", "camera/head/@full"]
    assert [each.decode() for each in read] == sent
    assert [each.payload for each in read] == [encode(each) for each in sent]


@pytest.mark.parametrize("pattern", ["camera/head/@full", "camera/*/@small", "**/@full"])
def test_no_picture_is_recorded_that_was_not_asked_for(pattern: str) -> None:
    assert wanted_topics(["**", "camera/*/*"]) == ["**", "camera/*/*"]  # no wildcard is a picture
    with pytest.raises(NoRobotError, match="--camera asks"):
        wanted_topics([pattern])


@pytest.mark.parametrize("verb", ["echo", "hz", "bw"])
def test_no_tool_listens_to_a_picture_that_it_has_not_asked_for(verb: str, giraff: Giraff) -> None:
    code, _, complaint = giraff("topic", verb, "camera/head/@full")
    assert code == 2
    assert "pictures must be asked for: giraff camera view" in complaint


def test_a_window_shows_what_comes_and_tells_why_nothing_does(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    source, drawn = Source("head", "", picture(0), picture(1)), []
    shown = SimpleNamespace(on_sample=lambda *given: drawn.append(given[1]), update=lambda _: None)
    monkeypatch.setattr("giraff_cli.camera.window.Show", lambda *_, **__: shown)
    pictures = PictureReceiver(lambda *_: source)
    tick = Tick(epoch=7, robot_ns=1)

    def dispatch(listener: CameraWindow) -> None:
        listener.on_sample(CAMERA_STATE, "camera/head/state", camera(), 0)
        listener.on_sample(TICK, TICK.key, tick, 0)

    connection: Any = SimpleNamespace(robot=ROBOT, dispatch=dispatch)
    window = CameraWindow(connection, pictures, "head")
    window.update()
    source.trouble = Trouble("the camera has started again", "ask for its picture again")
    window.update()
    window.update()
    assert window.has_seen
    assert drawn == [tick, picture(0), tick, picture(1), tick]
    assert capsys.readouterr().err == "giraff: the camera has started again; ask for its picture again\n"


@pytest.mark.parametrize("save", [None, Path("rear.jpeg")], ids=["window", "save"])
def test_of_several_cameras_the_one_that_was_named_is_asked(save: Path | None, monkeypatch: pytest.MonkeyPatch) -> None:
    def dispatch(listener: Any) -> None:
        for name in ("front", "rear", "top"):
            listener.on_sample(CAMERA_STATE, "", Source(name).state, 0)

    sources, window = Sources(), MagicMock()
    window.return_value.__enter__.return_value.is_open.side_effect = [True, False, False]
    for name, fake in (("Window", window), ("Show", MagicMock()), ("require_screen", lambda: None)):
        monkeypatch.setattr(f"giraff_cli.camera.window.{name}", fake)
    connection = SimpleNamespace(robot=ROBOT, subscribe=lambda _: None, dispatch=dispatch)
    monkeypatch.setattr(look, "_MEET", 0.0)
    monkeypatch.setattr(look, "pictures_for", lambda *_: PictureReceiver(sources))
    monkeypatch.setattr(look, "run_with_robot", lambda _robot, _connect, act: act(connection))
    assert look.view_camera("rear", None, (), save, 0.05, as_json=False) == 1  # nothing comes
    assert [(each.camera, each.closed) for each in sources.opened] == [("rear", True)]


def test_without_a_screen_no_camera_is_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    nobody: Any = None
    assert show(nobody, nobody, "head", None, nobody) == 2
    assert "give --save FILE" in capsys.readouterr().err
