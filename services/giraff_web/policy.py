"""Which page's hand drives, and what it asks. No I/O and no clock: time is an argument."""

from typing import Final, NamedTuple

from giraff_core.operator import ASKING, Fault, Hand, Operator, Wish
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.config import WebConfig
from giraff_web.hand import PageHand
from giraff_web.messages import LetGo, PageWish

_STOPPING: Final = Trouble("STOP was asked for on a page, and base has not yet confirmed the emergency stop")


class _Page(NamedTuple):
    device: str
    may_drive: bool
    hand: PageHand


class Driver(NamedTuple):
    """Whose hand counts."""

    page: int
    """0: nobody's."""
    device: str


NOBODY: Final = Driver(0, "")


class WebPolicy(Hand):
    """All pages as one operator, of which one hand at a time drives. Times are seconds of any one monotonic clock."""

    def __init__(self, config: WebConfig, robot: RobotConfig, instance: str) -> None:
        # Nobody takes the robot by opening a page.
        super().__init__(Operator(config.operator, instance, asks_from_start=False))
        self.stopping = False
        """A stop was asked for here that base has not confirmed."""
        self.driver = NOBODY
        """Whose hand is the newest that counted."""
        self._config = config
        self._robot = robot
        self._pages: dict[int, _Page] = {}
        self._asker = 0  # the only page whose hand drives under the lease in force
        self._gone = NO_TROUBLE
        self._tick: RobotTime | None = None

    def on_opened(self, page: int, device: str, *, may_drive: bool) -> None:
        """A page is there."""
        self._pages[page] = _Page(device, may_drive, PageHand(self._config, self._robot))

    def on_closed(self, page: int) -> None:
        """It is not any more. What it held is lost."""
        gone = self._pages.pop(page, None)
        if gone is not None and page == self.driver.page:
            self._gone = Trouble(f"the page of {gone.device} is gone", "open it again")
            self.driver = NOBODY

    def may_drive(self, page: int) -> bool:
        """Whether this page has shown a token."""
        return page in self._pages and self._pages[page].may_drive

    def device(self, page: int) -> str:
        """What people call it; empty: it is gone."""
        return self._pages[page].device if page in self._pages else ""

    def on_wish(self, page: int, wish: PageWish, now: float) -> None:
        """Take what a page's hand asks."""
        if not self.may_drive(page):
            return
        hand = self._pages[page].hand
        held = hand.holds
        hand.on_wish(wish, self.operator.tick, now)
        if hand.holds and not held:
            self._take_up(page, hand)

    def on_let_go(self, page: int, message: LetGo) -> None:
        """Take the end of a hold."""
        if self.may_drive(page):
            self._pages[page].hand.on_let_go(message)

    def give_way(self) -> Trouble:
        """Let go of the lease, as a route wants it. Return whose hand drives by it, and what to do then."""
        driving = self._pages.get(self.driver.page)
        if driving is not None and driving.hand.holds:
            return Trouble(f"{driving.device} drives by a page of its own", "ask when it has let go")
        self.operator.give_up()
        self.driver = NOBODY
        return NO_TROUBLE

    def on_stop(self, device: str) -> None:
        """A stop was asked for: no hand counts that holds on."""
        self.stopping = True
        for page in self._pages.values():
            page.hand.lose(Trouble(f"STOP was asked for on the page of {device}"))

    def lost(self) -> dict[int, Trouble]:
        """By page, why what it holds does not count; NO_TROUBLE: it does, or it holds nothing."""
        return {number: page.hand.lost for number, page in self._pages.items()}

    def poll(self, now: float) -> Wish | Fault:
        """What the newest hand asks, with its own tick however often it is repeated."""
        for page in self._pages.values():
            page.hand.end_if_silent(now)
        driving = self._pages.get(self.driver.page)
        holds = self.operator.holds
        if driving is None or not (holds or driving.hand.holds):
            return self._without_a_hand()
        hand = driving.hand
        self._tick = hand.tick
        if stopped := _STOPPING if self.stopping else self.operator.fault(now) or _lost_by(driving, now):
            return Fault(stopped, hand.tick)
        asks = ASKING if hand.holds and not holds else hand.asks
        return Wish(*asks, hand.tick, takes=hand.holds)

    def _without_a_hand(self) -> Wish | Fault:
        """The end of a lease that a page has left behind; else nothing, which arms nothing and needs no hand."""
        if self.operator.holds:
            return Fault(self._gone, self._tick)
        return Wish(0.0, 0.0, self.operator.tick)

    def _take_up(self, page: int, hand: PageHand) -> None:
        driving = self._pages.get(self.driver.page)
        if driving is not None and self.driver.page != page and driving.hand.holds:
            hand.lose(Trouble(f"{driving.device} drives by a page of its own", "drive when it has let go"))
            return
        if page != self._asker:
            self._asker = page
            self.operator.give_up()
        self._gone = NO_TROUBLE
        self.driver = Driver(page, self._pages[page].device)


def _lost_by(page: _Page, now: float) -> Trouble:
    if page.hand.lost:
        return page.hand.lost.of(page.device)
    if not page.hand.holds and page.hand.is_out_of_sight(now):
        return Trouble(f"the page of {page.device} is out of sight", "whoever touches a page drives")
    return NO_TROUBLE
