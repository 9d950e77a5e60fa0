"""A phone as the joystick: its DeviceMotion readings to speed and turn. No I/O and no clock.

A browser rounds accelerations to 0.1 m/s² and gives 10 to 200 a second (W3C Device Orientation and Motion, "Data
minimization"). So a frozen sensor and a phone that lies on a table look like a steady hand: the finger on the screen
stands for the hand instead.
"""

import math
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_core.tilt.clutch import BOUNCE, Clutch, Vector, Words
from giraff_core.tilt.curves import CurveConfig, asked
from giraff_core.tilt.disturbance import Disturbance
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.messages import PageWish, Reading

SILENCE: Final = 0.3
"""s without a reading, after which the phone's attitude is not known; three of a slow phone's."""

CLOSEST: Final = 0.003
"""s between two readings at least: no browser gives more, and time that hardly goes on would fill a memory."""

_WORDS: Final = Words(
    "the finger came down",
    "phone",
    "lift the finger, hold the phone level and still, and put the finger down again",
)
_SILENT: Final = Trouble(
    f"the phone's motion sensor has said nothing for {SILENCE:g} s",
    "lift the finger and put it down again, or choose the touch pad",
)
_TOO_SOON: Final = Trouble(
    "the finger was lifted for too short a time", "lift it, hold the phone level, and put it down again"
)


class PhoneTilt:
    """One phone. The touch is the clutch: nothing is asked while there is none, and where it begins is the zero.

    Times of readings are the page's, `now` is this host's; s.
    """

    def __init__(self, config: CurveConfig, robot: RobotConfig) -> None:
        self._config = config
        self._robot = robot
        self._hold = 0
        self._angle = 0
        self._sign = 1.0
        self._at = -math.inf
        self._heard = -math.inf
        self._lifted: float | None = None
        self._asks = (0.0, 0.0)
        self._trouble = NO_TROUBLE
        self._forget()

    def on_wish(self, wish: PageWish, now: float) -> tuple[float, float]:
        """m/s and rad/s that are asked for by what this wish brings. `fault` says whether they count."""
        if wish.angle != self._angle:
            self._angle = wish.angle
            self._forget()
        if wish.hold != self._hold:
            self._begin(wish.hold)
        for reading in wish.readings:
            self._read(reading, now)
        return (0.0, 0.0) if self._clutch.engaged else self._asks

    def fault(self, now: float) -> Trouble:
        """Why the hand is lost; NO_TROUBLE: it is not."""
        return self._trouble or (_SILENT if now - self._heard > SILENCE else NO_TROUBLE)

    def _begin(self, hold: int) -> None:
        self._hold, self._asks = hold, (0.0, 0.0)
        self._trouble = NO_TROUBLE if not hold or self._is_lifted else _TOO_SOON
        self._lifted = None

    @property
    def _is_lifted(self) -> bool:
        return self._lifted is not None and self._at - self._lifted >= BOUNCE

    def _read(self, reading: Reading, now: float) -> None:
        at, *axes = reading
        if at - self._at < CLOSEST:
            return  # read already, or too soon
        if at - self._at > SILENCE:
            self._forget()
        self._at, self._heard = at, now
        if not self._hold:
            self._lifted = at if self._lifted is None else self._lifted
        vector = self._in_screen(axes[0], axes[1], axes[2])
        self._clutch.on_reading(vector, at, pressed=not self._hold)
        self._asks = asked(self._clutch.relative(vector), self._config, self._robot)
        if trouble := self._disturbance.judge(vector, at) or self._clutch.refusal:
            self._trouble = trouble if self._hold else NO_TROUBLE

    def _in_screen(self, x: float, y: float, z: float) -> Vector:
        """Forward, left and up of the screen as it is read, as the joystick's axes: forward grows when it dips there.

        A phone that lies face up reads +9.8 on its z axis by the standard, and -9.8 in WebKit. A finger is on a screen
        that faces up, so the sign is learned while there is none.
        """
        if not self._hold:
            self._sign = -1.0 if z < 0.0 else 1.0
        x, y, z = self._sign * x, self._sign * y, self._sign * z
        turn = math.radians(self._angle)
        right = math.cos(turn) * x - math.sin(turn) * y
        up = math.sin(turn) * x + math.cos(turn) * y
        return -up, right, z

    def _forget(self) -> None:
        """What was read says nothing about what comes."""
        self._clutch, self._disturbance = Clutch(_WORDS), Disturbance("phone")
        self._lifted = None
        self._asks = (0.0, 0.0)
        if self._hold:
            self._trouble = _SILENT
