"""What make says when something is missing."""

import pytest

from giraff_schemas.boards import ALL_BOARDS
from tests.firmware.builds import FIRMWARE
from tests.support.tools import finished

BOARDS = sorted(board.name for board in ALL_BOARDS if not board.is_process)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["AVR_CC=no-such-compiler"], "there is no no-such-compiler; on Debian: apt install gcc-avr avr-libc"),
        (["check", "CPPCHECK=no-such-checker"], "there is no no-such-checker; on Debian: apt install cppcheck"),
        (["flash"], f"BOARD= one of {' '.join(BOARDS)}"),
        (["flash", "BOARD=base", "AVRDUDE=no-such-tool"], "there is no no-such-tool; on Debian: apt install avrdude"),
        (["flash", "BOARD=base", "AVRDUDE=true"], "PORT= the programmer's port"),
    ],
)
def test_what_is_missing_is_named(arguments: list[str], complaint: str) -> None:
    command = ["make", "--silent", "-C", str(FIRMWARE), *arguments]
    made = finished(command)
    assert made.returncode != 0
    assert complaint in made.stderr


@pytest.mark.parametrize(
    ("board", "chosen", "part"),
    [
        ("base", [], "-p m644 -c usbasp"),
        ("joystick", [], "-p m328p -c arduino"),
        ("ranger", [], "-p m2560 -c wiring"),
        ("ardros", ["PROGRAMMER=-c avrisp2"], "-p m2560 -c avrisp2"),
    ],
)
def test_each_board_is_flashed_with_its_own_part_and_programmer(board: str, chosen: list[str], part: str) -> None:
    """Another programmer may be chosen."""
    settings = ["flash", f"BOARD={board}", "PORT=/dev/port", *chosen]
    made = finished(["make", "--silent", "--dry-run", "-C", str(FIRMWARE), *settings], check=True)
    assert f"avrdude {part}" in made.stdout
    assert f"-P /dev/port -U flash:w:../build/firmware/{board}.elf:e" in made.stdout
