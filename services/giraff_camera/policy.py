"""Who sees the picture, in which size, and when the next one is sent. No I/O and no clock.

Each of two sizes is a stream of its own, and its next picture goes when all who listen have confirmed the last one. So
one picture is under way at a time on each link, and a slow link slows those alone that listen to the same size.
"""

import math
from typing import Final

from giraff_schemas.camera import HOLD_ENDS, Asker, CameraHold, PictureSize
from giraff_schemas.text import brief

MOST_ON_THE_WAY: Final = 0.06
"""s that a picture takes of a link at most: ticks and commands wait for it."""
LATE: Final = 1.0
"""s without a confirmation after which nobody waits for an asker any longer."""
_JOINS: Final = 0.25
"""s that the first picture of a new size may take. The network may have sent it before it knew the asker."""
_EARLY: Final = 0.2
"""Share of a period by which a picture may be early: a camera's own pace is never quite even."""
MOST_ASKERS: Final = 20
_LONGEST_INSTANCE: Final = 64
_LONGEST_BY: Final = 100
"""Characters of a viewer's name that the state repeats. A state with too long names would reach nobody."""
LEAST_BYTES: Final = 1000
"""A smaller picture shows nothing."""
_FIRST_BYTES: Final = 4000
"""Bytes of the first picture on an unknown link."""
_FREE: Final = 0.7
"""Share of `MOST_ON_THE_WAY` that the large picture must fit into, before it is tried."""
_PROVEN: Final = 5
"""Pictures that must have come through before the large one is tried."""
_NEW: Final = 0.3
"""Weight of a new measurement."""
_STATES: Final = 64
"""States of the camera that are remembered, and ways there and back that count."""
_PICTURES: Final = 16
"""Pictures of a size that are remembered, to tell how long each was on its way."""


class _Asker:
    """One who looks, and what is known of its link."""

    def __init__(self, hold: CameraHold) -> None:
        self.hold = hold
        self.at = -math.inf
        """When the newest state was sent that it has answered: it was there then, or later."""
        self.size: PictureSize = "small"
        self.is_late = False
        self.waits_for = -1
        """`seq` of the picture that it has not confirmed yet; -1: none is waited for."""
        self.per_byte: float | None = None
        """s of its link that one byte takes."""
        self.transfer: float | None = None
        self.confirmed = 0
        self._delays: list[float] = []

    def on_state_back(self, delay: float) -> None:
        """A state of a few bytes, and the word that it has come, took so many s."""
        self._delays = [*self._delays[1 - _STATES :], delay]

    def on_confirmed(self, seq: int, delay: float, size: int) -> None:
        """So did a picture of so many bytes."""
        if seq >= self.waits_for:
            self.waits_for = -1
        self.is_late = delay >= LATE
        self.confirmed += 1
        if self._delays:
            self.transfer = max(0.0, delay - min(self._delays))
            measured = self.transfer / size
            self.per_byte = measured if self.per_byte is None else self.per_byte + _NEW * (measured - self.per_byte)


class _Stream:
    """The newest picture of one size."""

    def __init__(self) -> None:
        self.at = self.due_at = -math.inf
        self.pictures: dict[int, tuple[float, int]] = {}
        """The last pictures by `seq`: when each was sent, and its bytes."""
        self.rest_until = -math.inf
        """A link has as long a rest after a picture as this has taken."""


class PicturePolicy:
    """Decides for one start of one camera's process."""

    def __init__(self, camera: str, instance: str, rate: float, max_bytes: int) -> None:
        """`instance`: of this start. `rate`: Hz at most. `max_bytes`: bytes of a full picture at most."""
        self._camera, self._instance = camera, instance
        self._period, self._max_bytes = 1.0 / rate, max_bytes
        self._askers: dict[str, _Asker] = {}
        self._streams: dict[PictureSize, _Stream] = {"full": _Stream(), "small": _Stream()}
        self._states: dict[int, float] = {}
        self.full_bytes = max_bytes
        """Bytes of a full picture of the present view. They tell whether a link carries it."""

    @property
    def is_on(self) -> bool:
        """Somebody looks. The camera takes and sends pictures for no other reason."""
        return bool(self._askers)

    def on_state_sent(self, seq: int, now: float) -> None:
        """Remember a state of the camera: what answers it is new."""
        self._states[seq] = now
        if len(self._states) > _STATES:
            del self._states[next(iter(self._states))]

    def on_hold(self, hold: CameraHold, now: float) -> None:
        """Take somebody's word that he looks. A late one, and one to an earlier start of this process, is none."""
        sent = self._states.get(hold.state, -math.inf)
        if hold.camera != self._camera or hold.to != self._instance or now - sent > HOLD_ENDS:
            return
        if len(hold.instance) > _LONGEST_INSTANCE:
            return
        asker = self._askers.get(hold.instance)
        if asker is None:
            if len(self._askers) >= MOST_ASKERS:
                return
            asker = self._askers[hold.instance] = _Asker(hold)
        elif hold.seq <= asker.hold.seq:
            return
        if sent > asker.at:
            asker.on_state_back(now - sent)
        if hold.size != asker.hold.size:
            asker.waits_for = -1
        elif hold.seen > asker.hold.seen:
            self._on_seen(asker, hold, now)
        asker.hold, asker.at = hold, max(sent, asker.at)
        self._assign(asker)

    def update(self, now: float) -> None:
        """Forget who is gone, and wait no longer for who is late."""
        for instance in [each for each, asker in self._askers.items() if now - asker.at >= HOLD_ENDS]:
            del self._askers[instance]
        for asker in self._askers.values():
            waited = now - self._streams[asker.hold.size].at if asker.waits_for >= 0 else 0.0
            if asker.hold.seen < 0 and _JOINS <= waited < LATE:
                asker.waits_for = -1
            elif waited >= LATE:
                asker.is_late, asker.waits_for, asker.confirmed = True, -1, 0
                asker.size = "small"

    def due(self, now: float) -> dict[PictureSize, int]:
        """Return the sizes to send now, each with the bytes that its picture may have."""
        return {size: self._limit(size) for size in self._streams if self._is_due(size, now)}

    def sent(self, size: PictureSize, seq: int, length: int, now: float) -> None:
        """A picture of `length` bytes is on its way."""
        stream = self._streams[size]
        stream.at, stream.due_at = now, max(now, stream.due_at) + self._period
        stream.pictures[seq] = now, max(1, length)
        if len(stream.pictures) > _PICTURES:
            del stream.pictures[next(iter(stream.pictures))]
        for asker in self._listeners(size):
            asker.waits_for = seq

    def askers(self) -> tuple[Asker, ...]:
        """Who looks now."""
        return tuple(
            Asker(
                instance=instance,
                by=_name(asker.hold.by),
                size=asker.size,
                transfer=asker.transfer,
                is_late=asker.is_late,
            )
            for instance, asker in self._askers.items()
        )

    def _on_seen(self, asker: _Asker, hold: CameraHold, now: float) -> None:
        stream = self._streams[hold.size]
        if hold.seen not in stream.pictures:
            return
        sent, length = stream.pictures[hold.seen]
        asker.on_confirmed(hold.seen, now - sent, length)
        stream.rest_until = max(stream.rest_until, now + min(LATE, asker.transfer or 0.0))

    def _listeners(self, size: PictureSize) -> list[_Asker]:
        return [asker for asker in self._askers.values() if asker.hold.size == size]

    def _is_due(self, size: PictureSize, now: float) -> bool:
        stream, listeners = self._streams[size], self._listeners(size)
        return (
            bool(listeners)
            and now >= stream.due_at - _EARLY * self._period
            and now >= stream.rest_until
            and all(asker.waits_for < 0 for asker in listeners)
        )

    def _limit(self, size: PictureSize) -> int:
        if size == "full":
            return self._max_bytes
        known = [asker.per_byte for asker in self._listeners(size) if asker.per_byte is not None]
        fits = MOST_ON_THE_WAY / max(known) if known and max(known) > 0.0 else _FIRST_BYTES
        return int(min(self._max_bytes, max(LEAST_BYTES, fits)))

    def _assign(self, asker: _Asker) -> None:
        """Move an asker to the size that its link carries."""
        if asker.hold.largest == "small":
            asker.size = "small"
        elif asker.per_byte is not None:
            takes = asker.per_byte * self.full_bytes
            if takes > MOST_ON_THE_WAY:
                asker.size = "small"
            elif asker.confirmed >= _PROVEN and takes <= _FREE * MOST_ON_THE_WAY:
                asker.size = "full"


def _name(by: str) -> str:
    """Return a viewer's name as others are told it. Nobody looks without one."""
    return brief(by, _LONGEST_BY).strip() or "somebody without a name"
