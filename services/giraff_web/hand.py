"""One page's hand: what its wishes ask, how old they are, and when it is lost. No I/O and no clock."""

import math
from typing import Final

from giraff_core.freshness import age
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.config import WebConfig
from giraff_web.messages import LetGo, Moment, PageWish, robot_time
from giraff_web.phone import PhoneTilt

SILENCE: Final = 0.3
"""s without a wish after which a hand that held is lost: a page makes one in each animation frame."""
OUT_OF_SIGHT: Final = 0.6
"""s without a wish of a page that holds nothing; it makes at least eight a second as long as it is seen."""
WISH_LASTS: Final = 0.4
"""s, by the robot's own ticks, after which a wish says nothing of now; as a key of the keyboard."""

_AGAIN: Final = "let go, then hold again"
_CHECK_LINK: Final = f"check the wireless network, {_AGAIN}"
_TOO_OLD: Final = Trouble("what the page says is too old", _CHECK_LINK)
_SILENT: Final = Trouble(f"nothing was heard of the page for {SILENCE:g} s", _CHECK_LINK)
_LOST: Final = {
    "cancelled": "the browser took the touch for itself",
    "hidden": "the page was hidden",
    "focus": "the page lost the focus",
    "turned": "the screen has turned",
    "idle": "neither finger, key, stick nor phone has moved for 1 s",
    "stalled": "the page stood still for a moment",
    "left": "the page was closed",
    "gamepad": "the gamepad is not heard, or no hand moves it",
}


class PageHand:
    """Feed it the page's messages in their order. Times are seconds of any one monotonic clock."""

    def __init__(self, config: WebConfig, robot: RobotConfig) -> None:
        self.holds = False
        """Something is held now, and it counts."""
        self.asks = (0.0, 0.0)
        """m/s and rad/s."""
        self.tick: RobotTime | None = None
        """Of the newest wish that counts, as the page gave it back: never a newer one."""
        self.lost = NO_TROUBLE
        """Why the page has lost the hand, until nothing is held any more; NO_TROUBLE: it has not."""
        self._share = min(1.0, config.slow_speed / robot.max_wheel_speed)
        self._robot = robot
        self._phone = PhoneTilt(config, robot)
        self._n = -1
        self._hold = 0  # the newest that was met
        self._input = ""
        self._heard = -math.inf

    def on_wish(self, wish: PageWish, newest: RobotTime | None, now: float) -> None:
        """`newest`: of the robot, as it is known here."""
        if wish.n <= self._n:
            return  # said before: a recorded one comes again
        self._n = wish.n
        self.end_if_silent(now)  # it may be this host that stood still
        tick = time_of(wish.tick)
        if newest is None or age(tick, newest) > WISH_LASTS or self._is_behind(tick):
            self.lose(_TOO_OLD)
            return
        self.tick, self._heard = tick, now
        by_phone = self._phone.on_wish(wish, now) if wish.input == "tilt" else None
        if not wish.hold:
            self._end(NO_TROUBLE)
            return
        asks = self._by_touch(wish) if by_phone is None else by_phone
        if wish.hold > self._hold:
            self._begin(wish, asks)
        if not self.holds or wish.hold != self._hold:
            return
        if wish.input != self._input:
            self.lose(Trouble("another input was chosen", _AGAIN))
        elif by_phone is not None and (fault := self._phone.fault(now)):
            self.lose(fault)
        else:
            self.asks = asks

    def on_let_go(self, message: LetGo) -> None:
        """The hold has ended, on purpose or not."""
        if message.n <= self._n:
            return
        self._n = message.n
        why = _LOST.get(message.why, "")
        self._end(Trouble(why, _AGAIN) if why and self.holds else NO_TROUBLE)

    def lose(self, why: Trouble) -> None:
        """Whatever is held now does not count any more."""
        if self.holds:
            self._end(why)

    def is_out_of_sight(self, now: float) -> bool:
        """Whether its page, which holds nothing, says nothing either: it is hidden, or put away."""
        return now - self._heard > OUT_OF_SIGHT

    def end_if_silent(self, now: float) -> None:
        """Find out whether it has gone silent."""
        if now - self._heard > SILENCE:
            self.lose(_SILENT)

    def _begin(self, wish: PageWish, asks: tuple[float, float]) -> None:
        self._hold, self._input = wish.hold, wish.input
        if asks == (0.0, 0.0):
            self.holds, self.lost = True, NO_TROUBLE
        else:
            self._end(Trouble("it moved before it was put down", _AGAIN))

    def _end(self, why: Trouble) -> None:
        self.holds, self.asks, self.lost = False, (0.0, 0.0), why

    def _by_touch(self, wish: PageWish) -> tuple[float, float]:
        robot = self._robot
        fastest_turn = min(robot.kinematics.fastest_spin, robot.max_angular_speed)
        linear, angular = wish.forward * robot.max_wheel_speed, wish.left * fastest_turn
        return robot.kinematics.within_limits(0.0 + self._share * linear, 0.0 + self._share * angular)

    def _is_behind(self, tick: RobotTime | None) -> bool:
        """Whether what this stands on is older than what came before it."""
        before = self.tick
        if before is None or tick is None:
            return False
        return tick.epoch == before.epoch and tick.robot_ns < before.robot_ns


def time_of(tick: Moment | None) -> RobotTime | None:
    """What a page gives back may be anything."""
    try:
        return robot_time(tick)
    except ValueError:
        return None
