"""The sentry: reads Zenoh's own log of what access control drops. A process of its own, so that nothing else is slowed.

It hears what operators and guard command, and takes nothing of it: it is there so that whoever commands without being
allowed to is refused here, too, and named.
"""

import os
import sys
import threading
from collections import deque
from collections.abc import Iterator

import zenoh

from giraff_core.live import Live
from giraff_node import Node, Timer
from giraff_schemas.topics import CMD_VEL, MOTION_HOLD, OPERATOR_CMD_VEL, PLACES_HOLD
from giraff_sentry.config import SentryConfig
from giraff_sentry.policy import FILTER, Refusals, told

_TELL_HZ = 2.0
_MOST = 20_000  # lines between two looks


class ZenohLog:
    """What Zenoh writes to this process's standard output, and nothing else does: the log of a node is on stderr."""

    def __init__(self) -> None:
        read_end, write_end = os.pipe()
        sys.stdout.flush()
        os.dup2(write_end, sys.stdout.fileno())
        os.close(write_end)
        self._lines: deque[str] = deque(maxlen=_MOST)
        # From the first line on: a pipe that is full would hold Zenoh's threads, and the session would never open.
        threading.Thread(target=self._read, args=(read_end,), name="zenoh-log", daemon=True).start()
        zenoh.init_log_from_env_or(FILTER)

    def lines(self) -> Iterator[str]:
        """What has come since the last call; of a flood the newest."""
        for _ in range(len(self._lines)):  # what comes meanwhile waits: a flood must not hold the loop
            yield self._lines.popleft()

    def _read(self, descriptor: int) -> None:
        with open(descriptor, encoding="utf-8", errors="replace") as log:
            self._lines.extend(log)


def main() -> None:
    log = ZenohLog()  # before the session, whose threads log
    with Node("sentry", SentryConfig) as node:
        live = Live(node.config)
        refusals = Refusals(live)
        node.on_reconfigured = live.replace
        # Whoever publishes on these keys without being allowed to sends it here, too, and Zenoh drops it at this door.
        node.subscribe(CMD_VEL, lambda _: None)
        node.subscribe(OPERATOR_CMD_VEL, lambda _: None)
        node.subscribe(MOTION_HOLD, lambda _: None)
        node.subscribe(PLACES_HOLD, lambda _: None)
        pace = Timer(_TELL_HZ)
        for now in node.turns(pace):
            if pace.due(now):
                for line in log.lines():
                    refusals.on_line(line)
                names = {str(link.zid): link.auth_identifier or "" for link in node.session.info.links()}
                for refusal, count in refusals.news(now):
                    node.log.warning("%s", told(refusal, count, names.get(refusal[0], "")))
