"""A terminal's bytes to keys. Only a single, plain key press counts; whatever else comes moves nothing.

A terminal sends no key releases and no times, only bytes: a paste, a torn escape sequence, what was typed while the
process slept and a bouncing key look like presses. They are told by their company: a press comes alone.
"""

import math
from enum import Enum, auto
from typing import Final

from giraff_keyboard.policy import Key

ALONE: Final = 0.015
"""s. Two presses closer than this are no finger's; a keyboard repeats at up to 50 Hz."""
ASLEEP: Final = 0.2
"""s between two looks at the terminal, after which nobody knows when what it holds was typed; nor at the first look."""


HELD: Final = 2.0
"""s for which STOP is held to ask for off."""
_REPEATS: Final = 0.12
"""s between two repeats at most: terminals repeat at 10 to 50 Hz, a finger presses up to 8 times a second."""
_DELAY: Final = 1.0
"""s from the press to the first repeat at most."""
_SURELY: Final = 1.0
"""s for which repeats must have come without a gap. A person who hammers the key holds nothing."""

_PLAIN: Final = {
    **dict(zip(b"wsad", (Key.FORWARD, Key.BACKWARD, Key.LEFT, Key.RIGHT), strict=True)),
    **dict(zip(b"c+=-_", (Key.CLUTCH, Key.FASTER, Key.FASTER, Key.SLOWER, Key.SLOWER), strict=True)),
    **dict(zip(b"ry", (Key.RESET, Key.YES), strict=True)),
}
_ARROWS: Final = dict(zip(b"ABDC", (Key.FORWARD, Key.BACKWARD, Key.LEFT, Key.RIGHT), strict=True))

_ESC: Final = 0x1B
_BEL: Final = 0x07
_SPACE: Final = 0x20
_MOUSE_BYTES: Final = 3  # after "ESC [ M", where another program has left a mouse report on
_PASTE_BEGINS, _PASTE_ENDS = b"200", b"201"


class _Within(Enum):
    """What the next byte belongs to (ECMA-48)."""

    NOTHING = auto()
    ESCAPE = auto()
    CONTROL = auto()
    """ESC [ or ESC O, parameters, one final letter."""
    STRING = auto()
    """An answer of the terminal: until BEL or ESC."""
    MOUSE = auto()


class KeyReader:
    """Feed it what each look at the terminal found, with the look's time."""

    def __init__(self) -> None:
        self._within = _Within.NOTHING
        self._parameters = b""
        self._skip = 0
        self._pasting = False
        self._looked: float | None = None
        self._pressed: float | None = None

    def feed(self, data: bytes, now: float) -> list[Key]:
        """The keys in `data`, at most one beside STOP. `now`: s, of a monotonic clock."""
        slept = self._looked is None or now - self._looked > ASLEEP
        self._looked = now
        presses = [key for byte in data if (key := self._on_byte(byte)) is not None]
        if not presses:
            return []
        keys = [Key.STOP] if Key.STOP in presses else []  # a stop counts in whatever company it comes
        close = self._pressed is not None and now - self._pressed < ALONE
        self._pressed = now
        if slept or close or len(presses) > 1:
            return [*keys, Key.NOTHING]
        return keys or presses

    def _on_byte(self, byte: int) -> Key | None:
        """The press that `byte` completes: NOTHING for one that means nothing, None while there is none yet."""
        if byte == _SPACE:
            self._within = _Within.NOTHING
            return Key.STOP
        if byte == _ESC:
            self._within = _Within.ESCAPE
            return None
        match self._within:
            case _Within.NOTHING:
                return Key.NOTHING if self._pasting else _PLAIN.get(byte, Key.NOTHING)
            case _Within.ESCAPE:
                return self._escape(byte)
            case _Within.CONTROL:
                return self._control(byte)
            case _Within.STRING:
                self._within = _Within.NOTHING if byte == _BEL else _Within.STRING
                return None
            case _Within.MOUSE:
                self._skip -= 1
                self._within = _Within.MOUSE if self._skip else _Within.NOTHING
                return None

    def _escape(self, byte: int) -> Key | None:
        self._parameters = b""
        if byte in b"[O":
            self._within = _Within.CONTROL
            return None
        if byte in b"]PX^_":
            self._within = _Within.STRING
            return None
        self._within = _Within.NOTHING
        return Key.NOTHING  # Alt and a key

    def _control(self, byte: int) -> Key | None:
        if 0x20 <= byte < 0x40:
            self._parameters += bytes((byte,))
            return None
        self._within = _Within.NOTHING
        if byte == ord("M") and not self._parameters:
            self._within, self._skip = _Within.MOUSE, _MOUSE_BYTES
            return None
        if byte == ord("~") and self._parameters in (_PASTE_BEGINS, _PASTE_ENDS):
            self._pasting = self._parameters == _PASTE_BEGINS
            return Key.NOTHING
        if self._parameters or self._pasting:
            return Key.NOTHING  # Ctrl, Alt or Shift and an arrow, or a key that means nothing here
        return _ARROWS.get(byte, Key.NOTHING)


class StopHold:
    """Whether the space bar is held: a held key repeats. Times are monotonic, s."""

    def __init__(self) -> None:
        self._last = self._begun = self._repeats_since = -math.inf

    def on_stop(self, now: float) -> bool:
        """Take a press or a repeat. Return whether the key has been held long enough."""
        gap = now - self._last
        if gap > _REPEATS:
            self._begun = self._last if gap <= _DELAY else now
            self._repeats_since = now
        self._last = now
        return now - self._begun >= HELD and now - self._repeats_since >= _SURELY
