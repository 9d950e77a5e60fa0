"""The runtime that each service runs on."""

import os

# Read once, when the first session opens: as many receiving threads as links that can die at one moment, because a dead
# link's close blocks its thread for up to 10 s and would freeze the healthy links that share it.
os.environ.setdefault("ZENOH_RUNTIME", "(rx: (worker_threads: 16))")

from giraff_core.inbox import Inbox
from giraff_core.timer import Timer
from giraff_node.node import Node, Publisher
from giraff_node.process import malloc
from giraff_node.process.clock import robot_now_ns

malloc.limit_heaps()

__all__ = ["Inbox", "Node", "Publisher", "Timer", "robot_now_ns"]
