"""A page's hand for tests: wishes with ticks of a robot's clock that goes on."""

import math
from typing import Any

from giraff_core.robot import RobotConfig
from giraff_schemas.messages import RobotTime
from giraff_web.config import WebConfig
from giraff_web.hand import PageHand
from giraff_web.messages import LetGo, PageWish, Reading, moment
from tests.support.robots import ROBOT

EPOCH = 7
GRAVITY = 9.81


class Person:
    """Times are seconds; the robot's clock begins at 1 s."""

    def __init__(self, config: WebConfig | None = None, robot: RobotConfig = ROBOT) -> None:
        self.hand = PageHand(config or WebConfig(), robot)
        self.now = 0.0
        self.n = 0
        self.holds = 0
        self.hold = 0

    @property
    def tick(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=round((1.0 + self.now) * 1e9))

    def is_holding(self) -> bool:
        """What is held counts."""
        return self.hand.holds

    def wait(self, seconds: float) -> None:
        self.now += seconds
        self.hand.end_if_silent(self.now)

    def wish(self, after: float = 1 / 60, *, tick_age: float = 0.03, **fields: Any) -> None:
        """One wish, so much later, of a tick that was of that age then."""
        self.now += after
        self.n += 1
        tick = RobotTime(epoch=EPOCH, robot_ns=self.tick.robot_ns - round(tick_age * 1e9))
        given: dict[str, Any] = {"n": self.n, "tick": moment(tick), "hold": self.hold, "input": "pad"} | fields
        self.hand.on_wish(PageWish(**given), self.tick, self.now)

    def touch(self, **fields: Any) -> None:
        """A finger comes down."""
        self.holds += 1
        self.hold = self.holds
        self.wish(**fields)

    def let_go(self, why: Any = "finger") -> None:
        self.n += 1
        self.hold = 0
        self.hand.on_let_go(LetGo(n=self.n, why=why))


class PhonePerson(Person):
    """With a phone, whose browser reads it at a rate."""

    def __init__(self, hertz: float = 60.0, sign: float = 1.0, angle: int = 0, config: WebConfig | None = None) -> None:
        """`sign`: -1 where gravity is told as WebKit does; `angle`: of the screen in the device, degrees."""
        super().__init__(config)
        self.hertz, self.sign, self.angle = hertz, sign, angle
        self.read = 0

    def reading(self, forward: float, left: float) -> Reading:
        """Of a screen that dips so many degrees forward and left, as it is read in the device."""
        self.read += 1
        ahead = GRAVITY * math.sin(math.radians(forward))
        side = GRAVITY * math.sin(math.radians(left)) + 0.05 * math.sin(self.read)
        up = math.sqrt(max(0.0, GRAVITY**2 - ahead**2 - side**2))
        right_of_screen, up_of_screen = side, -ahead
        turn = math.radians(self.angle)
        x = math.cos(turn) * right_of_screen + math.sin(turn) * up_of_screen
        y = -math.sin(turn) * right_of_screen + math.cos(turn) * up_of_screen
        x, y, z = (round(self.sign * value, 1) for value in (x, y, up))
        return self.read / self.hertz, x, y, z

    def keep(self, seconds: float, forward: float = 0.0, left: float = 0.0) -> None:
        """Hold the phone so."""
        for _ in range(round(seconds * self.hertz)):
            self.wish(1 / self.hertz, input="tilt", angle=self.angle, readings=(self.reading(forward, left),))

    def put_down(self) -> None:
        """The finger, on the screen."""
        self.holds += 1
        self.hold = self.holds
