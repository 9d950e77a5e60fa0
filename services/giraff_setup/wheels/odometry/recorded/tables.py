"""Recorded runs as files: a CSV of counts and true poses, and one of what the robot is built like.

The form is that of the OptiOdom repository (https://github.com/sousarbarb/optiodom), without a header: time s, x m,
y m, heading rad, counts of the right and of the left wheel since the row before. The first row is the start.
"""

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from giraff_core.bounds import Bounds
from giraff_schemas.text import plain
from giraff_setup.wheels.odometry.runs import Floats, Geometry, MeasuredPose, Run

TIME, X, Y, YAW, RIGHT, LEFT = range(6)
"""Columns."""
COLUMNS: Final = ("time", "x", "y", "heading", "right counts", "left counts")
_FORM: Final = "a row is time s, x m, y m, heading rad, right counts, left counts, with commas between"
NO_WHEEL_TURNED: Final = "no wheel turned in it; leave it out, or check the encoders' cables"
MOST_ROWS: Final = 200_000
"""Of a run: half an hour of 100 a second. It is read and checked in some seconds, ten times as many in a
minute.
"""
_BUILT: Final = "a row is a name and its values, one of ngear, encRes, Li and Di"
_TRACK: Final = Bounds(0.05, 2.0, "m")
_DIAMETER: Final = Bounds(0.005, 2.0, "m")
_GEAR: Final = Bounds(0.01, 10_000.0)
_COUNTS: Final = Bounds(1.0, 1e7)
_MOST_COUNTS: Final = 1e7
_TURN_16: Final = 65_536.0
"""Counts after which a counter of 16 bits begins again."""
_MOST: Final = 1e10
"""Largest number of a row but its time. Beyond it sums lose counts, and overflow."""
_LATEST: Final = 1e19
"""Largest time. Any unit will do, nanoseconds since 1970 as well: only the order and the gaps count."""


class RecordingError(Exception):
    """The file cannot be used. One line: which row, why, and the way out."""


def read_table(path: Path) -> Floats:
    """Shape (rows, 6), all numbers, time never going back."""
    rows: list[list[float]] = []
    numbers: list[int] = []
    for number, row in _rows(path, _FORM, f"name the files in it, like '{path}/*.csv'"):
        if len(rows) == MOST_ROWS:
            raise RecordingError(
                f"{path}: more than {MOST_ROWS} rows; keep one every 0.1 s, with its counts and those of the rows left "
                "out summed up, or split it"
            )
        values = _numbers(f"{path}, row {number}", row)
        if rows and values[TIME] < rows[-1][TIME]:
            raise RecordingError(
                f"{path}, row {number}: time goes back from {rows[-1][TIME]:.15g} to {values[TIME]:.15g}; are two "
                "runs in it? split it there"
            )
        rows.append(values)
        numbers.append(number)
    if len(rows) < 2:
        raise RecordingError(f"{path}: one row is no run; {_FORM}")
    table = np.array(rows)
    if not np.any(table[1:, (RIGHT, LEFT)]):
        raise RecordingError(f"{path}: {NO_WHEEL_TURNED}")
    for column in (RIGHT, LEFT):
        wrap = _wrap_in(table[1:, column])
        if wrap is not None:
            told = f"{COLUMNS[column]} is {table[wrap + 1, column]:.0f}"
            added = -math.copysign(_TURN_16, table[wrap + 1, column])
            raise RecordingError(
                f"{path}, row {numbers[wrap + 1]}: {told}; a counter of 16 bits wrapped there: add {added:.0f} in each "
                "such row"
            )
    return table


def unwrapped(counts: Floats) -> Floats:
    """Return counts of rows, corrected where a counter of 16 bits has wrapped."""
    return np.where(np.abs(counts) > _TURN_16 / 2, counts - np.copysign(_TURN_16, counts), counts)


def _wrap_in(counts: Floats) -> int | None:
    """Return the first row in which a counter of 16 bits has wrapped: its count is right but for one such turn."""
    is_large = np.abs(counts) > _TURN_16 / 2
    others = float(np.abs(counts[~is_large]).max(initial=0.0))
    wraps = is_large & (np.abs(unwrapped(counts)) <= 2.0 * others)
    return int(np.argmax(wraps)) if wraps.any() and others < _TURN_16 / 4 else None


def as_run(name: str, table: Floats) -> Run:
    """Every row is a measured pose, in the frame of the first one."""
    x, y = (table[1:, (X, Y)] - table[0, (X, Y)]).T
    cos, sin = math.cos(table[0, YAW]), math.sin(table[0, YAW])
    seen = np.column_stack((cos * x + sin * y, cos * y - sin * x, table[1:, YAW] - table[0, YAW]))
    poses = tuple(MeasuredPose(row, *pose) for row, pose in enumerate(seen.tolist(), 1))
    return Run(name, table[1:, LEFT], table[1:, RIGHT], poses, 0.0, 0.0)


def read_metadata(path: Path) -> Geometry:
    """What the recorded robot is built like: ngear, encRes, Li and Di."""
    fields: dict[str, list[str]] = {}
    for number, (name, *values) in _rows(path, _BUILT, "--metadata takes one file"):
        if name in fields:
            raise RecordingError(f"{path}, row {number}: {name} is there twice; leave one of them")
        fields[name] = [value.strip() for value in values if value.strip()]
    kind = fields.get("type", ["diff"])
    if kind != ["diff"]:
        raise RecordingError(
            f"{path}: type is {' '.join(kind)}; only robots on two driven wheels, diff, can be calibrated"
        )
    [gear] = _built(path, fields, "ngear", "the gear's ratio", _GEAR, 1)
    [counts] = _built(path, fields, "encRes", "counts of one turn of the motor", _COUNTS, 1)
    [track] = _built(path, fields, "Li", "track width, m", _TRACK, 1)
    left, right = _built(path, fields, "Di", "diameters of both wheels, m", _DIAMETER, 2)
    if left != right:
        raise RecordingError(
            f"{path}: Di has {left:g} and {right:g}; give both wheels their mean, the fit tells them apart"
        )
    return Geometry(gear * counts / (math.pi * left), track)


def _built(path: Path, fields: dict[str, list[str]], name: str, what: str, bounds: Bounds, count: int) -> list[float]:
    if name not in fields:
        raise RecordingError(f"{path}: {name} is missing ({what}); add a row like {name},{','.join(['…'] * count)}")
    texts = fields[name]
    if len(texts) != count:
        raise RecordingError(f"{path}: {name} has {len(texts)} values, not {count} ({what})")
    values = [_built_number(f"{path}: {name}", text, what) for text in texts]
    for value in values:
        try:
            bounds.require(name, value)
        except ValueError as error:
            raise RecordingError(f"{path}: {error} ({what})") from error
    return values


def _built_number(where: str, text: str, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        raise RecordingError(f"{where} is {_shown(text)}, no number; correct it ({what})")
    return value


def _rows(path: Path, form: str, in_a_folder: str) -> Iterator[tuple[int, list[str]]]:
    """Those that are not empty, with their numbers, from 1. `form`: what a row is; `in_a_folder`: the way out of it."""
    found = False
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            for number, row in enumerate(csv.reader(file, strict=True), 1):
                if any(value.strip() for value in row):
                    found = True
                    yield number, row
    except FileNotFoundError as error:
        raise RecordingError(f"{path}: there is no such file; check its name and the folder you are in") from error
    except IsADirectoryError as error:
        raise RecordingError(f"{path}: is a folder; {in_a_folder}") from error
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise RecordingError(f"{path}: is no CSV: {plain(error)}; {form}") from error
    if not found:
        raise RecordingError(f"{path}: is empty; was the disk full when it was written?")


def _numbers(where: str, row: list[str]) -> list[float]:
    if len(row) != len(COLUMNS):
        cause = "; are there semicolons or blanks between?" if len(row) == 1 else ""
        raise RecordingError(f"{where}: {len(row)} columns, not {len(COLUMNS)}{cause}; {_FORM}")
    values = [
        _number(f"{where}: {column}", text, _LATEST if column == COLUMNS[TIME] else _MOST)
        for column, text in zip(COLUMNS, row, strict=True)
    ]
    for column in (RIGHT, LEFT):
        if abs(values[column]) > _MOST_COUNTS:
            told = f"{COLUMNS[column]} is {values[column]:g}"
            raise RecordingError(f"{where}: {told}, more than a wheel can make in a row; did its counter wrap there?")
        if not values[column].is_integer():
            told = f"{COLUMNS[column]} is {row[column].strip()}, and counts are whole"
            raise RecordingError(f"{where}: {told}; are the columns in order? {_FORM}")
    return values


def _number(where: str, text: str, most: float) -> float:
    try:
        value = float(text)
    except ValueError as error:
        cause = "is there a header? remove it" if ", row 1:" in where else "correct it, or leave the run out"
        raise RecordingError(f"{where} is {_shown(text)}, no number; {cause}") from error
    if math.isfinite(value) and abs(value) > most:
        raise RecordingError(f"{where} is {value:g}, which cannot be; correct it, or leave the run out")
    if not math.isfinite(value):
        raise RecordingError(
            f"{where} is {value}: the truth was lost there; leave such rows out at the ends, or the run"
        )
    return value


def _shown(text: str) -> str:
    return repr(text.strip()[:30])
