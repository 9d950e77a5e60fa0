"""Ask a robot's page for the emergency stop, beside Zenoh.

Whoever answers there is asked: a stop that is asked for too often does no harm. Only a page whose certificate a visit
has kept confirms one.
"""

import threading
import time
from collections.abc import Collection
from contextlib import closing
from typing import Final, NamedTuple
from urllib.parse import urlsplit

import msgspec

from giraff_cli.estop.client import OtherWay
from giraff_node.network.query_client import EStopClient
from giraff_schemas.text import printable
from giraff_tools.network.pages import kept_pages

_HEAD_START: Final = 0.5  # s that Zenoh has alone
_ATTEMPT: Final = 1.5  # s; the page waits up to 1 s for base's word
_ASK_AGAIN: Final = 0.2  # s
_MOST_PLACES: Final = 16
_LARGEST: Final = 65536  # bytes
_OK: Final = (200, 202)
_REFUSED: Final = 403


class Place(NamedTuple):
    """Where a page is reached."""

    host: str
    port: int

    def __str__(self) -> str:
        return printable(f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}")


def place_of(text: str) -> Place:
    """Read HOST:PORT, or the address as a browser shows it. Raises ValueError."""
    parts = urlsplit(text if "//" in text else f"//{text}")
    if not parts.hostname or not parts.port:
        raise ValueError(f"{text!r} is no address of a page; give HOST:PORT, like 192.168.1.20:8443")
    return Place(parts.hostname, parts.port)


class Answer(NamedTuple):
    """What a page has answered."""

    certificate: str
    """SHA-256 of it in DER, in hexadecimal digits."""
    robot: str
    """The robot that it says it serves."""
    status: int
    """Of HTTP."""
    body: bytes


class _EStop(msgspec.Struct):
    engaged: bool
    off: bool


class _Body(msgspec.Struct):
    estop: _EStop | None = None
    why: str = ""


def doubt_of(answer: Answer, robot: str, known: Collection[str]) -> str:
    """Return why the answer does not prove that this robot has stopped; empty: it does. `known`: certificates."""
    body = _body(answer)
    if answer.status not in _OK:
        return f"it refuses with HTTP status {answer.status}: {body.why or 'no reason given'}"
    if not known:
        return f"its certificate is not known here: see it once with `giraff watch --robot {robot or 'NAME'}`"
    if answer.certificate not in known:
        return (
            "its certificate is another than the one that was kept: a stranger may answer; where the page has got a "
            f"new one, see it once with `giraff watch --robot {robot}`"
        )
    if answer.robot != robot:
        return f"it serves {answer.robot or 'a robot that it does not name'}"
    if body.estop is None or not body.estop.engaged:
        return "base has not told it that it has stopped"
    return ""


def _body(answer: Answer) -> _Body:
    try:
        return msgspec.json.decode(answer.body, type=_Body)
    except (ValueError, RecursionError):  # msgspec's errors are ValueErrors
        return _Body()


def ask(place: Place, *, off: bool = False) -> Answer:
    """Ask once, for off or for a plain stop. Raises OSError, HTTPException, ValueError."""
    import hashlib  # noqa: PLC0415  a stop over Zenoh, which has a head start, is not to wait for these
    import ssl  # noqa: PLC0415
    from http.client import HTTPSConnection  # noqa: PLC0415

    path = "/stop?off" if off else "/stop"
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False  # no authority stands for it: who it is, its certificate itself tells
    context.verify_mode = ssl.CERT_NONE
    with closing(HTTPSConnection(place.host, place.port, timeout=_ATTEMPT, context=context)) as connection:
        connection.connect()
        assert isinstance(connection.sock, ssl.SSLSocket)  # noqa: S101  for the type checkers
        certificate = hashlib.sha256(connection.sock.getpeercert(binary_form=True) or b"").hexdigest()
        peer = Place(*connection.sock.getpeername()[:2])
        answer = None
        for at in dict.fromkeys((place, peer)):  # off is refused under a name that the page does not know
            connection.request("POST", path, headers={"Host": str(at), "User-Agent": "giraff estop"})
            response = connection.getresponse()
            robot = response.headers.get("Giraff-Robot", "")
            answer = Answer(certificate, robot, response.status, response.read(_LARGEST))
            if response.status != _REFUSED:
                break
    assert answer is not None  # noqa: S101  at least one place was tried
    return answer


class PageStop(OtherWay):
    """Asks the pages of one robot again and again, each address in a thread of its own.

    An address that swallows packets, and a name that takes long to be found, hold up no other.
    """

    def __init__(
        self,
        robot: str,
        given: Place | None,
        timeout: float,
        doubt: str = "",
        connect: Collection[str] = (),
        *,
        off: bool = False,
    ) -> None:
        """`robot`: empty: nobody has named one. `given`: asked at once, in the place of the pages that were kept.

        `timeout`: s in which a stop is to be confirmed. `doubt`: why no answer counts; empty: it may. `connect`: hosts
        at which somebody takes the robot to be: a page of another host may be that of another robot of this name.
        """
        self.robot = robot
        self._given = given
        self._doubt = doubt
        self._connect = {*connect}
        self._head_start = 0.0 if given else min(_HEAD_START, 0.5 * timeout)
        self._until = time.monotonic() + max(timeout, self._head_start + _ATTEMPT)
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._confirmed: Place | None = None
        self._off = off
        self.is_off = False
        """Whether the page that has confirmed tells that the stop is off."""
        self._is_needed = True
        self._doubts: dict[Place, str] = {}
        self._silent: dict[Place, str] = {}
        self._asking: list[EStopClient] = []
        threading.Thread(target=self._start, name="page", daemon=True).start()

    def watch(self, robot: str, asking: EStopClient) -> None:
        if robot == self.robot:
            self._asking.append(asking)

    @property
    def confirmed(self) -> str:
        """Return where a page has confirmed, and no base says otherwise; empty: so far none has."""
        contradicted = any(asking.unconfirmed or asking.refusal is not None for asking in self._asking)
        return "" if self._confirmed is None or contradicted or len(self._asking) > 1 else str(self._confirmed)

    def end(self, robot: str) -> None:
        if robot == self.robot:
            with self._lock:
                self._is_needed = False
                self._over.set()

    def stopped(self) -> set[str]:
        self._over.wait(max(0.0, self._until - time.monotonic()))
        return {self.robot} if self.confirmed else set()

    @property
    def unconfirmed(self) -> str:
        """Return what came of asking; empty: no page was asked, or one of the ways has confirmed."""
        if not self._is_needed:
            return ""
        whose = f"the page of {self.robot}" if self.robot else "the page"
        for place, why in [each for each in self._doubts.items() if each[1]]:
            return printable(f"asked {whose} at {place}, NOT CONFIRMED: {why}")
        for place, why in list(self._silent.items()):
            return printable(f"{whose} at {place} does not answer: {why}")
        return ""

    def _start(self) -> None:
        kept = kept_pages(self.robot) if self.robot else ()
        if not self._given and self._connect and not any(self._connect & {*page.hosts} for page in kept):
            self._doubt = self._doubt or "it is not at the address of --connect, and may be of another robot"
        known = {page.certificate for page in kept}
        places = [self._given] if self._given else [Place(host, page.port) for page in kept for host in page.hosts]
        if not places:
            self._over.set()
        self._over.wait(self._head_start)
        for place in dict.fromkeys(places[:_MOST_PLACES]):
            threading.Thread(target=self._ask_on, args=(place, known), name="page", daemon=True).start()

    def _ask_on(self, place: Place, known: Collection[str]) -> None:
        while not self._over.is_set():
            try:
                answer = ask(place, off=self._off)
                doubt = doubt_of(answer, self.robot, known)
            except Exception as error:  # noqa: BLE001  whatever answers there, the next attempt may be better
                self._silent[place] = str(error) or type(error).__name__
            else:
                self._doubts[place] = doubt or self._doubt
                if not doubt:
                    self._confirm(place, answer)
            self._over.wait(_ASK_AGAIN)

    def _confirm(self, place: Place, answer: Answer) -> None:
        """End the asking: base has stopped, by the word of a page that is known."""
        with self._lock:
            if not (self._over.is_set() or self._doubt):
                estop = _body(answer).estop
                self.is_off = estop is not None and estop.off
                self._confirmed = place
            self._over.set()
