"""Runs on a machine of the lab and prints when each sample of a key arrived: python listener.py ROBOT KEY NETWORK.

NETWORK: fields of the table `[network]`, as JSON.

A line a sample, {"at": s, "age": s, "sample": {...}}. The lab is one machine: `at` is of its one CLOCK_MONOTONIC, and
its one wall clock tells the age.
"""

from __future__ import annotations

import json
import sys
import threading
import time

import msgpack
import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.session import open_session
from giraff_node.network.tcp_options import set_tcp_options


def main(robot: str, key: str, network: str) -> None:
    def on_sample(sample: zenoh.Sample) -> None:
        at = time.monotonic()
        said = msgpack.unpackb(sample.payload.to_bytes())
        age = time.time() - said["stamp_ns"] * 1e-9
        print(json.dumps({"at": at, "age": age, "sample": said}), flush=True)

    session = open_session(msgspec.json.decode(network, type=NetworkConfig), robot, "outside")
    with session, session.declare_subscriber(f"giraff/{robot}/{key}", on_sample):
        while not threading.Event().wait(0.5):
            set_tcp_options()


if __name__ == "__main__":
    main(*sys.argv[1:])
