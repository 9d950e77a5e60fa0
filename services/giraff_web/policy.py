"""Which page's hand drives, and what it asks. No I/O and no clock: time is an argument."""

from __future__ import annotations

from typing import Final, NamedTuple

from giraff_core.operator import ASKING, Operator
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import DriveCommand, Lease, RobotTime, Tick
from giraff_web.config import WebConfig
from giraff_web.hand import Hand
from giraff_web.messages import LetGo, Wish

_STOPPING: Final = "STOP was asked for on a page, and base has not yet confirmed the emergency stop"
_ENDED: Final = "the web service has ended; start it again"


class _Page(NamedTuple):
    device: str
    may_drive: bool
    hand: Hand


class Driver(NamedTuple):
    """Whose hand counts."""

    page: int
    """0: nobody's."""
    device: str


NOBODY: Final = Driver(0, "")


class WebPolicy:
    """All pages as one operator, of which one hand at a time drives. Times are seconds of any one monotonic clock."""

    def __init__(self, config: WebConfig, robot: RobotConfig, instance: str) -> None:
        self.stopping = False
        """A stop was asked for here that base has not confirmed."""
        self.driver = NOBODY
        """Whose hand is the newest that counted."""
        self._config = config
        self._robot = robot
        # Nobody takes the robot by opening a page.
        self._operator = Operator(config.operator, instance, asks_from_start=False)
        self._pages: dict[int, _Page] = {}
        self._asker = 0  # the only page whose hand drives under the lease in force
        self._gone = ""
        self._tick: RobotTime | None = None

    @property
    def holds(self) -> bool:
        """Whether a page's hand holds the lease."""
        return self._operator.holds

    @property
    def holder(self) -> str:
        """Name of the operator that holds the lease; empty: none."""
        return self._operator.holder

    @property
    def refusal(self) -> str:
        """Why the robot does not obey these pages; empty when it does."""
        return self._operator.refusal

    @property
    def rank_notice(self) -> str:
        """Why persons take the robot from the pages, with the line to write; empty: its name is ranked."""
        return self._operator.rank_notice

    @property
    def newest(self) -> RobotTime | None:
        """The robot's clock; None: it was never heard."""
        return self._operator.tick

    def link_fault(self, now: float) -> str:
        """Why the robot counts as lost; empty: it is heard."""
        return self._operator.link_fault(now)

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock as it arrives."""
        self._operator.on_tick(tick, now)

    def on_lease(self, lease: Lease) -> None:
        """Take what the guard says of who drives."""
        self._operator.on_lease(lease)

    def on_opened(self, page: int, device: str, *, may_drive: bool) -> None:
        """A page is there."""
        self._pages[page] = _Page(device, may_drive, Hand(self._config, self._robot))

    def on_closed(self, page: int) -> None:
        """It is not any more. What it held is lost."""
        gone = self._pages.pop(page, None)
        if gone is not None and page == self.driver.page:
            self._gone = f"the page of {gone.device} is gone; open it again"
            self.driver = NOBODY

    def may_drive(self, page: int) -> bool:
        """Whether this page has shown a token."""
        return page in self._pages and self._pages[page].may_drive

    def device(self, page: int) -> str:
        """What people call it; empty: it is gone."""
        return self._pages[page].device if page in self._pages else ""

    def on_wish(self, page: int, wish: Wish, now: float) -> None:
        """Take what a page's hand asks."""
        if not self.may_drive(page):
            return
        hand = self._pages[page].hand
        held = hand.holds
        hand.on_wish(wish, self.newest, now)
        if hand.holds and not held:
            self._take_up(page, hand)

    def on_let_go(self, page: int, message: LetGo) -> None:
        """Take the end of a hold."""
        if self.may_drive(page):
            self._pages[page].hand.on_let_go(message)

    def on_stop(self, device: str) -> None:
        """A stop was asked for: no hand counts that holds on."""
        self.stopping = True
        for page in self._pages.values():
            page.hand.lose(f"STOP was asked for on the page of {device}")

    def lost(self) -> dict[int, str]:
        """By page, why what it holds does not count; empty: it does, or it holds nothing."""
        return {number: page.hand.lost for number, page in self._pages.items()}

    def command(self, now: float) -> DriveCommand:
        """What the newest hand asks, with its own tick however often it is repeated."""
        for page in self._pages.values():
            page.hand.look(now)
        driving = self._pages.get(self.driver.page)
        if driving is None or not (self.holds or driving.hand.holds):
            return self._without_a_hand()
        hand = driving.hand
        self._tick = hand.tick
        reason = (_STOPPING if self.stopping else "") or self.link_fault(now) or self._lost_by(driving, now)
        if reason:
            return self._operator.fault(reason, tick=hand.tick)
        asks = ASKING if hand.holds and not self.holds else hand.asks
        return self._operator.command(*asks, tick=hand.tick, wishes=hand.holds)

    def final_command(self) -> DriveCommand:
        """The last command of a service that ends: the robot need not wait for silence to stop."""
        return self._operator.fault(_ENDED, tick=self._tick)

    def _lost_by(self, page: _Page, now: float) -> str:
        if page.hand.lost:
            return f"{page.device}: {page.hand.lost}"
        if not page.hand.holds and page.hand.is_out_of_sight(now):
            return f"the page of {page.device} is out of sight; whoever touches a page drives"
        return ""

    def _without_a_hand(self) -> DriveCommand:
        """The end of a lease that a page has left behind; else nothing, which arms nothing and needs no hand."""
        if self.holds:
            return self._operator.fault(self._gone, tick=self._tick)
        return self._operator.command(0.0, 0.0, tick=self.newest, wishes=False)

    def _take_up(self, page: int, hand: Hand) -> None:
        driving = self._pages.get(self.driver.page)
        if driving is not None and self.driver.page != page and driving.hand.holds:
            hand.lose(f"{driving.device} drives by a page of its own; drive when it has let go")
            return
        if page != self._asker:
            self._asker = page
            self._operator.give_up()
        self._gone = ""
        self.driver = Driver(page, self._pages[page].device)
