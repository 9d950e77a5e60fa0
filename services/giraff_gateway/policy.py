"""Bytes of a serial port to lines of text, and back. No I/O and no clock."""

import math
from collections import deque
from collections.abc import Iterator
from typing import Final

from giraff_gateway.config import GatewayConfig
from giraff_schemas.messages import SerialLine
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_CR: Final = 0x0D
_LF: Final = 0x0A
_NO_TEXT: Final = Trouble("bytes that are no text were replaced", "check `baud` and the cable")
_REPLACED: Final = "\N{REPLACEMENT CHARACTER}"


class LineSplitter:
    """Feed it what was read. CR, LF and CR LF each end a line; what has no end yet waits for it."""

    def __init__(self, name: str, longest: int) -> None:
        """`longest`: bytes of a piece."""
        self._name = name
        self._longest = longest
        self._begun = bytearray()
        self._after_cr = False

    def feed(self, data: bytes) -> Iterator[SerialLine]:
        """The lines that `data` ends, and the pieces of one that is too long."""
        for byte in data:
            ends_cr_lf = byte == _LF and self._after_cr
            self._after_cr = byte == _CR
            if ends_cr_lf:
                continue
            if byte in (_CR, _LF):
                yield self._taken(len(self._begun), goes_on=False)
                continue
            if len(self._begun) == self._longest:
                yield self._taken(_whole(self._begun), goes_on=True)
            self._begun.append(byte)

    def _taken(self, length: int, *, goes_on: bool) -> SerialLine:
        data = bytes(self._begun[:length])
        del self._begun[:length]
        text = data.decode(errors="replace")
        bad = text.count(_REPLACED) - data.count(_REPLACED.encode())
        return SerialLine(name=self._name, text=text, goes_on=goes_on, replaced=bad)


def wrong_with(line: SerialLine, config: GatewayConfig) -> dict[str, Trouble]:
    """What is wrong with a line that was read, by a word for each."""
    cut = Trouble(f"a line was longer than {config.longest_line} bytes, and is cut")
    return {
        "utf-8": _NO_TEXT.of(config.port) if line.replaced else NO_TROUBLE,
        "length": cut.of(config.port) if line.goes_on else NO_TROUBLE,
    }


def _whole(data: bytearray) -> int:
    """Length of `data` without a character at its end of which bytes may still come."""
    for back in range(1, min(4, len(data))):
        byte = data[-back]
        if byte >= 0xC0:
            needed = 2 if byte < 0xE0 else 3 if byte < 0xF0 else 4
            return len(data) - back if needed > back else len(data)
        if byte < 0x80:
            break
    return len(data)


class WriteQueue:
    """What waits to be written. The newest is refused once there is too much of it: what was begun comes whole."""

    def __init__(self, longest: int, ending: str, most: int = 64) -> None:
        """`longest`: bytes of a text; `most`: texts that wait."""
        self._longest, self._ending, self._most = longest, ending, most
        self._waiting: deque[bytes] = deque()

    def put(self, text: str) -> Trouble:
        """Take a text to be written, followed by the ending; NO_TROUBLE, or why it was not taken."""
        data = (text + self._ending).encode(errors="replace")
        if len(data) > self._longest:
            return Trouble(f"a text of {len(data)} bytes was not written: longest_line is {self._longest}")
        if len(self._waiting) == self._most:
            return Trouble(f"texts come faster than the board takes them, {self._most} wait", "write less")
        self._waiting.append(data)
        return NO_TROUBLE

    def pop(self) -> bytes:
        """The oldest text; empty: none waits."""
        return self._waiting.popleft() if self._waiting else b""

    def drop(self) -> int:
        """Forget what waits, as the board it was meant for is not there; how many texts."""
        dropped = len(self._waiting)
        self._waiting.clear()
        return dropped


class TimedNotices:
    """What has happened and is over at once, told for a while: nobody looks at the right moment."""

    def __init__(self, seconds: float, *names: str) -> None:
        self._seconds = seconds
        self._told: dict[str, tuple[Trouble, float]] = dict.fromkeys(names, (NO_TROUBLE, -math.inf))

    def report(self, name: str, trouble: Trouble, now: float) -> None:
        """It has happened just now. NO_TROUBLE: it has not."""
        if trouble:
            self._told[name] = trouble, now

    def now(self, now: float) -> dict[str, Trouble]:
        """By name, what is told now; NO_TROUBLE where nothing has happened lately."""
        return {
            name: trouble if now - at <= self._seconds else NO_TROUBLE for name, (trouble, at) in self._told.items()
        }
