"""Who may drive: one-time tokens, the sessions they begin, and how guessing is slowed. No I/O, no clock and no chance.

A token is used once: who reads the address off a screen or out of a chat afterwards is refused, and told by whom it was
used. What a browser holds from then on is a cookie; only its digest is kept here.
"""

import hashlib
import hmac
import math
from collections import OrderedDict, deque
from collections.abc import Callable
from typing import Final, NamedTuple

MOST_SESSIONS: Final = 16
SESSION_LIFE: Final = 12 * 3600.0
"""s."""
_USED_KEPT: Final = 64
"""Tokens whose user can still be named."""
_MOST_WRONG: Final = 5
_WITHIN: Final = 60.0  # s
_MOST_ADDRESSES: Final = 1024
"""That are remembered for their guesses."""
_TELL_EVERY: Final = 1.0  # s
_LONGEST: Final = 256
"""Characters of anything that can be a token or a cookie."""

WRONG: Final = "not a token of this service; open the address that the page service shows now"


class Granted(NamedTuple):
    """A session has begun."""

    cookie: str


class Denied(NamedTuple):
    """No session."""

    why: str
    """For people, with the way out."""
    wait: float = 0.0
    """s until another try counts; 0: it was not slowed."""
    tell: bool = False
    """It is to be logged: not each one of a flood is."""


class _Session(NamedTuple):
    digest: bytes
    device: str
    began: float


class _Used(NamedTuple):
    device: str
    at: float


class Guesses:
    """Wrong tokens of late, by address. Flat: the address that was silent longest is forgotten first."""

    def __init__(self) -> None:
        self._wrong: OrderedDict[str, deque[float]] = OrderedDict()
        self._told: OrderedDict[str, float] = OrderedDict()

    def wait(self, address: str, now: float) -> float:
        """s until this address may try again; 0: it may."""
        times = self._wrong.get(address)
        if times is None or len(times) < _MOST_WRONG:
            return 0.0
        return max(0.0, times[0] + _WITHIN - now)

    def wrong(self, address: str, now: float) -> None:
        self._wrong.setdefault(address, deque(maxlen=_MOST_WRONG)).append(now)
        _keep_newest(self._wrong, address)

    def tells(self, address: str, now: float) -> bool:
        """Whether a line is to be logged of it."""
        if now - self._told.get(address, -math.inf) < _TELL_EVERY:
            return False
        self._told[address] = now
        _keep_newest(self._told, address)
        return True


class Sessions:
    """One token is open at a time. `draw`: at least 128 random bits as text for an address, another each time."""

    def __init__(self, draw: Callable[[], str]) -> None:
        self._draw = draw
        self._used: OrderedDict[bytes, _Used] = OrderedDict()
        self._sessions: OrderedDict[bytes, _Session] = OrderedDict()  # that was used last at the end
        self._guesses = Guesses()
        self.token = draw()
        """The open one."""

    def redeem(self, token: str, device: str, address: str, now: float) -> Granted | Denied:
        """Begin a session by the open token, which is then another. `now`: monotonic, s."""
        if wait := self._guesses.wait(address, now):
            why = f"too many wrong tokens from {address}; wait {math.ceil(wait)} s and open the address anew"
            return Denied(why, wait, self._guesses.tells(address, now))
        if used := self._used.get(_digest(token)):
            ago = _ago(now - used.at)
            why = f"this address was used {ago} by {used.device}; open the one that the page service shows now"
            return Denied(why, tell=self._guesses.tells(address, now))
        if len(token) > _LONGEST or not hmac.compare_digest(_digest(token), _digest(self.token)):
            self._guesses.wrong(address, now)
            return Denied(WRONG, tell=self._guesses.tells(address, now))
        self._used[_digest(token)] = _Used(device, now)
        if len(self._used) > _USED_KEPT:
            self._used.popitem(last=False)
        self.token = self._draw()
        cookie = self._draw()
        self._sessions[_digest(cookie)] = _Session(_digest(cookie), device, now)
        if len(self._sessions) > MOST_SESSIONS:
            self._sessions.popitem(last=False)
        return Granted(cookie)

    def device(self, cookie: str, now: float) -> str:
        """Whose session it is, which is thereby used; empty: none that lasts."""
        if not cookie or len(cookie) > _LONGEST:
            return ""
        digest = _digest(cookie)
        found = [each for each in self._sessions.values() if hmac.compare_digest(each.digest, digest)]
        if not found:
            return ""
        if now - found[0].began >= SESSION_LIFE:
            del self._sessions[digest]
            return ""
        self._sessions.move_to_end(digest)
        return found[0].device

    def end(self, cookie: str) -> None:
        """Take the right to drive away: its device needs the open token to begin another session."""
        self._sessions.pop(_digest(cookie), None)


def _digest(text: str) -> bytes:
    return hashlib.sha256(text[: _LONGEST + 1].encode(errors="replace")).digest()


def _keep_newest(kept: OrderedDict[str, deque[float]] | OrderedDict[str, float], address: str) -> None:
    kept.move_to_end(address)
    if len(kept) > _MOST_ADDRESSES:
        kept.popitem(last=False)


def _ago(seconds: float) -> str:
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if seconds >= size:
            return f"{int(seconds / size)} {unit} ago"
    return f"{int(seconds)} s ago"
