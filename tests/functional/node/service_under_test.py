"""A little service for test_node: says ticks, counts those it hears, and does as its role asks."""

import sys
import time
from pathlib import Path
from typing import Any, cast

import msgspec

from giraff_node import Node, Timer
from giraff_schemas.messages import Battery, Tick
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.topics import BATTERY, ESTOP_ENGAGE, ESTOP_RESET, TICK
from giraff_schemas.trouble import Trouble


class Config(msgspec.Struct, frozen=True):
    """Takes whatever the table holds."""


def main(role: str) -> None:
    with Node("base" if role == "talker" else "guard", Config) as node:
        pace = Timer(100.0)
        out = node.publisher(TICK)
        inbox, newest = node.inbox(TICK), node.inbox(TICK, limit=1)
        if role == "fragile":
            node.subscribe(BATTERY, break_down)
        requests, _ = node.requests(ESTOP_ENGAGE), node.requests(ESTOP_RESET)
        said = 0
        sequences: list[int] = []
        for now in node.turns(pace):
            if role == "talker" and pace.due(now):
                out.put(Tick(epoch=1, robot_ns=said))
                said += 1
            sequences += [tick.seq for tick in inbox.pop_all() if tick.instance != node.instance]
            if role == "listener" and len(sequences) >= 50:
                [last] = newest.pop_all()
                gapless = sequences == list(range(sequences[0], sequences[0] + len(sequences)))
                # Each subscriber is called in a thread of its own, which may be late. The oldest is the first of them.
                print(f"heard gapless={gapless} newest={last.seq >= sequences[len(sequences) // 2]}", flush=True)
                sequences.clear()
            for asked in requests.pop_all() if role == "talker" else ():
                reason = asked.request.reason.what
                asked.answer(EStopAnswer(done=reason != "refuse", engaged=True, id=said, reason=Trouble(reason)))
            for asked in requests.pop_all() if role == "sleepy" else ():
                print("hangs", flush=True)
                while not Path(asked.request.reason.what).exists():
                    time.sleep(0.01)
            if role == "broken":
                raise RuntimeError("the loop itself broke down")
        if role == "hanging":
            node.session = cast(Any, HangingSession(node.session))


class HangingSession:
    """A session whose end never comes, as Zenoh's own does now and then."""

    def __init__(self, session: object) -> None:
        self._session = session  # its own end, too, is left to the process's

    def close(self) -> None:
        time.sleep(600.0)


def break_down(battery: Battery) -> None:
    raise RuntimeError(f"{battery.voltage} V is too much for this test")


if __name__ == "__main__":
    main(sys.argv[1])
