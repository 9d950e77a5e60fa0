"""A bare Zenoh process with the traffic of a service: python -m bench.traffic PLAN.

PLAN is JSON: `publish` has rows of key, Hz, bytes and whether it is control; `subscribe` has keys.
"""

import json
import os
import sys
import time
from typing import Any

import zenoh


def main(plan: dict[str, Any]) -> None:
    """Publish for ever, and hear without doing anything."""
    session = zenoh.open(zenoh.Config.from_json5(os.environ["BENCH_SESSION"]))
    heard = [
        session.declare_subscriber(f"giraff/bench/{key}", lambda sample: bytes(sample.payload))
        for key in plan["subscribe"]
    ]
    due = []
    began = time.monotonic()
    for key, hz, size, is_control in plan["publish"]:
        publisher = session.declare_publisher(
            f"giraff/bench/{key}",
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME if is_control else zenoh.Priority.DATA_HIGH,
            express=is_control,
        )
        due.append([began, 1.0 / hz, publisher, bytes(size)])
    while heard or due:
        now = time.monotonic()
        for row in due:
            if row[0] <= now:
                row[2].put(row[3])
                row[0] += row[1]
        time.sleep(max(0.0, min((row[0] for row in due), default=now + 1.0) - time.monotonic()))


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
