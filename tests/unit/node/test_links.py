"""Serial links over real ptys: opened by path, never waited for, and only the right board is believed."""

import contextlib
import os
import random
import select
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
import serial

from giraff_node.boards.board_link import SILENCE, BoardLink
from giraff_node.boards.serial_link import REOPEN_PERIOD, SETTLES, SerialLink
from giraff_schemas.boards import NANO_RANGER_BOARD, ROBOCLAW_BOARD
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import PROTOCOL_HASH, BoardKind, HelloFrame, HelloRequestFrame, RangeFrame, TickFrame
from tests.unit.node.ports import FakePort

BAUD = 115200
HELLO = HelloFrame(seq=0, board_us=1, board=BoardKind.RANGER, protocol_hash=PROTOCOL_HASH, boot_id=1, reset_cause=1)
PING = RangeFrame(1, 2, 1, 3, 4, 0, 0, 0, 5800, 0)


@pytest.fixture
def link(port: FakePort) -> Iterator[SerialLink]:
    opened = SerialLink(str(port.link), BAUD)
    assert opened.keep_open(0.0)
    yield opened
    opened.close(Trouble("the test has ended"))


def test_an_absent_port_is_named_and_tried_again_in_time(tmp_path: Path) -> None:
    link = SerialLink(str(tmp_path / "absent"), BAUD)
    assert not link.keep_open(0.0)
    assert "no such port" in str(link.fault)
    assert str(tmp_path / "absent") in str(link.fault)
    assert link.descriptor() is None
    fake = FakePort(tmp_path / "absent")
    assert not link.keep_open(REOPEN_PERIOD / 2)
    assert link.keep_open(REOPEN_PERIOD)
    assert (link.fault, link.opened) == (NO_TROUBLE, 1)
    link.close(NO_TROUBLE)
    fake.close()


def test_what_was_queued_before_the_opening_is_dropped(port: FakePort) -> None:
    port.say(b"of an earlier life")
    link = SerialLink(str(port.link), BAUD)
    assert link.keep_open(0.0)
    port.say(b"of an earlier life, out of the adapter")
    assert link.read() == b""
    assert not link.keep_open(SETTLES)
    port.say(b"now")
    assert link.read() == b"now"
    link.close(NO_TROUBLE)


def test_what_comes_while_the_port_is_being_opened_is_dropped(port: FakePort, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever pyserial has dropped by itself before."""

    class Slow(serial.Serial):
        def open(self) -> None:
            super().open()
            port.say(b"of an earlier life")

    monkeypatch.setattr(serial, "Serial", Slow)
    link = SerialLink(str(port.link), BAUD)
    assert link.keep_open(0.0)
    assert link.read() == b""
    link.close(NO_TROUBLE)


def test_what_an_earlier_process_has_left_unsent_is_dropped(port: FakePort) -> None:
    """As far as a pty can show it: its other end may have taken up to a page already."""
    with port.link.open("wb", buffering=0) as earlier:
        os.set_blocking(earlier.fileno(), False)
        while earlier.write(b"x" * 100):
            pass
        link = SerialLink(str(port.link), BAUD)
        assert link.keep_open(0.0)
        link.send(b"now")
        heard = drained(port, link, b"now")
        link.close(NO_TROUBLE)
    assert len(heard) <= 4096 + 3
    assert heard.lstrip(b"x") == b"now"


def test_a_port_in_use_is_named(port: FakePort, link: SerialLink) -> None:
    other = SerialLink(str(port.link), BAUD)
    assert not other.keep_open(0.0)
    assert "in use by another process" in str(other.fault)
    assert link.fault == NO_TROUBLE


def test_an_unplugged_port_is_named_and_reopened_by_path(port: FakePort, link: SerialLink) -> None:
    port.unplug()
    assert link.read() == b""
    assert "unplugged" in str(link.fault)
    assert link.descriptor() is None
    assert not link.keep_open(1.0)
    assert "no such port" in str(link.fault)
    port.plug()
    assert link.keep_open(2.0)
    assert not link.keep_open(3.0)
    port.say(b"again")
    assert link.read() == b"again"
    assert link.opened == 2


def test_nothing_of_an_earlier_life_is_sent_in_the_next(port: FakePort, link: SerialLink) -> None:
    while not link._unsent:
        link.send(b"x" * 100)
    link.send(b"begun late")
    port.unplug()
    link.read()
    link.send(b"into nothing")
    port.plug()
    assert link.keep_open(1.0)
    link.flush()
    assert port.heard() == b""
    link.send(b"now")
    assert port.heard() == b"now"


def test_what_the_path_names_now_is_opened_and_not_what_it_named_before(port: FakePort, link: SerialLink) -> None:
    before = FakePort(port.link.with_name("kept"))
    before.master, port.master = port.master, before.master
    before._slave, port._slave = port._slave, before._slave
    port.link.unlink()
    port.link.symlink_to(before.link.readlink())
    # The old device still answers, and is used until it fails.
    link.keep_open(1.0)
    os.write(before.master, b"old")
    assert link.read() == b"old"
    link.close(Trouble("the board was silent"))
    port.say(b"dropped, as it came before the opening")
    assert link.keep_open(2.0)
    link.keep_open(3.0)
    port.say(b"new")
    assert link.read() == b"new"
    before.close()


def test_a_dead_port_is_noticed_by_writing_too(port: FakePort, link: SerialLink) -> None:
    port.unplug()
    link.send(b"into nothing")
    assert "unplugged" in str(link.fault)
    assert link.descriptor() is None


@pytest.mark.parametrize("size", [1, 7, 64])
def test_a_frame_that_was_begun_is_finished_before_the_newest_one(port: FakePort, link: SerialLink, size: int) -> None:
    frames = [encode(TickFrame(seq, 1, 5 << 40 | seq).pack()) for seq in range(1, 3000)]
    decoder, heard = Decoder(), []
    for n, frame in enumerate(frames):
        link.send(frame)
        if n % 3 == 0:
            with contextlib.suppress(BlockingIOError):
                heard += decoder.feed(os.read(port.master, size))
    newest = frames[-1]
    assert link._waiting in (b"", newest)
    assert link._unsent == b"" or any(each.endswith(link._unsent) for each in frames)
    heard += decoder.feed(drained(port, link, newest))
    sent = [frame.seq for frame in heard]
    assert sent == sorted(set(sent))
    assert sent[-1] == 2999
    assert (decoder.crc_errors, decoder.shape_errors) == (0, 0)


def drained(port: FakePort, link: SerialLink, last: bytes) -> bytes:
    """All that comes out of the port when it is read again, up to that. The kernel passes it on in its own time."""
    data = b""
    for _ in range(3000):
        link.flush()
        data += port.heard()
        if data.endswith(last):
            break
        select.select([port.master], [], [], 0.02)
    return data


def test_a_frame_that_was_not_begun_gives_way_to_a_newer_one(port: FakePort, link: SerialLink) -> None:
    descriptor = link.descriptor()
    assert descriptor is not None
    full = 0
    while full < 10:  # to the last byte, so that not even a part of a frame is taken
        try:
            os.write(descriptor, b"\0")
            full = 0
        except BlockingIOError:
            full += 1
            select.select([], [], [], 0.002)
    for seq in (1, 2, 3):
        link.send(encode(TickFrame(seq, 1, seq).pack()))
    assert [frame.seq for frame in Decoder().feed(drained(port, link, encode(TickFrame(3, 1, 3).pack())))] == [3]


def test_a_reader_that_does_not_read_costs_no_time_and_no_frame_is_torn(port: FakePort, link: SerialLink) -> None:
    frames = [encode(TickFrame(seq, 1, seq).pack()) for seq in range(3000)]
    for frame in frames:
        link.send(frame)  # more than the pty holds: this would block for ever if it could
        assert len(link._unsent) + len(link._waiting) < 2 * len(frame), "more than one frame waits"
    decoder = Decoder()
    sent = [frame.seq for frame in decoder.feed(drained(port, link, frames[-1]))]
    assert sent == sorted(set(sent))
    assert sent[-1] == 2999, "the newest one was not sent"
    assert len(sent) < 3000
    assert (decoder.crc_errors, decoder.shape_errors) == (0, 0)


def test_nothing_is_believed_before_a_matching_hello(port: FakePort, ranger: BoardLink) -> None:
    port.say(encode(PING.pack()))
    assert ranger.poll(0.1) == []
    assert [type(frame) for frame in Decoder().feed(port.heard())] == [HelloRequestFrame]
    assert "no reports from a ranger board" in str(ranger.fault)
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert ranger.poll(0.2) == [HELLO, PING]
    assert ranger.fault == NO_TROUBLE


def test_hello_is_asked_for_until_it_is_answered(port: FakePort, ranger: BoardLink) -> None:
    for step in range(1, 60):
        port.say(b"\0")
        ranger.poll(step * 0.05)
    requests = [frame for frame in Decoder().feed(port.heard()) if isinstance(frame, HelloRequestFrame)]
    assert len(requests) >= 5


@pytest.mark.parametrize(
    ("hello", "says"),
    [
        (msgspec.structs.replace(HELLO, protocol_hash=1), "reflash"),
        (msgspec.structs.replace(HELLO, board=BoardKind.BASE), "a base board is there, not a ranger board"),
        (msgspec.structs.replace(HELLO, board=77), "a kind 77 board is there"),
        (
            msgspec.structs.replace(HELLO, board=NANO_RANGER_BOARD.number),
            "is there, not a ranger board; flash it: make -C firmware flash BOARD=ranger",
        ),
        (
            msgspec.structs.replace(HELLO, board=NANO_RANGER_BOARD.number),
            'or, if that one is right, write board = "nano_ranger" into [ranger]',
        ),
    ],
)
def test_the_wrong_board_is_refused_and_named(port: FakePort, ranger: BoardLink, hello: HelloFrame, says: str) -> None:
    port.say(encode(hello.pack()) + encode(PING.pack()))
    assert PING not in ranger.poll(0.1)
    assert says in str(ranger.fault)
    assert str(port.link) in str(ranger.fault)


def test_a_board_that_is_a_process_is_started_and_not_flashed(port: FakePort, tmp_path: Path) -> None:
    link = BoardLink(str(tmp_path / "port"), ROBOCLAW_BOARD)
    assert (link.poll(0.0), link.fault.remedy) == ([], "journalctl -u giraff-board@roboclaw")
    assert "port is not there: the process giraff-board@roboclaw does not run, or its contr" in link.fault.what
    link = BoardLink(str(port.link), ROBOCLAW_BOARD)
    link.poll(1.0)
    for protocol, board, told in ((0, BoardKind.BASE, "; start it"), (1, ROBOCLAW_BOARD.number, "; restart it")):
        port.say(encode(msgspec.structs.replace(HELLO, board=board, protocol_hash=protocol).pack()))
        link.poll(1.1 + protocol / 10.0)
        assert f"{told}: sudo systemctl restart giraff-board@roboclaw" in str(link.fault)
    link.close()


def test_a_board_that_changes_is_judged_anew(port: FakePort, ranger: BoardLink) -> None:
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert PING in ranger.poll(0.1)
    port.say(encode(msgspec.structs.replace(HELLO, protocol_hash=1).pack()) + encode(PING.pack()))
    assert ranger.poll(0.2) == []
    assert "reflash" in str(ranger.fault)
    assert ranger.hello is None
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert ranger.poll(0.3) == [HELLO, PING]
    assert ranger.fault == NO_TROUBLE


def test_what_was_said_of_a_board_ends_when_the_port_is_opened_again(port: FakePort, ranger: BoardLink) -> None:
    port.say(encode(msgspec.structs.replace(HELLO, board=BoardKind.BASE).pack()))
    ranger.poll(0.1)
    assert "a base board is there" in str(ranger.fault)
    port.unplug()
    ranger.poll(0.2)
    assert "unplugged" in str(ranger.fault)
    port.plug()
    ranger.poll(0.4)
    assert "no reports from a ranger board yet" in str(ranger.fault)
    assert ranger.hello is None


def test_the_next_device_on_a_port_has_to_prove_itself_again(port: FakePort, ranger: BoardLink) -> None:
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert PING in ranger.poll(0.1)
    port.unplug()
    ranger.poll(0.2)
    port.plug()
    ranger.poll(0.4)
    port.say(encode(PING.pack()))
    assert ranger.poll(0.5) == []
    assert "no reports" in str(ranger.fault)


def test_a_port_that_stays_silent_is_named_once_and_for_all(port: FakePort, ranger: BoardLink) -> None:
    """Else each opening would be two lines of log."""
    said = []
    for step in range(1, 100):
        ranger.poll(step * 0.05)
        said.append(ranger.fault)
    assert ranger.opened >= 4
    assert len(dict.fromkeys(said)) == 2
    assert "no reports" in str(said[0])
    assert "silent for 1 s" in str(said[-1])
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    ranger.poll(5.0)
    assert ranger.fault == NO_TROUBLE


STRANGE = "bytes/s that are not this board's frames; see whether it is another device"


@pytest.mark.parametrize(
    ("noise", "told"),
    [(b"", "silent for 1 s"), (b"\xff" * 60, f"it sends 1200 {STRANGE}"), (encode(PING.pack())[:-4] + b"\0", STRANGE)],
)
def test_a_port_that_says_no_frame_is_told_by_what_comes(
    port: FakePort, ranger: BoardLink, noise: bytes, told: str
) -> None:
    for step in range(1, 30):
        if ranger.descriptor() is not None:
            port.say(noise)
        ranger.poll(step * 0.05)
    assert told in str(ranger.fault)
    assert ranger.opened == 2


def test_half_a_frame_of_the_earlier_life_does_not_spoil_the_first_of_the_next(
    port: FakePort, ranger: BoardLink
) -> None:
    port.say(encode(HELLO.pack()) + encode(PING.pack())[:-5])
    ranger.poll(0.1)
    port.unplug()
    ranger.poll(0.2)
    port.plug()
    ranger.poll(0.4)
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert ranger.poll(0.5) == [HELLO, PING]
    assert ranger.line_errors == 0


def test_a_silent_port_is_opened_again(port: FakePort, ranger: BoardLink) -> None:
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert ranger.poll(0.1) != []
    ranger.poll(0.1 + SILENCE / 2)
    assert ranger.opened == 1
    ranger.poll(0.2 + SILENCE)
    assert "silent" in str(ranger.fault)
    ranger.poll(0.4 + SILENCE)
    assert ranger.opened == 2


def test_noise_and_torn_frames_are_counted_and_survived(port: FakePort, ranger: BoardLink) -> None:
    port.say(encode(HELLO.pack()))
    ranger.poll(1.0)
    noise = random.Random(3)
    good = 0
    for step in range(300):
        torn = encode(PING.pack())[: noise.randrange(8)]
        port.say(noise.randbytes(noise.randrange(60)) + torn + b"\0" + encode(PING.pack()))
        good += ranger.poll(1.01 + step * 1e-3).count(PING)
    assert good == 300
    assert ranger.line_errors > 100


def test_descriptors_are_not_leaked(port: FakePort) -> None:
    before = len(list(Path("/proc/self/fd").iterdir()))
    link = SerialLink(str(port.link), BAUD)
    for step in range(50):
        assert link.keep_open(float(step))
        link.close(Trouble("again"))
    assert len(list(Path("/proc/self/fd").iterdir())) == before
