"""Runs on a machine of the lab and prints when each sample of a key arrived: python listener.py ROBOT KEY NETWORK.

NETWORK: fields of the table `[network]`, as JSON.

A line a sample, {"at": s, "age": s, "sample": {...}}. The lab is one machine: `at` is of its one CLOCK_MONOTONIC, and
its one wall clock tells the age.
"""

import json
import sys
import time

import msgpack
import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.link_repair import LinkRepair
from giraff_node.network.session import open_session


def main(robot: str, key: str, network: str) -> None:
    def on_sample(sample: zenoh.Sample) -> None:
        at = time.monotonic()
        said = msgpack.unpackb(sample.payload.to_bytes())
        age = time.time() - said["stamp_ns"] * 1e-9
        print(json.dumps({"at": at, "age": age, "sample": said}), flush=True)

    config = msgspec.json.decode(network, type=NetworkConfig)
    session = open_session(config, robot, "outside")
    repair = LinkRepair(session, config, robot, "outside")  # as each service that stays
    with session, session.declare_subscriber(f"giraff/{robot}/{key}", on_sample):
        while True:
            repair.update(time.monotonic())
            time.sleep(0.2)


if __name__ == "__main__":
    main(*sys.argv[1:])
