"""Runs on a machine of the lab and speaks for a dead service: python impostor.py ROBOT CONFIG ...

CONFIG: Zenoh's, as JSON, of one session each; all say the same. Each line of its standard input is the name of a
service; from then on it says what that one would say to move the robot, at moments of the robot that it has heard or
goes on counting; an empty line ends that. Prints a line of `Said` again and again.
"""

import itertools
import json
import secrets
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any, Final

import zenoh

from giraff_schemas.codec import DecodeError, decode, encode, encoding_of, stamped
from giraff_schemas.messages import GuardedCommand, Range, RobotTime, Sample, Tick, Wheels
from giraff_schemas.topics import CMD_VEL, RANGE, TICK, WHEELS, Topic, key_of

_PERIOD: Final = 0.02  # s
_TELLS_EVERY: Final = 10  # periods
_LEVEL: Final = 1.0  # s that a made-up hand is level, which arms
_SPEED: Final = 0.3  # m/s
_AWAY: Final = 1.5  # m


class Impostor:
    """What it has heard, and what it says."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.says = ""
        self.since = time.monotonic()
        self.heard: dict[str, int] = {}
        self._tick, self._tick_at = RobotTime(epoch=1, robot_ns=1_000_000_000), time.monotonic()
        self._wheels: Wheels | None = None
        self._instance = secrets.token_hex(8)

    def on_sample(self, sample: zenoh.Sample) -> None:
        key, payload = str(sample.key_expr).removeprefix(f"giraff/{self.robot}/"), sample.payload.to_bytes()
        if self._instance.encode() in payload:  # Zenoh gives a session what it says itself
            return
        self.heard[key] = self.heard.get(key, 0) + 1
        try:
            if key == TICK.key:
                self._tick, self._tick_at = decode(TICK, key, payload).time, time.monotonic()
            if key == WHEELS.key:
                self._wheels = decode(WHEELS, key, payload)
        except DecodeError:
            return

    def samples(self, seq: int) -> Iterator[tuple[str, bytes, str]]:
        """Key, payload and encoding of what it says now."""
        now = time.monotonic()
        tick = RobotTime(epoch=self._tick.epoch, robot_ns=self._tick.robot_ns + int((now - self._tick_at) * 1e9))
        said: list[tuple[Topic[Any], Sample]] = []
        if self.says == "guard":
            speed = _SPEED if now - self.since > _LEVEL else 0.0
            said.append((CMD_VEL, self._command(tick, speed)))
        if self.says == "ranger":
            names = sorted(key.rpartition("/")[2] for key in self.heard if key.startswith("range/"))
            name = names[seq // 3 % len(names)]
            if seq % 3 == 0:
                echo = Range(sensor=name, state="echo", range=_AWAY, echo_us=int(2e6 * _AWAY / 343), tick=tick)
                said.append((RANGE.at(name), echo))
        if self.says == "base" and self._wheels is not None:
            said.append((TICK, Tick(epoch=tick.epoch, robot_ns=tick.robot_ns)))
            said.append((WHEELS, self._wheels))
            said.append((CMD_VEL, self._command(tick, _SPEED)))
        for topic, sample in said:
            yield (
                key_of(self.robot, topic),
                encode(stamped(sample, seq, time.time_ns(), self._instance)),
                encoding_of(topic.schema),
            )

    def _command(self, tick: RobotTime, speed: float) -> GuardedCommand:
        return GuardedCommand(
            linear_x=speed,
            angular_z=0.0,
            guard_tick=tick,
            operator=self._instance,
            lease_counter=1,
            operator_tick=tick,
            range_tick=None,
            source="hand",
            faults=0,
            hand_neutral=speed == 0.0,
        )


def main(robot: str, *configs: str) -> None:
    impostor = Impostor(robot)

    def obey() -> None:
        for line in sys.stdin:
            impostor.since = time.monotonic()
            impostor.says = line.strip()

    threading.Thread(target=obey, daemon=True).start()
    sessions = [zenoh.open(zenoh.Config.from_json5(config)) for config in configs]
    declared = [session.declare_subscriber(f"giraff/{robot}/**", impostor.on_sample) for session in sessions]
    said = 0
    for seq in itertools.count():
        for key, payload, encoding in impostor.samples(seq):
            for session in sessions:
                session.put(key, payload, encoding=encoding, congestion_control=zenoh.CongestionControl.DROP)
            said += 1
        if seq % _TELLS_EVERY == 0:
            links = [len(session.info.links()) for session in sessions]
            print(json.dumps({"heard": impostor.heard, "said": said, "links": links}), flush=True)
        time.sleep(_PERIOD)
    del declared


if __name__ == "__main__":
    main(*sys.argv[1:])
