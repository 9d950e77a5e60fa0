"""Runs on a machine of the lab and prints when each sample of a key arrived: python listener.py ROBOT KEY.

A line a sample, {"at": s, "age": s, "instance": "..."}. The lab is one machine: `at` is of its one CLOCK_MONOTONIC, and
its one wall clock tells the age.
"""

from __future__ import annotations

import json
import sys
import threading
import time

import msgpack
import zenoh

from giraff_node.session import NetworkConfig, open_session


def main(robot: str, key: str) -> None:
    def on_sample(sample: zenoh.Sample) -> None:
        at = time.monotonic()
        said = msgpack.unpackb(sample.payload.to_bytes())
        age = time.time() - said["stamp_ns"] * 1e-9
        print(json.dumps({"at": at, "age": age, "instance": said["instance"]}), flush=True)

    session = open_session(NetworkConfig(), robot, visiting=True)
    with session, session.declare_subscriber(f"giraff/{robot}/{key}", on_sample):
        threading.Event().wait()


if __name__ == "__main__":
    main(*sys.argv[1:])
