"""Prints the steps with what the robot file tells of each."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Final

import msgspec

from giraff_base.config import BaseConfig
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_joystick.config import JoystickConfig
from giraff_node.config.robot_file import ConfigError, RawSettings, read
from giraff_ranger.config import RangerConfig
from giraff_setup.commission.steps import STEPS, WHOLE_FILE, Step, StepResult
from giraff_tools.network.command import print_error
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json, print_table, print_wrapped

_LEFT: Final = 1
_CONFIGS: Final[dict[str, type[msgspec.Struct]]] = {
    "robot": RobotConfig,
    "base": BaseConfig,
    "guard": GuardConfig,
    "joystick": JoystickConfig,
    "ranger": RangerConfig,
}
"""By table, what a service takes it for."""


def show(file: Path | None, *, as_json: bool) -> int:
    """Return the exit code."""
    environment = os.environ if file is None else {**os.environ, "GIRAFF_CONFIG": str(file)}
    if file is not None and not file.is_file():
        return print_error(f"commission: {file} is {'a folder' if file.is_dir() else 'not there'}; name a robot file")
    try:
        settings = read(environment)
    except ConfigError as error:
        return print_error(f"commission: {error}")
    refused = _refused(settings)
    judged = [(number, step, step.judge(settings.tables, refused)) for number, step in enumerate(STEPS, 1)]
    rows = [_row(number, step, told) for number, step, told in judged if told is not None]
    left = [row for row in rows if row["status"] == "left"]

    def report() -> int:
        if as_json:
            print_json({"robot_file": settings.where, "steps": rows})
        else:
            _print_steps(settings.where, rows, left)
        return _LEFT if left else 0

    return guard_stdout(report)


def _refused(settings: RawSettings) -> dict[str, str]:
    """Return why services refuse tables of the robot file, by table."""
    refused = {WHOLE_FILE: settings.strange[0].what} if settings.strange else {}
    loaded = dict[str, Any]()
    for table, config in _CONFIGS.items():
        try:
            loaded[table] = settings.table(table, config)
        except ConfigError as error:
            refused[table] = str(error)
    if loaded.keys() >= {"robot", "base"}:
        try:
            loaded["base"].drive.require_countable(loaded["robot"])
        except ValueError as error:
            refused["base"] = f"{settings.place('base')}: {error}"
    return {table: text.removeprefix(f"{settings.where}: ") for table, text in refused.items()}


def _row(number: int, step: Step, told: StepResult) -> dict[str, str]:
    """Return a step under the number that it has in the page."""
    how = told.how or step.how
    return {"number": str(number), "step": step.title, "status": told.status, "why": told.told, "how": how}


def _print_steps(where: str, rows: list[dict[str, str]], left: list[dict[str, str]]) -> None:
    columns = ("number", "status", "step", "why", "how")
    print_table((">", "", "step", "by the robot file", "how"), [[row[column] for column in columns] for row in rows])
    print()
    if left:
        print_wrapped(f"{where}: {len(left)} left. Next: {left[0]['step'].lower()}, by {left[0]['how']}.")
    else:
        print_wrapped(f"{where}: nothing is left. Of a step that says look, the file does not tell: see for yourself.")
