"""Options that several commands have."""

import math
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

if TYPE_CHECKING:
    from giraff_core.kinematics.pose import Pose
    from giraff_schemas.services import Service


def finite(number: float | None) -> float | None:
    """An option's number, if it is one that something can end after."""
    if number is not None and not math.isfinite(number):
        raise typer.BadParameter(f"{number:g} is no number to count with")
    return number


def typed_pose(words: "Sequence[str]") -> "Pose":
    """Return the pose that was typed with `NEGATIVE`.

    Raises ValueError, for several words with the one that they should have been.
    """
    from giraff_tools import typed  # noqa: PLC0415  for a command that takes a pose

    if wrong := [word for word in words if word.startswith("--")]:
        raise ValueError(f"no option {wrong[0]}")
    unit = "rad"
    try:
        typed.angle(words[-1])
    except ValueError:  # beyond a turn, and so no radians
        unit = "deg"
    return typed.pose(typed.one_word(words, typed.pose, unit))


def parsed(read: Callable[[str], float]) -> Callable[[str], float]:
    """Make an option's parser of a function of `giraff_tools.typed`."""

    def parse(text: str | float) -> float:
        try:
            return read(str(text))
        except ValueError as error:
            raise typer.BadParameter(str(error)) from error

    return parse


Robot = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Else GIRAFF_ROBOT_NAME, else the robot file's, else the only one on the network.",
        show_default=False,
    ),
]
Connect = Annotated[
    list[str] | None,
    typer.Option(metavar="HOST", help="Like 192.168.1.20, where multicast does not reach.", show_default=False),
]
WrittenFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="The robot file that is written. Else GIRAFF_CONFIG's, if it is that robot's.",
        show_default=False,
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]
Ending = Annotated[
    float | None,
    typer.Option("--for", metavar="SECONDS", min=0.1, callback=finite, help="End after so long; else with Ctrl-C."),
]
Listen = Annotated[
    float, typer.Option("--for", metavar="SECONDS", min=0.1, callback=finite, help="How long to listen.")
]
Topics = Annotated[
    list[str] | None,
    typer.Option(
        metavar="KEY", help="Only these: odom, range/*, giraff/ROBOT/odom; once for each.", show_default=False
    ),
]

NEGATIVE: Final = {"ignore_unknown_options": True}
"""Setting of a command that takes numbers: a negative one is no option."""

_REFUSED: Final = 2


def require_extra(verb: str, library: str, extras: str) -> None:
    """End with the way out where a verb's library is not installed. `extras`: of the distribution, that bring it."""
    if find_spec(library) is None:
        from giraff_node.process.libraries import remedy  # noqa: PLC0415

        typer.echo(f"giraff {verb}: the library {library} is missing; {remedy(extras)}", err=True)
        raise typer.Exit(_REFUSED)


def require_service(verb: str, service: "Service", extras: str) -> None:
    """End with the remedy where a library of the service is not installed. `extras`: beside its own."""
    for library in service.libraries:
        require_extra(verb, library, f"{extras},{service.extra}")


def require_tree(verb: str) -> None:
    """End with the way out where the simulator's boards and rooms are not here: a wheel has no firmware."""
    from giraff_node.process.libraries import TREE  # noqa: PLC0415

    if not (TREE / "firmware").is_dir():
        typer.echo(
            f"giraff {verb}: the simulated robot needs the repository's tree, which is not here; "
            "clone the repository, then make run in it",
            err=True,
        )
        raise typer.Exit(_REFUSED)
