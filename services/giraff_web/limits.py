"""What one page, one address and all together may take of this service. No I/O and no clock."""

from collections import deque
from typing import Final, NamedTuple

UNSEEN_AT_MOST: Final = 3
"""States that a page was sent and has not shown yet."""


class Allowance(NamedTuple):
    """How many of one kind there may be."""

    most: int
    """Of all addresses together."""
    of_one_address: int
    patience: float
    """s that each may take."""


class Limits(NamedTuple):
    """As they are; tests have shorter times."""

    bare: Allowance = Allowance(128, 32, 2.0)
    """TCP connections that have sent nothing yet, or plain HTTP. Each costs a socket."""
    handshakes: Allowance = Allowance(64, 24, 3.0)
    """TLS handshakes under way. Each costs some 0.3 MB."""
    connections: Allowance = Allowance(240, 60, 5.0)
    """Connections that have agreed on TLS. The patience is from one request to the next; a page has no such end."""
    stops: Allowance = Allowance(32, 4, 1.0)
    """Requests for a stop that wait for base's word of it. One that may not wait is answered at once."""
    drivers: int = 16
    """Pages with a session."""
    watchers_of_one_address: int = 8
    """Pages without a session. `[web] most_watchers` limits those of all addresses."""
    rate: float = 250.0
    """Messages a second of one page, and as many at once."""
    silent: float = 5.0
    """s after which a page that shows nothing of what it is sent is closed."""


class Rate:
    """How many messages may come."""

    def __init__(self, per_second: float, now: float) -> None:
        self._per_second = self._left = per_second
        self._at = now

    def admit(self, now: float) -> bool:
        """Whether one more may."""
        self._left = min(self._per_second, self._left + (now - self._at) * self._per_second)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class SendWindow:
    """Which states a page was sent and has not shown yet: so many that it gets no more, or for too long."""

    def __init__(self) -> None:
        self._unseen: deque[int] = deque()
        self._since = 0.0

    def allows(self) -> bool:
        """Whether it may be sent the newest state."""
        return len(self._unseen) < UNSEEN_AT_MOST

    def sent(self, n: int, now: float) -> None:
        if not self._unseen:
            self._since = now
        self._unseen.append(n)

    def seen(self, n: int, now: float) -> None:
        """The page has shown state `n`, and with it all that are older."""
        while self._unseen and self._unseen[0] <= n:
            self._unseen.popleft()
            self._since = now

    def waits(self, now: float) -> float:
        """s for which the page has shown nothing though it was sent something."""
        return now - self._since if self._unseen else 0.0
