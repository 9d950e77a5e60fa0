"""Serial links over real ptys: opened by path, never waited for, and only the right board is believed."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from giraff_node.board_link import SILENCE, BoardLink
from giraff_node.serial_link import REOPEN_PERIOD, SerialLink
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import PROTOCOL_HASH, BoardKind, HelloFrame, HelloRequestFrame, RangeFrame, TickFrame
from tests.unit.node.ports import FakePort

BAUD = 115200
HELLO = HelloFrame(seq=0, board_us=1, board=BoardKind.RANGER, protocol_hash=PROTOCOL_HASH, boot_id=1, reset_cause=1)
PING = RangeFrame(1, 2, 1, 3, 4, 0, 0, 0, 5800, 0)


@pytest.fixture
def port(tmp_path: Path) -> Iterator[FakePort]:
    fake = FakePort(tmp_path / "board")
    yield fake
    fake.close()


@pytest.fixture
def link(port: FakePort) -> Iterator[SerialLink]:
    opened = SerialLink(str(port.link), BAUD)
    assert opened.keep_open(0.0)
    yield opened
    opened.close("the test has ended")


def test_an_absent_port_is_named_and_tried_again_in_time(tmp_path: Path) -> None:
    link = SerialLink(str(tmp_path / "absent"), BAUD)
    assert not link.keep_open(0.0)
    assert "no such port" in link.fault
    assert str(tmp_path / "absent") in link.fault
    assert link.descriptor() is None
    fake = FakePort(tmp_path / "absent")
    assert not link.keep_open(REOPEN_PERIOD / 2)
    assert link.keep_open(REOPEN_PERIOD)
    assert (link.fault, link.opened) == ("", 1)
    link.close("")
    fake.close()


def test_a_file_that_is_no_port_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    link = SerialLink(str(tmp_path / "file"), BAUD)
    assert not link.keep_open(0.0)
    assert str(tmp_path / "file") in link.fault


def test_what_was_queued_before_the_opening_is_dropped(port: FakePort) -> None:
    port.say(b"of an earlier life")
    link = SerialLink(str(port.link), BAUD)
    assert link.keep_open(0.0)
    assert link.read() == b""
    port.say(b"now")
    assert link.read() == b"now"
    link.close("")


def test_a_port_in_use_is_named(port: FakePort, link: SerialLink) -> None:
    other = SerialLink(str(port.link), BAUD)
    assert not other.keep_open(0.0)
    assert "in use by another process" in other.fault
    assert link.fault == ""


def test_an_unplugged_port_is_named_and_reopened_by_path(port: FakePort, link: SerialLink) -> None:
    port.unplug()
    assert link.read() == b""
    assert "unplugged" in link.fault
    link.send(b"into nothing")
    assert not link.keep_open(1.0)
    assert "no such port" in link.fault
    port.plug()
    assert link.keep_open(2.0)
    port.say(b"again")
    assert link.read() == b"again"
    assert link.opened == 2


def test_a_reader_that_does_not_read_costs_no_time_and_no_frame_is_torn(port: FakePort, link: SerialLink) -> None:
    frames = [encode(TickFrame(seq, 1, seq).pack()) for seq in range(3000)]
    for frame in frames:
        link.send(frame)  # more than the pty holds: this would block for ever if it could
    decoder = Decoder()
    heard = decoder.feed(port.heard())
    link.flush()
    heard += decoder.feed(port.heard())
    sent = [frame.seq for frame in heard]
    assert sent == sorted(set(sent))
    assert sent[-1] == 2999, "the newest one was not sent"
    assert len(sent) < 3000
    assert (decoder.crc_errors, decoder.shape_errors) == (0, 0)


def ranger_link(port: FakePort) -> BoardLink:
    link = BoardLink(str(port.link), BAUD, BoardKind.RANGER)
    assert link.poll(0.0) == []
    return link


def test_nothing_is_believed_before_a_matching_hello(port: FakePort) -> None:
    link = ranger_link(port)
    assert [type(frame) for frame in Decoder().feed(port.heard())] == [HelloRequestFrame]
    port.say(encode(PING.pack()))
    assert link.poll(0.1) == []
    assert "no reports from a ranger board" in link.fault
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert link.poll(0.2) == [HELLO, PING]
    assert link.fault == ""
    link.close()


def test_hello_is_asked_for_until_it_is_answered(port: FakePort) -> None:
    link = ranger_link(port)
    for step in range(1, 60):
        port.say(b"\0")
        link.poll(step * 0.05)
    requests = [frame for frame in Decoder().feed(port.heard()) if isinstance(frame, HelloRequestFrame)]
    assert len(requests) >= 5
    link.close()


@pytest.mark.parametrize(
    ("hello", "says"),
    [
        (msgspec.structs.replace(HELLO, protocol_hash=1), "reflash"),
        (msgspec.structs.replace(HELLO, board=BoardKind.BASE), "a base board is there, not a ranger board"),
        (msgspec.structs.replace(HELLO, board=77), "a kind 77 board is there"),
    ],
)
def test_the_wrong_board_is_refused_and_named(port: FakePort, hello: HelloFrame, says: str) -> None:
    link = ranger_link(port)
    port.say(encode(hello.pack()) + encode(PING.pack()))
    assert PING not in link.poll(0.1)
    assert says in link.fault
    assert str(port.link) in link.fault
    link.close()


def test_a_silent_port_is_opened_again(port: FakePort) -> None:
    link = ranger_link(port)
    port.say(encode(HELLO.pack()) + encode(PING.pack()))
    assert link.poll(0.1) != []
    link.poll(0.1 + SILENCE / 2)
    assert link.opened == 1
    link.poll(0.2 + SILENCE)
    assert "silent" in link.fault
    link.poll(0.4 + SILENCE)
    assert link.opened == 2
    link.close()


def test_noise_and_torn_frames_are_counted_and_survived(port: FakePort) -> None:
    link = ranger_link(port)
    port.say(encode(HELLO.pack()))
    link.poll(0.01)
    noise = random.Random(3)
    good = 0
    for step in range(300):
        torn = encode(PING.pack())[: noise.randrange(8)]
        port.say(noise.randbytes(noise.randrange(60)) + torn + b"\0" + encode(PING.pack()))
        good += link.poll(0.02 + step * 1e-3).count(PING)
    assert good == 300
    assert link.line_errors > 100
    link.close()


def test_descriptors_are_not_leaked(port: FakePort) -> None:
    before = len(list(Path("/proc/self/fd").iterdir()))
    link = SerialLink(str(port.link), BAUD)
    for step in range(50):
        assert link.keep_open(float(step))
        link.close("again")
    assert len(list(Path("/proc/self/fd").iterdir())) == before
