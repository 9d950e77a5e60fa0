"""Runs on a machine of the lab and tries whatever it may not: python stranger.py ROBOT CONFIG drives|guards|listens.

CONFIG: Zenoh's, as JSON. It listens to everything, and drives, as guard, as each operator and as who holds a motion,
with the newest moment of the robot that it has heard; or as guard alone. Prints {"heard": samples of the robot,
"links": their other ends} again and again.
"""

import itertools
import json
import sys
import time
from typing import Final

import zenoh

from giraff_schemas.codec import decode, encode, stamped
from giraff_schemas.messages import DriveCommand, GuardedCommand, RobotTime
from giraff_schemas.motion import MotionHold
from giraff_schemas.topics import CMD_VEL, MOTION_HOLD, OPERATOR_CMD_VEL, PLACES_HOLD, TICK, key_of

_OPERATORS: Final = ("joystick", "keyboard", "motion")
_PERIOD: Final = 0.02  # s
_TELLS_EVERY: Final = 10  # periods
_INSTANCE: Final = "0123456789abcdef"


class Stranger:
    """What it has heard, and what it says."""

    def __init__(self, robot: str) -> None:
        self.heard = 0
        self._robot = robot
        self._tick = RobotTime(epoch=1, robot_ns=1_000_000_000)

    def on_sample(self, sample: zenoh.Sample) -> None:
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        if _INSTANCE.encode() in payload:  # Zenoh gives a session what it says itself
            return
        self.heard += 1
        if key == key_of(self._robot, TICK):
            self._tick = decode(TICK, key, payload).time

    def commands(self, seq: int) -> dict[str, bytes]:
        """By key."""
        guarded = GuardedCommand(
            linear_x=0.3,
            angular_z=0.0,
            guard_tick=self._tick,
            operator=_INSTANCE,
            lease_counter=1,
            operator_tick=self._tick,
            range_tick=None,
            source="hand",
            faults=0,
            hand_neutral=False,
        )
        says: dict[str, GuardedCommand | DriveCommand | MotionHold] = {
            CMD_VEL.key: guarded,
            **dict.fromkeys((MOTION_HOLD.key, PLACES_HOLD.key), MotionHold(id=1, tick=self._tick)),
        }
        for name in _OPERATORS:
            says[OPERATOR_CMD_VEL.at(name).key] = DriveCommand(
                operator=name,
                lease_counter=1,
                linear_x=0.3,
                angular_z=0.0,
                source="hand",
                tick=self._tick,
            )
        return {key: encode(stamped(command, seq, time.time_ns(), _INSTANCE)) for key, command in says.items()}


def main(robot: str, config: str, does: str) -> None:
    stranger = Stranger(robot)
    everything = f"giraff/{robot}/**"
    with (
        zenoh.open(zenoh.Config.from_json5(config)) as session,
        session.declare_subscriber(everything, stranger.on_sample),
    ):
        for seq in itertools.count():
            for key, payload in stranger.commands(seq).items():
                if does == "drives" or (does == "guards" and key == CMD_VEL.key):
                    session.put(f"giraff/{robot}/{key}", payload)
            if seq % _TELLS_EVERY == 0:
                links = sorted(link.dst for link in session.info.links())
                print(json.dumps({"heard": stranger.heard, "links": links}), flush=True)
            time.sleep(_PERIOD)


if __name__ == "__main__":
    main(*sys.argv[1:])
