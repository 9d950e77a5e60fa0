"""Runs on a machine of the lab: sends bulk data in a session of its own until its power is off, or counts what comes.

python bulk.py send|count ROBOT. A camera's or a recording's kind of stream: large samples of the lowest priority, as
fast as they go. `count` prints the bytes that have come, once a second.
"""

import sys
import threading
import time
from typing import Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.session import open_session

_SAMPLE: Final = bytes(64_000)
_PERIOD: Final = 0.005  # s: 100 Mbit/s, ten times what the cable carries


def main(does: str, robot: str) -> None:
    key = f"giraff/{robot}/bulk"
    session = open_session(NetworkConfig(), robot, "client")
    if does == "send":
        publisher = session.declare_publisher(
            key, congestion_control=zenoh.CongestionControl.DROP, priority=zenoh.Priority.BACKGROUND
        )
        while True:
            publisher.put(_SAMPLE)
            time.sleep(_PERIOD)
    come = 0

    def count(sample: zenoh.Sample) -> None:
        nonlocal come
        come += len(sample.payload)

    with session.declare_subscriber(key, count):
        while not threading.Event().wait(1.0):
            print(come, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
