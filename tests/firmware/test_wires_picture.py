"""The pictures of docs/build-on-two-wheels.md show the wires that pins.h has.

`GIRAFF_WRITE_DOCS=1 pytest tests/firmware/test_wires_picture.py` draws them anew.
"""

import os

import pytest

from tests.firmware.wires_picture import MODULES, draw, outputs, picture, pins


@pytest.mark.parametrize("board", MODULES)
def test_the_picture_is_of_these_pins(board: str) -> None:
    if os.environ.get("GIRAFF_WRITE_DOCS"):
        picture(board).write_text(draw(board), encoding="utf-8")
    assert picture(board).read_text(encoding="utf-8") == draw(board)


@pytest.mark.parametrize("board", MODULES)
def test_each_output_is_there_with_a_pull_down(board: str) -> None:
    of_motors = {name for name in pins(board) if name.startswith("MOTOR_") or name == "ENABLE"}
    assert set(outputs(board)) == of_motors
    assert draw(board).count(">10k<") == len(of_motors) + 1, "one more is of the battery's divider"
