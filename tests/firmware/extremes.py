"""Drives a base board with the most extreme settings, speeds and wheels; run in a process of its own, under sanitizers.

Usage: extremes.py LIBRARY SEED SESSIONS
Prints how many sessions were opened, and in how many of them a motor got something.
"""

import random
import sys
from collections.abc import Callable
from pathlib import Path

from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.wire import ConfigureFrame
from giraff_sim.board import Board
from tests.firmware.bench import SpeedBench

MOST_UM_S = 10_000_000  # that speed.c takes


def settings(chance: random.Random) -> dict[str, int]:
    """Some of them at an end of their range, or beyond it."""
    ranges = {
        "left_counts_per_km": (60, 200_000_000),
        "right_counts_per_km": (60, 200_000_000),
        "speed_max_um_s": (1, MOST_UM_S),
        "acceleration_um_s2": (100, 0x7FFFFFFF),
        "nominal_um_s": (1000, 0xFFFFFFFF),
        "nominal_level": (1, 255),
        "nominal_adc_counts": (0, 1023),
        "motor_ms": (0, 2000),
        "speed_p": (0, 3906),
        "speed_i": (0, 65535),
        "turn_p": (0, 3906),
        "turn_i": (0, 65535),
    }
    chosen = {name: chance.choice([low, high, chance.randint(low, high)]) for name, (low, high) in ranges.items()}
    pwm_max = chance.choice([1, 255, chance.randint(1, 255)])
    stall_pwm = chance.randint(1, pwm_max)
    return {
        **{name: value for name, value in chosen.items() if chance.random() < 0.4},
        "pwm_max": pwm_max,
        "stall_pwm": stall_pwm,
        "dead_pwm": chance.randint(0, stall_pwm),
        "stall_level": 255,
    }


def speed(chance: random.Random, most: int) -> float:
    """m/s, of a session's `most` um/s."""
    return chance.choice([0, 1, most, chance.randint(0, most)]) * chance.choice([1, -1]) * 1e-6


def hand(chance: random.Random) -> Callable[[int], float]:
    """It turns a wheel unevenly, and now and then back."""
    fastest = chance.choice([0.0, 0.001, 0.5, 10.0])
    return lambda _ms: chance.uniform(-0.2, 1.0) * fastest


def drive(bench: SpeedBench, chance: random.Random, frame: ConfigureFrame) -> bool:
    """Whether a motor got something."""
    is_driven = False
    for _ in range(10):
        bench.hands = [hand(chance), hand(chance)]
        bench.model.battery_volts = chance.choice([0.0, 5.0, chance.uniform(0.0, 5.0)])
        asked = speed(chance, frame.speed_max_um_s), speed(chance, frame.speed_max_um_s)
        for millisecond in range(60):
            if millisecond % 20 == 0:
                bench.send(bench.speed_frame(*asked))
            bench.run(1)
            for one, duty in zip(asked, bench.duties(), strict=True):
                assert abs(duty) <= frame.pwm_max, frame
                assert millisecond < 5 or one * duty > 0 or not duty, frame
                is_driven = is_driven or duty != 0.0
        if bench.wheels().latch:
            bench.send(bench.estop_frame(engage=0))
            bench.run(20)
            bench.go(0.0, 0.0)
    return is_driven


def main() -> int:
    library, chance, sessions = Path(sys.argv[1]), random.Random(sys.argv[2]), int(sys.argv[3])
    bench = SpeedBench(Board(BASE_BOARD, library))
    opened = driven = 0
    for session in range(1, sessions + 1):
        frame = bench.configure_frame(session=session, **settings(chance))
        bench.send(frame)
        bench.run(22)
        bench.go(0.0, 0.0)
        if bench.wheels().session == session:
            opened += 1
            driven += drive(bench, chance, frame)
    print(opened, driven)
    return 0


if __name__ == "__main__":
    sys.exit(main())
