"""Looks at the robot's camera, and hears its ticks: python looker.py ROBOT CAMERA NETWORK SECONDS.

It listens for SECONDS without looking and SECONDS looking, and prints what came of both, as JSON. NETWORK: fields of
the table `[network]`. The lab is one machine: its one CLOCK_BOOTTIME tells how old a tick is.
"""

import sys
import time
from collections import defaultdict

import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node import robot_now_ns
from giraff_node.network.session import open_session
from giraff_node.network.tcp_options import set_tcp_options
from giraff_node.picture_client import PictureClient
from giraff_schemas.camera import Picture
from giraff_schemas.codec import decode
from giraff_schemas.topics import TICK, key_of


class Came(msgspec.Struct):
    """What has come by the end."""

    ticks: dict[str, list[float]]
    """Ages, s; by whether it looked."""
    looks_at: float
    """s of CLOCK_MONOTONIC at which it begins to look."""
    pictures: list[float]
    """Ages, s."""
    bytes: list[int]
    trouble: str


def main(robot: str, camera: str, network: str, seconds: str) -> None:
    config = msgspec.json.decode(network, type=NetworkConfig)
    came = Came(ticks=defaultdict(list), looks_at=0.0, pictures=[], bytes=[], trouble="")
    mode = ""

    def on_tick(sample: zenoh.Sample) -> None:
        tick = decode(TICK, str(sample.key_expr), sample.payload.to_bytes())
        if mode:
            came.ticks[mode].append((robot_now_ns() - tick.robot_ns) * 1e-9)

    with open_session(config, robot, "outside") as session:
        _subscriber = session.declare_subscriber(key_of(robot, TICK), on_tick)
        time.sleep(2.0)  # the links come about
        set_tcp_options()
        mode = "alone"
        time.sleep(float(seconds))
        mode, came.looks_at = "", time.monotonic()
        client = PictureClient(config, robot, camera, "looker")
        _look(client, 2.0, came=None)
        mode = "looking"
        _look(client, float(seconds), came)
        mode = ""
        client.close()
    print(msgspec.json.encode(came).decode(), flush=True)


def _look(client: PictureClient, seconds: float, came: Came | None) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        picture = client.ask()
        if picture is not None and came is not None:
            came.pictures.append(_age(picture))
            came.bytes.append(len(picture.jpeg))
        time.sleep(0.002)
    if came is not None:
        came.trouble = str(client.trouble)


def _age(picture: Picture) -> float:
    return -1.0 if picture.tick is None else (robot_now_ns() - picture.tick.robot_ns) * 1e-9


if __name__ == "__main__":
    main(*sys.argv[1:])
