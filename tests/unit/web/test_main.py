"""How the process begins, where it cannot."""

from pathlib import Path
from unittest.mock import MagicMock

import pytest

from giraff_node.process import libraries
from giraff_web import main as subject
from giraff_web.messages import Room


def test_a_library_that_is_missing_is_told_with_the_way_out(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(libraries, "find_spec", lambda name: None if name == "aiohttp" else object())
    with pytest.raises(SystemExit) as left:
        subject.main()
    assert left.value.code == 2
    assert capsys.readouterr().err == f"giraff_web: the library aiohttp is missing; {libraries.remedy('web')}\n"


def test_the_room_is_read(tmp_path: Path) -> None:
    path = tmp_path / "room.json"
    path.write_text('{"walls": [[[0, 0], [1, 0]]]}')
    assert subject._room(str(path)) == Room(walls=(((0.0, 0.0), (1.0, 0.0)),))
    assert subject._room("") is None


@pytest.mark.parametrize(("text", "told"), [("nonsense", "is no room"), ('{"walls": 1}', "is no room")])
def test_a_room_that_is_none_is_told(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "room.json"
    path.write_text(text)
    with pytest.raises(subject._RoomError, match=f"^\\[web\\] room: {path} {told}"):
        subject._room(str(path))


def test_a_room_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(subject._RoomError, match="cannot be read: No such file or directory"):
        subject._room(str(tmp_path / "room.json"))


def test_the_hosts_socket_is_its_users_alone_and_goes_with_the_service(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    node = MagicMock()
    with subject._host_socket(node) as host:
        assert host is not None
        (path,) = tmp_path.iterdir()
        assert path.stat().st_mode & 0o777 == 0o600
    assert list(tmp_path.iterdir()) == []
    node.set_notice.assert_not_called()


def test_a_run_directory_that_cannot_be_used_is_told_and_the_page_is_served_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = MagicMock()
    for folder, told in ((tmp_path / ("long" * 40), "AF_UNIX path too long"), (Path("/dev/null"), "File exists")):
        monkeypatch.setenv("RUNTIME_DIRECTORY", str(folder))
        with subject._host_socket(node) as host:
            assert host is None
        name, notice = node.set_notice.call_args.args
        assert name == "devices"
        assert f"giraff web --devices cannot ask there: {told}; let XDG_RUNTIME_DIR name" in str(notice)
