"""Odometry: `wheels` to `odom`. Not in the chain that drives: losing it changes no motion."""

import time

from giraff_node import Node
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.frames import BASE_FRAME
from giraff_schemas.topics import ODOM, WHEELS

SILENCE = 1.0  # s without a sample that is worth a word
SETTLED = 1.0  # s without a notice after which it is over: one that flickers is told once


def main() -> None:
    with Node("odometry", OdometryConfig) as node:
        policy = OdometryPolicy(node.config, node.robot)
        node.frame(BASE_FRAME, policy.transform)
        node.on_reconfigured = policy.reconfigure
        wheels = node.inbox(WHEELS)
        out = node.publisher(ODOM)
        heard = noticed = time.monotonic()
        for now in node.turns():
            for sample in wheels.take():
                heard = now
                odometry = policy.on_wheels(sample)
                if odometry is not None:
                    out.put(odometry)
                if policy.notice:
                    noticed = now
                    node.set_notice("counters", policy.notice)
            if now - noticed > SETTLED:
                node.set_notice("counters", "")
            silence = "no wheels from base; check that base runs and sees its board" if now - heard > SILENCE else ""
            node.set_notice("wheels", silence)
