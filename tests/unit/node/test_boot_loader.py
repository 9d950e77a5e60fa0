"""An Arduino whose port is opened is in its boot loader for 1 to 2 s: it is left alone, and not reset again."""

import termios

from giraff_node.boards.board_link import LATELY, BoardLink
from giraff_node.boards.serial_link import SerialLink
from giraff_schemas.framing import encode
from giraff_schemas.trouble import NO_TROUBLE
from giraff_schemas.wire import PROTOCOL_HASH, BoardKind, HelloFrame, TickFrame
from tests.unit.node.ports import FakePort

HELLO = HelloFrame(seq=0, board_us=1, board=BoardKind.RANGER, protocol_hash=PROTOCOL_HASH, boot_id=1, reset_cause=1)


def test_nothing_disturbs_a_boot_loader(port: FakePort, ranger: BoardLink) -> None:
    """Which says nothing by itself: as the port is opened, or opened again, and where the board is reset later."""

    def nothing_is_sent(since: float) -> None:
        port.heard()
        for step in range(9):
            ranger.poll(since + step * 0.1)
            ranger.send(TickFrame(seq=step, epoch=1, robot_ns=step))
        assert port.heard() == b""

    nothing_is_sent(0.1)
    port.say(encode(HELLO.pack()))
    assert ranger.poll(0.95) == [HELLO]
    ranger.send(TickFrame(seq=0, epoch=1, robot_ns=0))
    assert port.heard() != b""
    nothing_is_sent(0.95 + LATELY)
    port.say(encode(HELLO.pack()))
    ranger.poll(2.5)
    port.unplug()
    ranger.poll(2.51)
    port.plug()
    nothing_is_sent(2.65)


def test_dtr_stays_when_a_port_is_closed(port: FakePort) -> None:
    """Since an Arduino is reset as it comes back. A USB port begins with HUPCL, a pty without."""
    link = SerialLink(str(port.link), 115200)
    assert link.keep_open(0.0)
    with port.link.open("wb", buffering=0) as other:
        attributes = termios.tcgetattr(other.fileno())
        attributes[2] |= termios.HUPCL
        termios.tcsetattr(other.fileno(), termios.TCSANOW, attributes)
        link.close(NO_TROUBLE)
        assert link.keep_open(1.0)
        assert not termios.tcgetattr(other.fileno())[2] & termios.HUPCL
