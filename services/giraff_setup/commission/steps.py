"""The steps from a new robot to a driving one, and how the robot file tells that one is done; printed."""

import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

import msgspec

from giraff_base.config import KINDS, BaseConfig
from giraff_core.robot import WIRING, RobotConfig
from giraff_core.senses import Camera, Sense, Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_joystick.config import JoystickConfig
from giraff_node.config.robot_file import ConfigError, RawSettings, read
from giraff_ranger.config import RangerConfig
from giraff_schemas.boards import BASE_BOARD, BoardType, boards_chosen_in
from giraff_tools.network.command import print_error
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json, print_table, print_wrapped

StepStatus = Literal["done", "left", "look"]
"""`look`: the robot file does not tell, so that only a person knows."""
Tables = Mapping[str, Mapping[str, Any]]
_LEFT: Final = 1
_CONFIGS: Final[dict[str, type[msgspec.Struct]]] = {
    "robot": RobotConfig,
    "base": BaseConfig,
    "guard": GuardConfig,
    "joystick": JoystickConfig,
    "ranger": RangerConfig,
}
"""By table, what a service takes it for."""


class StepResult(NamedTuple):
    """The status of a step by the robot file."""

    status: StepStatus
    told: str
    """The field by which it is known, or that is missing."""
    how: str = ""
    """A command, or a page, for this robot; empty: the step's own."""


class Step(NamedTuple):
    """One thing that a person does."""

    title: str
    """As `docs/commissioning.md` calls it."""
    how: str
    """A command, or a page."""
    find: Callable[[Tables], StepResult | None]
    """Judges the step by the tables of a robot file. None: this robot does not need it."""
    needs: Sequence[str] = ()
    """Tables that it is told by. Where services refuse one of them, it is left."""

    def judge(self, tables: Tables, refused: Mapping[str, str]) -> StepResult | None:
        """Return what is known of it. `refused`: why services refuse a table, by its name."""
        told = self.find(tables)
        why = next((refused[table] for table in self.needs if table in refused), "")
        return StepResult("left", why) if told is not None and why else told


WHOLE_FILE: Final = "*"
"""Stands for all tables, where services refuse the file as a whole."""
_PAGE: Final = "docs/commissioning.md"


def _drive(tables: Tables) -> Mapping[str, Any]:
    drive = tables.get("base", {}).get("drive")
    return drive if isinstance(drive, Mapping) else {}


def _by_hand(tables: Tables) -> str:
    """Return the page by which a robot of this kind is wired and tuned by hand. Empty: commands do both."""
    named = _drive(tables).get("type")
    return next((kind.BY_HAND for kind in KINDS if kind.__struct_config__.tag == named), "")


def _base_board(tables: Tables) -> BoardType:
    """Return the board that a robot on two wheels has; a stock Giraff's where the file names no known one."""
    return boards_chosen_in(BASE_BOARD.chosen_in).get(str(_drive(tables).get("board")), BASE_BOARD)


def _has(fields: Mapping[str, Any], name: str, table: str) -> StepResult:
    """Tell of a field that the step writes."""
    value = fields.get(name)
    is_set = value is not None and re.fullmatch(r"[-+]?0*\.?0*", str(value)) is None  # a variable's 0 is text
    return StepResult("done", f"{table} has {name}") if is_set else StepResult("left", f"{table} has no {name}")


def _each(kind: type[Sense], name: str) -> Callable[[Tables], StepResult | None]:
    """Tell of a field that the step writes for each sensor of a type."""

    def find(tables: Tables) -> StepResult | None:
        entries = tables.get("robot", {}).get("sensors")
        if not isinstance(entries, Mapping):
            return StepResult("left", "[robot] has no sensors")
        tables_of = {sensor: entry for sensor, entry in entries.items() if isinstance(entry, Mapping)}
        default, wanted = Ultrasonic.type_name(), kind.type_name()
        sensors = {sensor: entry for sensor, entry in tables_of.items() if entry.get("type", default) == wanted}
        missing = [sensor for sensor, entry in sensors.items() if name not in entry]
        if not sensors:
            return None
        done = StepResult("done", f"{', '.join(sensors)}: each has {name}")
        return StepResult("left", f"without {name}: {', '.join(missing)}") if missing else done

    return find


def _ports(tables: Tables) -> StepResult:
    name = tables.get("robot", {}).get("name", "")
    missing = [table for table in ("base", "ranger") if not tables.get(table, {}).get("port")]
    if name and not missing:
        boards = ", ".join(str(tables[table]["port"]) for table in ("base", "ranger"))
        unit = "" if _by_hand(tables) else _base_board(tables).unit
        process = unit and f" Base's is made by {unit}, which alone opens the port that your udev rule names for it."
        return StepResult("look", f"the robot is {name}; boards on {boards}: do they answer?{process}{_ticks(tables)}")
    return StepResult(
        "left", "no name" if not name else f"no port in {' and '.join(f'[{table}]' for table in missing)}"
    )


def _ticks(tables: Tables) -> str:
    """Return what the counts of a metre must be: of each turn, both edges of channel A, or all of both channels."""
    ticks = tables.get("robot", {}).get("ticks_per_metre")
    if ticks is None or _by_hand(tables):
        return ""
    per_pulse = 4 // _base_board(tables).states_per_tick
    formula = f"{per_pulse} * pulses a turn of the motor * gear / (3.1416 * wheel diameter in m)"
    return f" ticks_per_metre is {ticks}: is that {formula}?"


def _before_power(tables: Tables) -> StepResult:
    base = tables.get("base", {})
    missing = [name for name in ("battery_low", "battery_cutoff") if name not in base]
    if missing:
        why = (
            f"[base] has no {' and no '.join(missing)}: the defaults are those of 20 NiMH cells, 24 V; "
            "write those of yours, or a weaker one engages the emergency stop at the first start"
        )
        return StepResult("left", why)
    page = "" if _by_hand(tables) else _base_board(tables).wiring_page
    if page:
        lines = "10 kohm to ground at each PWM, direction, enable and servo line, and nothing else that holds it high"
        battery = f"battery_low is {base['battery_low']} V, battery_cutoff {base['battery_cutoff']} V: your battery's?"
        return StepResult("look", f"{battery} {lines}: is it so?", page)
    return StepResult("done", "[base] has battery_low and battery_cutoff")


def _wiring(tables: Tables) -> StepResult:
    if page := _by_hand(tables):
        return StepResult("look", "this kind of robot: its wiring is written by hand", page)
    missing = [name for name in WIRING if _drive(tables).get(name) is None]
    if missing:
        return StepResult("left", f"not known: {', '.join(missing)}; base does not arm")
    return StepResult("done", "[base.drive] has all six fields of the wiring")


def _encoders(tables: Tables) -> StepResult | None:
    if _by_hand(tables) or not _base_board(tables).tells_transitions:
        return None
    return StepResult("look", "it draws them, and writes nothing")


def _speed_control(tables: Tables) -> StepResult | None:
    if _by_hand(tables):
        return None
    drive = _drive(tables)
    if drive.get("wheel_control") != "speed":
        why = 'wheel_control is "level", by which a low battery or a carpet makes the robot slower; write "speed"'
        return StepResult("left", why, _PAGE)
    gains = drive.get("speed_control")
    if isinstance(gains, Mapping) and "speed_p" in gains:
        return StepResult("done", "[base.drive.speed_control] has speed_p")
    return StepResult("look", "the board goes by default gains: do they fit?")


def _odometry(tables: Tables) -> StepResult:
    calibration = tables.get("robot", {}).get("calibration")
    return _has(calibration if isinstance(calibration, Mapping) else {}, "date", "[robot.calibration]")


def _joystick(tables: Tables) -> StepResult:
    fields = tables.get("joystick", {})
    if "mount_yaw" in fields:
        return StepResult("done", "[joystick] has mount_yaw")
    return StepResult("look", "[joystick] has no mount_yaw: is there a joystick?")


def _brakes(tables: Tables) -> StepResult:
    return _has(tables.get("guard", {}), "deceleration", "[guard]")


def _battery(tables: Tables) -> StepResult:
    return _has(_drive(tables), "battery_volts_per_count", "[base.drive]")


STEPS: Final = (
    Step("Boards and ports", f"{_PAGE}, firmware/README.md", _ports, (WHOLE_FILE, "robot", "base", "ranger")),
    Step("Before the motors have power", _PAGE, _before_power, ("base",)),
    Step("How the wheels are wired", "giraff check wheels", _wiring, ("base",)),
    Step("What the encoders give", "giraff check encoders", _encoders, ("base",)),
    Step("The joystick's level and axes", "giraff calibrate joystick", _joystick, ("joystick",)),
    Step("First start", f"giraff estop reset; {_PAGE}", lambda _: StepResult("look", "the robot drives, and creeps")),
    Step("How well it brakes", _PAGE, _brakes, ("guard",)),
    Step("The battery", _PAGE, _battery, ("base",)),
    Step("Speeds that are held", "giraff tune speed", _speed_control, ("base",)),
    Step("Odometry", "giraff calibrate odometry", _odometry, ("robot",)),
    Step("Sensors by a wall", "giraff calibrate ranger", _each(Ultrasonic, "scale"), ("robot",)),
    Step("The camera", "giraff calibrate camera", _each(Camera, "distortion"), ("robot",)),
    Step(
        "Before it is left to others", _PAGE, lambda _: StepResult("look", "cardboard, cables, and the emergency stop")
    ),
)
"""In their order."""


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
