"""What a service answers about itself."""

import msgspec

from giraff_schemas.format import SAME_VERSION
from giraff_schemas.trouble import Trouble


class WebPage(msgspec.Struct, frozen=True, kw_only=True):
    """Where giraff_web serves its page over HTTPS."""

    port: int
    hosts: tuple[str, ...]
    """Names and addresses at which other hosts reach it."""
    certificate: str
    """SHA-256 of its certificate in DER, in hexadecimal digits."""


class _Header(msgspec.Struct, frozen=True, kw_only=True):
    """Fields of an answer of any version."""

    service: str
    instance: str
    host: str
    version: str


class Health(msgspec.Struct, frozen=True, kw_only=True):
    """Answer of a service's health query. It judges the service: not its links, nor who drives."""

    service: str
    instance: str
    host: str
    pid: int
    uptime: float
    ok: bool
    """Nothing is wrong with the service itself: its process, its board, its disk."""
    faults: tuple[Trouble, ...]
    """Faults of the service itself, as of now."""
    notices: tuple[Trouble, ...] = ()
    """Conditions that the service waits for, or finds wrong elsewhere."""
    # The fields from here on are for a person who looks at a robot, or compares machines.
    publishes: tuple[str, ...] = ()
    """Keys of the topics table on which it speaks, whether or not it has said anything."""
    subscribes: tuple[str, ...] = ()
    """Keys that it listens to."""
    answers: tuple[str, ...] = ()
    """Keys of the queries that it answers."""
    cpu_time: float = 0.0
    """s that a processor has worked for it."""
    rss_bytes: int = 0
    """Memory that it has in use; 0: unknown."""
    version: str = ""
    """Of the program: its number, and a digest of what all services share."""
    stamp_ns: int = 0
    """Wall clock of its host when it answered, ns since 1970."""
    page: WebPage | None = None
    """Of giraff_web; None for every other service."""


def other_health(payload: bytes) -> Health | None:
    """Return who gave an answer that only another version reads whole. None: it is no answer about health."""
    try:
        told = msgspec.msgpack.decode(payload, type=_Header)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return None
    fault = Trouble(f"it is of version {told.version}", SAME_VERSION)
    return Health(**msgspec.structs.asdict(told), pid=0, uptime=0.0, ok=False, faults=(fault,))
