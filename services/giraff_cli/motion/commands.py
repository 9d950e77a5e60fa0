"""The options of `giraff move`, `turn`, `arc` and `go`. What they do is imported when it is asked for."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from giraff_cli.options import AsJson, Connect, Robot, finite, parsed
from giraff_tools import typed

if TYPE_CHECKING:
    from giraff_core.motion.wish import RouteWish, Wish

Angle = Annotated[
    float,
    typer.Argument(
        metavar="ANGLE",
        parser=parsed(typed.angle),
        help="Like 90deg, 1.57rad, pi/2; to the left.",
        show_default=False,
    ),
]
Speed = Annotated[
    float | None,
    typer.Option(
        metavar="M/S", min=0.01, callback=finite, help="At most; else as the robot file has it.", show_default=False
    ),
]
TurnSpeed = Annotated[
    float | None,
    typer.Option(
        "--speed",
        metavar="RAD/S",
        min=0.01,
        callback=finite,
        help="At most; else as the robot file has it.",
        show_default=False,
    ),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        min=0.1,
        callback=finite,
        help="It ends then; else after twice the time it needs.",
        show_default=False,
    ),
]


def move(
    distance: Annotated[
        float,
        typer.Argument(
            metavar="DISTANCE", parser=parsed(typed.length), help="m; negative: backward.", show_default=False
        ),
    ],
    speed: Speed = None,
    time_limit: TimeLimit = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Move the robot straight on by DISTANCE. Ctrl-C stops it. Where an obstacle is, it stops before it.

    Exit code: 0 arrived; 1 it ended otherwise, with the reason; 2 nothing has moved.
    """
    from giraff_cli.motion.pattern import move as step  # noqa: PLC0415
    from giraff_core.motion.wish import Wish  # noqa: PLC0415

    _perform("move", lambda: Wish((step(distance),), speed, None, time_limit), robot, connect, as_json=as_json)


def turn(
    angle: Angle,
    speed: TurnSpeed = None,
    time_limit: TimeLimit = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Turn the robot on the spot by ANGLE, however many turns that is. Ctrl-C stops it.

    Exit code: 0 arrived; 1 it ended otherwise, with the reason; 2 nothing has moved.
    """
    from giraff_cli.motion.pattern import turn as step  # noqa: PLC0415
    from giraff_core.motion.wish import Wish  # noqa: PLC0415

    _perform("turn", lambda: Wish((step(angle),), None, speed, time_limit), robot, connect, as_json=as_json)


def arc(
    radius: Annotated[
        float,
        typer.Argument(metavar="RADIUS", parser=parsed(typed.length), help="m, of the circle.", show_default=False),
    ],
    angle: Angle,
    speed: Speed = None,
    time_limit: TimeLimit = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Drive the robot forward along a circle, whose middle is to its left, or to its right for a negative ANGLE.

    Exit code: 0 arrived; 1 it ended otherwise, with the reason; 2 nothing has moved.
    """
    from giraff_cli.motion.pattern import arc as step  # noqa: PLC0415
    from giraff_core.motion.wish import Wish  # noqa: PLC0415

    _perform("arc", lambda: Wish((step(radius, angle),), speed, None, time_limit), robot, connect, as_json=as_json)


def go(
    goal: Annotated[
        list[str],
        typer.Argument(
            metavar="NAME|X,Y|PATTERN.toml",
            help="A place by its name; a point, m; or steps in a file, see deploy/patterns.",
            show_default=False,
        ),
    ],
    frame: Annotated[
        Literal["odom", "map"] | None,
        typer.Option(
            help="Of the point, to which it goes straight: odom, where odometry began, which is the default; or map, "
            "the floor plan, while it is known, or was told, where the robot is.",
            show_default=False,
        ),
    ] = None,
    speed: Speed = None,
    time_limit: TimeLimit = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Drive the robot to a place of the floor plan, to a point, or by the steps of a file.

    To a place by its name, as `giraff place list` has it, it finds a way. To a point it turns and goes straight: no way
    around anything is planned. Ctrl-C stops it. Where an obstacle is, it stops before it.

    Exit code: 0 arrived; 1 it ended otherwise, with the reason; 2 nothing has moved.
    """
    from giraff_cli.motion.pattern import PatternError, read_pattern  # noqa: PLC0415
    from giraff_core.motion.wish import RouteWish, Wish  # noqa: PLC0415
    from giraff_schemas.motion import GoTo  # noqa: PLC0415

    def wish() -> "Wish | RouteWish":
        name = _place_name(goal)
        word = name or typed.one_word(goal, typed.point)
        if name or "," not in word or Path(word).exists():
            if (frame, speed, time_limit) != (None, None, None):
                why = "a route goes as the robot file has it" if name else "a pattern says them in its file"
                raise ValueError(f"--frame, --speed and --time-limit are for a point: {why}")
            if name:
                return RouteWish(name)
            try:
                return read_pattern(Path(word))
            except PatternError as error:
                hint = "" if Path(word).exists() else "; a point is X,Y, like 1.5,-2, and a place a name, like kitchen"
                raise PatternError(f"{error}{hint}") from error
        x, y = typed.point(word)
        return Wish((GoTo(x=x, y=y, frame=frame or "odom"),), speed, None, time_limit)

    _perform("go", wish, robot, connect, as_json=as_json)


def _place_name(words: Sequence[str]) -> str:
    """Return the name of a place, which may be of several words; empty: they are a point, or a file.

    Raises ValueError for a mistyped option, which a command that takes negative numbers has among its words.
    """
    from giraff_schemas.places import require_place_name  # noqa: PLC0415

    if option := next((word for word in words if word.startswith("--")), ""):
        raise ValueError(f"there is no option {option}; see giraff go --help")
    name = " ".join(words)
    with suppress(ValueError):
        return "" if Path(name).is_file() else require_place_name(name)
    return ""


def _perform(
    verb: str, wish: "Callable[[], Wish | RouteWish]", robot: str | None, connect: list[str] | None, *, as_json: bool
) -> None:
    from giraff_cli.motion.pattern import PatternError  # noqa: PLC0415
    from giraff_cli.motion.perform import perform  # noqa: PLC0415
    from giraff_tools.network.command import print_error  # noqa: PLC0415

    try:
        wished = wish()
    except (PatternError, ValueError) as error:
        raise typer.Exit(print_error(f"{verb}: {error}")) from None
    raise typer.Exit(perform(robot, connect or (), wished, as_json=as_json))
