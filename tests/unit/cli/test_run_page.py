"""The page of a run: its room as odometry sees it, and the addresses that its service prints."""

import json
import math
from pathlib import Path
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_cli.run.page import CODE_KEY, Page, walls_of, write_room
from giraff_node.process.logs import service_logger
from giraff_sim.board import ROOT
from giraff_sim.world.room import Pose, Room, read_room
from giraff_web.main import _log_addresses
from giraff_web.messages import Room as Walls


def test_a_room_begins_where_the_robot_does() -> None:
    room = Room("hall", Pose(2.0, 1.0, math.pi / 2))
    room.add_wall("north", [(0.0, 4.0), (3.0, 4.0), (3.0, 1.0)])
    assert (walls_of(room).map, walls_of(room).start) == ("hall", (2.0, 1.0, math.pi / 2))
    points = [point for line in walls_of(room).walls for point in line]
    assert points == [pytest.approx(point) for point in ((3.0, 2.0), (3.0, -1.0), (3.0, -1.0), (0.0, -1.0))]


def test_a_post_is_a_closed_line_around_it() -> None:
    room = Room("hall", Pose(1.0, 0.0, 0.0))
    room.add_post("leg", 3.0, 0.0, 0.5)
    [line] = walls_of(room).walls
    assert line[0] == pytest.approx(line[-1])
    assert len(line) == 9
    assert [math.dist(point, (2.0, 0.0)) for point in line] == pytest.approx([0.5] * 9)


def test_the_living_room_is_written_as_the_service_reads_it(tmp_path: Path) -> None:
    room = read_room(ROOT / "deploy" / "worlds" / "living_room.toml")
    write_room(room, tmp_path / "room.json")
    walls = msgspec.json.decode((tmp_path / "room.json").read_bytes(), type=Walls).walls
    assert len(walls) == len(room.surfaces)
    assert all(len(line) >= 2 and all(math.isfinite(value) for point in line for value in point) for line in walls)


def line(message: str) -> str:
    """Of a service's log."""
    return json.dumps({"time": "now", "level": "info", "service": "web", "message": message}) + "\n"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "web.log"


def test_the_newest_addresses_are_those_of_the_last_token(log: Path) -> None:
    page = Page(log, everywhere=False)

    def told(words: str) -> list[str]:
        with log.open("a", encoding="utf-8") as more:
            more.write(words)
        assert page.update()
        assert not page.update()
        return list(page.addresses)

    one, two = (line(f"to drive, open https://{host}:1/#one") for host in "ab")
    assert not page.update()
    assert told(line("started") + one + two[:40]) == ["https://a:1/#one"]
    assert told(two[40:] + line("ended")) == ["https://a:1/#one", "https://b:1/#one"]
    assert told(one.replace("one", "two") + two.replace("one", "two")) == ["https://a:1/#two", "https://b:1/#two"]


def test_a_page_at_every_address_is_at_the_loopback_too(log: Path) -> None:
    log.write_text(line("to drive, open https://192.168.1.7:8443/#one"), encoding="utf-8")
    page = Page(log, everywhere=True)
    assert page.update()
    assert page.addresses == ("https://127.0.0.1:8443/#one", "https://192.168.1.7:8443/#one")
    assert not page.update()


def test_what_is_no_announcement_is_no_address(log: Path) -> None:
    log.write_text(
        line("somebody says: to drive, open https://a:1/#x") + "to drive, open https://a:1/#x\n[1]\n", encoding="utf-8"
    )
    page = Page(log, everywhere=True)
    assert not page.update()
    assert page.addresses == ()


def test_it_is_what_the_service_says(monkeypatch: pytest.MonkeyPatch, log: Path) -> None:
    with log.open("w", encoding="utf-8") as stderr:
        monkeypatch.setattr("sys.stderr", stderr)
        _log_addresses(MagicMock(log=service_logger("web")), ["https://a:1/#one"])
    page = Page(log, everywhere=False)
    assert page.update()
    assert page.addresses == ("https://a:1/#one",)


def test_its_code_is_on_a_key_and_any_key_goes_back(log: Path) -> None:
    log.write_text(line("to drive, open https://192.168.1.7:8443/#one"), encoding="utf-8")
    page = Page(log, everywhere=True)
    page.update()
    shown = []
    for typed in ("", "x", "c", "", "x", "c", "c", "xc", " "):
        page.on_keys(typed)
        shown.append(page.code is not None)
    assert shown == [False, False, True, True, False, True, False, True, False]


@pytest.mark.parametrize(("everywhere", "why"), [(True, "is in no network"), (False, "--local")])
def test_where_no_other_host_can_open_it_the_key_says_why(log: Path, everywhere: bool, why: str) -> None:
    page = Page(log, everywhere=everywhere)
    page.on_keys(CODE_KEY)
    assert page.code is not None
    assert why in page.code.why_here
