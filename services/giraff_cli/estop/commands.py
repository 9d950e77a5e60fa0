"""`giraff stop`, and the verbs of `giraff estop`. Each verb imports what it needs when it is typed."""

import sys
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer
from typer.core import TyperGroup

from giraff_cli.options import AsJson, Connect, Robot, finite

if TYPE_CHECKING:
    from collections.abc import Callable

    from giraff_cli.estop.client import Result
    from giraff_tools.network.connection import RobotConnection


_STOP: Final = "engage"


class StopUnlessTold(TyperGroup):
    """Verbs of the emergency stop. A person who types none of them is in a hurry, and stops the robot."""

    assumed: Final = _STOP
    """The verb that stands for a missing one."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the verb in front of names and options. Without a word, a person stops the robot, a program gets help."""
        if args[:1] not in (["-h"], ["--help"]) and (args or _is_terminal(ctx)):
            at = self._verb_at(args)
            args = [_STOP, *args] if at is None else [args[at], *args[:at], *args[at + 1 :]]
        return super().parse_args(ctx, args)

    def _verb_at(self, args: list[str]) -> int | None:
        """Return the place of the first verb, also behind options and names. An option's value is none."""
        parameters = [each for command in self.commands.values() for each in command.params]
        with_value = {word for each in parameters if not getattr(each, "is_flag", True) for word in each.opts}
        words = zip(args, ["", *args], strict=False)
        return next(
            (at for at, (word, last) in enumerate(words) if word in self.commands and last not in with_value), None
        )


def _is_terminal(ctx: Any) -> bool:
    """Return whether a person has typed this. A stop whose output goes to a file is one, too."""
    streams = (sys.stdin, sys.stdout, sys.stderr)
    return not ctx.resilient_parsing and any(stream is not None and stream.isatty() for stream in streams)


estop = typer.Typer(
    cls=StopUnlessTold, no_args_is_help=True, help="Stop the robot from any machine, and release it again."
)

Timeout = Annotated[float, typer.Option(metavar="SECONDS", min=0.1, callback=finite, help="How long to try.")]


def stop(
    robots: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME", help="The robots that stop; else every robot that is heard.", show_default=False
        ),
    ] = None,
    robot: Robot = None,
    connect: Connect = None,
    timeout: Timeout = 5.0,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="Told to whoever asks why.")] = "stopped by hand",
    page: Annotated[
        str,
        typer.Option(
            metavar="HOST:PORT", help="Ask this page of the robot at once; else the last known.", show_default=False
        ),
    ] = "",
    off: Annotated[bool, typer.Option("--off", help="Also switch off a robot that stands by its motors.")] = False,
    as_json: AsJson = False,
) -> None:
    """Stop the robot now, and keep it stopped, also over restarts. Where none is named: every robot that is heard.

    `giraff stop` and `giraff estop engage` are the same.

    Where Zenoh does not answer, the robot's page is asked, too.

    Exit code: 0 base confirms it, or on an open network whoever answers as base; 1 stopped, but the disk did not take
    it, or not off; 2 NOT CONFIRMED: use the battery switch.
    """
    from giraff_cli.estop.engage import engage_each  # noqa: PLC0415

    code = engage_each(robots or (), robot, connect or (), reason, timeout, page, off=off, as_json=as_json)
    raise typer.Exit(code)


estop.command(_STOP)(stop)


@estop.command()
def reset(robot: Robot = None, connect: Connect = None, timeout: Timeout = 5.0, as_json: AsJson = False) -> None:
    """Clear the latch that is engaged now. It permits motion and never causes it: a level hand must arm the robot.

    Exit code: 0 no latch is engaged; 1 still engaged; 2 unknown.
    """
    from giraff_cli.estop import client  # noqa: PLC0415
    from giraff_tools.terminal.program import user_at_host  # noqa: PLC0415

    _report(
        robot, connect, timeout, lambda met: client.reset(met, user_at_host(), timeout), moves=True, as_json=as_json
    )


@estop.command()
def status(robot: Robot = None, connect: Connect = None, timeout: Timeout = 3.0, as_json: AsJson = False) -> None:
    """Whether the robot's emergency stop is engaged, by whom and why.

    Exit code: 0 released; 1 engaged; 2 unknown.
    """
    from giraff_cli.estop import client  # noqa: PLC0415

    _report(robot, connect, timeout, lambda met: client.status(met, timeout), as_json=as_json)


def _report(
    robot: str | None,
    connect: list[str] | None,
    timeout: float,
    act: "Callable[[RobotConnection], Result]",
    *,
    moves: bool = False,
    as_json: bool,
) -> None:
    from giraff_cli.estop.engage import print_result  # noqa: PLC0415
    from giraff_tools.network.command import run_with_robot  # noqa: PLC0415

    def say(connection: "RobotConnection") -> int:
        return print_result(act(connection), as_json=as_json)

    raise typer.Exit(run_with_robot(robot, connect or (), say, patience=timeout, moves=moves, stands_in=False))
