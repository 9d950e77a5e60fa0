"""The boards' C compiled for this machine: as it is, and in the variants that tests ask for."""

import contextlib
import fcntl
import shutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Final

from giraff_schemas.boards import BoardType
from giraff_sim import board
from giraff_sim.board import BUILD, ROOT, Board, Implementation
from tests.support.tools import finished

FIRMWARE: Final = ROOT / "firmware"
HERE: Final = Path(__file__).resolve().parent


STOCK: Final = ("base", "joystick", "ranger")
"""The boards of a stock Giraff, and of most simulations."""


def _make(build: Path, *words: str) -> None:
    # One at a time: tests run in several processes, and these may want the same variant, or an object of all.
    command = ["flock", str(FIRMWARE), "make", "--silent", "-C", str(FIRMWARE), f"BUILD={build}", *words]
    finished(command, check=True)


@cache
def compiled(variant: str = "", *words: str) -> Path:
    """Compile boards with make's settings and targets, a variant into a directory of its own, which this returns."""
    build = BUILD / "variants" / variant if variant else BUILD
    _make(build, *(words or ("host",)))
    return build


def open_board(type_: BoardType, build: Path) -> Board:
    return board.open_board(type_, Implementation.HOST, build)


def near_wraps() -> Path:
    """Every counter starts shortly before it wraps."""
    return compiled("near_wraps", *_starting_with(HERE / "near_wraps.c"), *_host(*STOCK))


def wrap_soon() -> Path:
    """The same, with time to drive before, also for the real boards' processors."""
    values = _starting_with(HERE / "wrap_soon.c")
    return _with_lockstep(compiled("wrap_soon", *values, *_host(*STOCK), *_avr(*STOCK)))


def changing_pwm(*boards: str) -> Path:
    """Programs of Megas whose PWM changes three times a millisecond, whatever they do."""
    return _with_lockstep(compiled("changing_pwm", *_starting_with(HERE / "changing_pwm.c"), *_avr(*boards)))


def _with_lockstep(build: Path) -> Path:
    with contextlib.suppress(FileExistsError):
        (build / "lockstep").symlink_to(BUILD / "lockstep")
    return build


def programs(*boards: str) -> Path:
    """The programs of boards for their own processors."""
    return compiled("", *_avr(*boards))


def sanitized(*boards: str) -> list[Path]:
    """Return boards' libraries with address and undefined-behaviour sanitizers, which end a process at a finding."""
    build = compiled("sanitized", "SANITIZE=1", *_host(*boards))
    return [build / "host" / f"{board}.so" for board in boards]


def sanitized_roboclaw() -> Path:
    """Return the process in front of a RoboClaw with the same, and with what goes wrong on its line."""
    fault = f"HOST_EXTRA={HERE / 'faults' / 'roboclaw_line'}.c", "HOST_LINK=-Wl,--wrap=model_on_byte"
    return compiled("sanitized_roboclaw", "SANITIZE=1", *fault, *_host("roboclaw")) / "host" / "roboclaw.so"


def with_fault(name: str, *wrapped: str, board: str = "base") -> Path:
    """Compile a board with faults/`name`.c between the program and the `wrapped` functions."""
    link = " ".join(f"-Wl,--wrap={function}" for function in wrapped)
    return compiled(name, f"HOST_EXTRA={HERE / 'faults' / name}.c", f"HOST_LINK={link}", _LIKE, *_host(board))


def robot_with_fault(name: str, *wrapped: str) -> Path:
    """Return a build of all boards of a robot whose base board alone has the fault."""
    build = with_fault(name, *wrapped)
    compiled("", *_host("joystick", "ranger"))
    for sound in ("joystick.so", "joystick.sources", "ranger.so", "ranger.sources"):
        with contextlib.suppress(FileExistsError):
            (build / "host" / sound).symlink_to(BUILD / "host" / sound)
    return build


_LIKE: Final = f"LIKE={BUILD}"


def _starting_with(values: Path) -> tuple[str, ...]:
    return _LIKE, f"START_VALUES={values}"


def _host(*boards: str) -> tuple[str, ...]:
    return tuple(f"host-{board}" for board in boards)


def _avr(*boards: str) -> tuple[str, ...]:
    return tuple(f"avr-{board}" for board in boards)


def compiled_for_avr(source: Path, processor: str) -> Path:
    """A program of its own for a board's processor."""
    image = source.with_suffix(".elf")
    finished(["avr-gcc", f"-mmcu={processor}", "-w", "-o", image, source], check=True)
    return image


def built(directory: Path, start_values: Path, *targets: str) -> None:
    """Boards whose counters start at such values."""
    _make(directory, *_starting_with(start_values), *targets)


def shared_library(library: Path, *sources: Path, includes: Sequence[Path] = ()) -> Path:
    """Parts of the boards' C for this machine."""
    options = ["-std=gnu11", "-O1", "-fPIC", "-shared", "-DPROTOCOL_HASH=0", *(f"-I{path}" for path in includes)]
    finished(["cc", *options, *sources, "-o", library], check=True)
    return library


@cache
def with_controller(name: str, constants: str) -> Path:
    """Compile a board in front of a controller whose files are in the folder `name` here, in a copy of the firmware."""
    build = BUILD / "variants" / name
    source = build / "firmware"
    build.mkdir(parents=True, exist_ok=True)
    with (build / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for folder in (FIRMWARE, HERE / name):
            shutil.copytree(
                folder, source, dirs_exist_ok=True, ignore=shutil.ignore_patterns("boards.h", "__pycache__")
            )
        header, text = source / "common" / "boards.h", (FIRMWARE / "common" / "boards.h").read_text()
        wanted = text.replace("#endif", f"enum {{ {constants} }};\n#endif")
        if not header.is_file() or header.read_text() != wanted:
            header.write_text(wanted)
        finished(
            ["make", "--silent", "-C", str(source), f"BUILD={build}", "PYTHON=python3", f"host-{name}"], check=True
        )
    return build
