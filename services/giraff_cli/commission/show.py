"""Prints the steps with what the robot file tells of each."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from giraff_cli.commission.steps import STEPS, Found, Step
from giraff_cli.network.command import print_error
from giraff_cli.terminal.output import guard_stdout
from giraff_cli.terminal.page import print_json, print_table, print_wrapped
from giraff_node.config.robot_file import ConfigError, read

_LEFT: Final = 1


def show(file: Path | None, *, as_json: bool) -> int:
    """Return the exit code."""
    environment = os.environ if file is None else {**os.environ, "GIRAFF_CONFIG": str(file)}
    try:
        settings = read(environment)
    except ConfigError as error:
        return print_error(f"commission: {error}")
    found = [(step, told) for step in STEPS if (told := step.find(settings.tables)) is not None]
    left = [step for step, told in found if told.standing == "left"]

    def tell() -> int:
        if as_json:
            print_json({"robot_file": settings.where, "steps": [_row(step, told) for step, told in found]})
        else:
            _tell(settings.where, found, left)
        return _LEFT if left else 0

    return guard_stdout(tell)


def _row(step: Step, told: Found) -> dict[str, str]:
    return {"step": step.title, "standing": told.standing, "why": told.told, "how": step.how}


def _tell(where: str, found: list[tuple[Step, Found]], left: list[Step]) -> None:
    rows = [
        (str(number), told.standing, step.title, told.told, step.how) for number, (step, told) in enumerate(found, 1)
    ]
    print_table((">", "", "step", "by the robot file", "how"), rows)
    print()
    if left:
        print_wrapped(f"{where}: {len(left)} left. Next: {left[0].title.lower()}, by {left[0].how}.")
    else:
        print_wrapped(f"{where}: nothing is left. Steps that say look leave nothing in the file; do them once more.")
