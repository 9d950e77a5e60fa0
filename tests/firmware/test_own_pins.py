"""Other wires on the same Mega cost pins.h and board.mk; the compiler refuses a pin that cannot do its work."""

import shutil
from pathlib import Path
from typing import Final

from tests.firmware.builds import FIRMWARE
from tests.support.tools import finished

PINS: Final = {
    "mine": "MOTOR_0_PWM 12, MOTOR_0_IN1 53, MOTOR_0_IN2 33, ENABLE 41, ENCODER_0_A 20, ENCODER_0_B 2",
    "twice": "MOTOR_0_IN1 16",
    "no_pwm": "MOTOR_1_PWM 4",
    "no_interrupt": "ENCODER_1_A 22",
    "pulled_up": "MOTOR_0_IN2 21",
    "no_channel": "BATTERY_CHANNEL 54",
}
"""Pins that are others than those of mega_l298n, by board."""
REFUSED: Final = {
    "twice": "pins.h uses a pin twice",
    "no_pwm": "pins.h has PWM at a pin other than",
    "no_interrupt": "pins.h has channel A of an encoder at a pin other than",
    "pulled_up": "pins.h has an output at 20 or 21",
    "no_channel": "pins.h has the battery at a pin other than",
}


def test_pins_of_ones_own_need_no_register_code(tmp_path: Path) -> None:
    source = shutil.copytree(FIRMWARE, tmp_path / "firmware")
    for board, pins in PINS.items():
        folder = shutil.copytree(source / "boards" / "mega_l298n", source / "boards" / board)
        lines = (folder / "pins.h").read_text().splitlines()
        for name, number in (pin.split() for pin in pins.split(", ")):
            [at] = [index for index, line in enumerate(lines) if line.startswith(f"#define {name} ")]
            lines[at] = f"#define {name} {number}"
        (folder / "pins.h").write_text("\n".join(lines) + "\n")
    each = f"for board in {' '.join(PINS)}; do make -C {source} -f avr.mk BOARD=$board BUILD={tmp_path}/$board"
    objects = " ".join(f"{tmp_path}/$board/firmware/$board/registers/{name}.o" for name in ("registers", "motors_off"))
    made = finished(
        ["sh", "-c", f"{each} -k AVR_CC=avr-gcc PYTHON=python3 {objects} 2>$board.told; done"], cwd=tmp_path
    )
    assert made.returncode != 0, made.stdout
    told = {board: (tmp_path / f"{board}.told").read_text() for board in PINS}
    assert told["mine"] == ""
    assert {board: words for board, words in REFUSED.items() if words not in told[board]} == {}
