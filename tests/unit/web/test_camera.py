"""Which pages are sent the camera's picture: those where a person has switched it on, one picture at a time."""

from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_schemas.camera import Asker, CameraState, Picture
from giraff_schemas.messages import RobotTime
from giraff_schemas.topics import CAMERA_STATE
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.camera import SILENT, SLOW, PageCameras
from giraff_web.config import WebConfig
from giraff_web.messages import Look, Looking
from giraff_web.pages import Closed, Event, Opened, Said
from giraff_web.service import Web
from tests.support.picture_source import Source, Sources
from tests.support.robots import ROBOT

PHONE, LAPTOP = "Android phone at 10.0.0.7", "Firefox on Linux at 10.0.0.8"
STATE = CameraState(instance="first", camera="front", askers=(), width=320, height=240, rate=0.0)


class Eye(Source):
    """A camera that has a new picture whenever it is asked."""

    def next_picture(self) -> Picture:
        tick = RobotTime(epoch=7, robot_ns=len(self.asked))
        jpeg = b"jpeg %d" % len(self.asked)
        return Picture(camera=self.camera, jpeg=jpeg, width=320, height=240, tick=tick)


class Desk:
    """Pages that look at it."""

    def __init__(self) -> None:
        self.sources = Sources(Eye)
        self.told: list[tuple[int, Looking]] = []
        self.sent: list[tuple[int, bytes]] = []
        pages = MagicMock()
        pages.send = lambda page, message: self.told.append((page, message))
        pages.send_picture = lambda page, data: self.sent.append((page, data))
        self.now = 10.0
        self.it = PageCameras(pages, "web@desk", self.sources)
        self.it.on_state(STATE, self.now)

    @property
    def source(self) -> Source:
        return self.sources.opened[-1]

    def turn(self, after: float = 0.02) -> list[int]:
        """The numbers of the pages that are sent a picture."""
        self.now += after
        self.it.on_state(STATE, self.now)
        before = len(self.sent)
        self.it.poll(self.now)
        return [page for page, _ in self.sent[before:]]

    def see(self, page: int, after: float = 0.02) -> None:
        """The page confirms the newest picture that it was sent."""
        self.now += after
        newest = [data for number, data in self.sent if number == page][-1]
        self.it.on_seen(page, int.from_bytes(newest[:4], "big"), self.now)


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_nobody_looks_until_a_person_switches_it_on_and_then_all_who_do_are_named(desk: Desk) -> None:
    assert desk.turn() == []
    assert desk.sources.opened == []
    desk.it.switch(1, PHONE, on=True)
    desk.it.switch(2, LAPTOP, on=True)
    assert desk.turn() == [1, 2]
    assert (desk.source.camera, desk.source.by) == ("front", f"web@desk ({PHONE}, {LAPTOP})")
    assert desk.told == [(page, Looking(on=True, why=NO_TROUBLE)) for page in (1, 2)]
    desk.it.switch(2, LAPTOP, on=False)
    desk.turn()
    assert (desk.source.by, desk.source.closed) == (f"web@desk ({PHONE})", False)
    desk.it.on_closed(1)
    assert desk.source.closed
    assert desk.turn() == []


def test_one_picture_is_under_way_to_a_page_and_the_next_is_the_newest(desk: Desk) -> None:
    desk.it.switch(1, PHONE, on=True)
    assert [desk.turn() for _ in range(4)] == [[1], [], [], []]
    desk.it.on_seen(1, 99, desk.now)
    assert desk.turn() == []
    desk.see(1)
    assert desk.turn() == [1]
    first, second = (data for _, data in desk.sent)
    assert first == b"\0\0\0\1" + (7).to_bytes(4, "big") + (1).to_bytes(8, "big") + b"jpeg 1"
    assert second[16:] == b"jpeg 6"


def test_it_begins_small_grows_where_all_confirm_quickly_and_shrinks_for_one_that_does_not(desk: Desk) -> None:
    desk.it.switch(1, PHONE, on=True)
    desk.it.switch(2, LAPTOP, on=True)
    for _ in range(5):
        desk.turn()
        desk.see(1)
        desk.see(2)
    assert desk.source.asked == ["small"] * 5
    desk.turn()
    assert [*desk.source.asked][-1:] == ["full"]
    desk.see(1)
    for _ in range(2):
        desk.turn(SLOW)
    assert [*desk.source.asked][-1:] == ["small"]
    desk.see(2)
    for _ in range(20):
        desk.turn()
        desk.see(1)
        desk.see(2)
    assert [*desk.source.asked][-1:] == ["small"], "it rests for a while"


def test_a_page_that_shows_nothing_and_a_camera_that_was_started_anew_end_it_with_the_way_out(desk: Desk) -> None:
    desk.it.switch(1, PHONE, on=True)
    desk.turn()
    desk.turn(SILENT + 0.1)
    assert desk.source.closed
    why = Trouble("the page showed nothing for 1.5 s", "check the wireless network, and tap to see it again")
    assert desk.told[-1] == (1, Looking(on=False, why=why))
    desk.it.switch(1, PHONE, on=True)
    assert desk.turn() == [1]
    desk.it.on_state(msgspec.structs.replace(STATE, instance="second"), desk.now)
    assert desk.source.closed
    why = Trouble("the camera was started anew", "tap to see it again")
    assert desk.told[-1] == (1, Looking(on=False, why=why))


def test_taps_open_one_source_a_second(desk: Desk) -> None:
    for _ in range(40):
        desk.it.switch(1, PHONE, on=True)
        desk.turn()
        desk.it.switch(1, PHONE, on=False)
    assert len(desk.sources.opened) == 1
    assert desk.source.closed


def test_every_page_is_told_who_looks_and_what_is_wrong(desk: Desk) -> None:
    asker = Asker(instance="x", by="view@laptop", size="small")
    unplugged = Trouble("it is unplugged", "plug it in")
    state = msgspec.structs.replace(STATE, askers=(asker,), reason=unplugged)
    desk.it.on_state(state, 20.0)
    view = desk.it.view(20.0)
    assert view is not None
    assert (view.askers, view.why) == (("view@laptop",), unplugged)
    silent = desk.it.view(20.1 + SILENT)
    assert silent is not None
    assert (silent.askers, silent.why.what) == ((), "no camera of the robot is heard")
    assert PageCameras(MagicMock(), "web@desk", None).view(0.0) is None


@pytest.mark.parametrize("may_drive", [False, True])
def test_a_page_that_may_not_drive_is_sent_no_picture(may_drive: bool) -> None:
    io, pages, sources = MagicMock(instance="me", hostname="desk"), MagicMock(), MagicMock()
    inboxes = {CAMERA_STATE.key: MagicMock(pop_all=lambda: [STATE])}
    io.inbox = lambda topic, **_: inboxes.get(topic.key, MagicMock(pop_all=list))
    web = Web(io, WebConfig(), ROBOT, pages, lambda _: None, None, sources)
    sources.return_value.ask.return_value = Eye("front").ask()
    sources.return_value.trouble = NO_TROUBLE
    said: list[Event] = [Opened(1, PHONE, may_drive), Said(1, Look(on=True))]
    for turn in range(10):
        pages.poll.return_value = said if turn == 3 else [Closed(1)] if turn == 8 else []
        web.turn(turn * 0.02)
    assert sources.called == pages.send_picture.called == may_drive
    assert sources.return_value.close.called == may_drive
