"""The `giraff` command's words and options. What they do is imported when it is asked for."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from giraff_cli.doctor.commands import doctor
from giraff_cli.options import Connect, Ending, Robot, finite
from giraff_cli.param.commands import param
from giraff_cli.record.commands import add_to as add_recording
from giraff_cli.topic.commands import add_to as add_asking
from giraff_cli.view.commands import view

if TYPE_CHECKING:
    from collections.abc import Callable

    from giraff_cli.estop.client import Told
    from giraff_cli.network.connection import Watcher

app = typer.Typer(
    name="giraff",
    help="A masterless multi-machine robot.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
estop = typer.Typer(no_args_is_help=True, help="Stop the robot from any machine, and release it again.")
check = typer.Typer(no_args_is_help=True, help="Checks that a robot must have passed before it drives.")
app.add_typer(estop, name="estop")
app.add_typer(check, name="check")
keys = typer.Typer(no_args_is_help=True)
app.add_typer(keys, name="keys")
add_recording(app)
add_asking(app)
app.add_typer(param, name="param")
app.command()(view)
app.command()(doctor)

_REFUSED = 2  # exit code: nothing was started

Folder = Annotated[Path, typer.Option(metavar="FOLDER", help="Where the CA and all bundles are kept.")]
Timeout = Annotated[float, typer.Option(metavar="SECONDS", min=0.1, callback=finite, help="How long to try.")]


@app.callback()
def giraff() -> None:
    """A masterless multi-machine robot."""


@app.command()
def run(  # noqa: PLR0913, PLR0917  one argument an option
    seconds: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", help="End after so long; else with Ctrl-C.")
    ] = None,
    world: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The room; see deploy/worlds.", show_default=False)
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Of everything that is random in the world.")] = 1,
    truth: Annotated[
        Literal["exact", "calibrated", "uncalibrated"],
        typer.Option(help="How far the robot that the seed draws differs from its file."),
    ] = "calibrated",
    tilt_script: Annotated[
        Path | None, typer.Option(metavar="FILE", help="CSV rows t, x, y, z (s, m/s²) instead of the scripted hand.")
    ] = None,
    boards: Annotated[
        Literal["avr", "host"] | None,
        typer.Option(help="The real firmware on simavr, or the same C compiled for this machine.", show_default=False),
    ] = None,
    summary: Annotated[Path | None, typer.Option(metavar="FILE", help="Also write the summary as JSON.")] = None,
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the last live view as SVG.")] = None,
    local: Annotated[bool, typer.Option("--local", help="Keep off the network.")] = False,
) -> None:
    """Drive the simulated robot through the five services, and watch it."""
    from giraff_cli.run.plan import PlanError, make_plan  # noqa: PLC0415
    from giraff_cli.run.runner import drive  # noqa: PLC0415

    try:
        plan = make_plan(
            seconds=seconds,
            world=world,
            seed=seed,
            truth=truth,
            tilt_script=tilt_script,
            boards=boards,
            summary=summary,
            picture=picture,
            local=local,
        )
    except PlanError as error:
        typer.echo(f"giraff run: {error}", err=True)
        raise typer.Exit(_REFUSED) from None
    raise typer.Exit(drive(plan))


@app.command()
def why(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Annotated[
        float, typer.Option("--for", metavar="SECONDS", min=0.6, callback=finite, help="How long to listen.")
    ] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
) -> None:
    """What stops the robot now: the chain from hand to wheel, and its first broken link.

    Exit code: 0 the robot drives, or would if asked to; 1 something stops it; 2 there is no robot to tell of.
    """
    from giraff_cli.network.command import visit  # noqa: PLC0415
    from giraff_cli.why.explain import explain  # noqa: PLC0415

    raise typer.Exit(visit(robot, connect or (), 3.0, lambda watcher: explain(watcher, seconds, as_json=as_json)))


@app.command()
def watch(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Ending = None,
    as_json: Annotated[bool, typer.Option("--json", help="For programs: one JSON object a second.")] = False,
) -> None:
    """The operator's screen of a robot: path, velocity, ranges, who drives, what guard and base allow and why.

    In a terminal a live view, else one line a second. It only listens, waits for a robot that is not there yet, and
    takes one that comes back up again. Exit code: 0; 1 standard output takes nothing; 2 no robot came within --for,
    or several are there and none is named.
    """
    from giraff_cli.watch.monitor import watch as it  # noqa: PLC0415

    raise typer.Exit(it(robot, connect or (), seconds, as_json=as_json))


@estop.command()
def engage(
    robot: Robot = None,
    connect: Connect = None,
    timeout: Timeout = 5.0,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="Told to whoever asks why.")] = "stopped by hand",
) -> None:
    """Stop the robot now, and keep it stopped, also over restarts.

    Exit code: 0 base confirms it; 1 stopped, but the disk did not take it; 2 NOT CONFIRMED: use the battery switch.
    """
    from giraff_cli.estop import client as it  # noqa: PLC0415
    from giraff_cli.estop.fallback import way_to_stop  # noqa: PLC0415
    from giraff_cli.network.user import who  # noqa: PLC0415

    _tell(
        robot,
        connect,
        timeout,
        lambda watcher: it.engage(watcher, who(), reason, timeout),
        lambda: way_to_stop(robot, connect or ()),
    )


@estop.command()
def reset(robot: Robot = None, connect: Connect = None, timeout: Timeout = 5.0) -> None:
    """Clear the latch that is engaged now. It permits motion and never causes it: a level hand must arm the robot.

    Exit code: 0 no latch is engaged; 1 still engaged; 2 unknown.
    """
    from giraff_cli.estop import client as it  # noqa: PLC0415
    from giraff_cli.network.user import who  # noqa: PLC0415

    _tell(robot, connect, timeout, lambda watcher: it.reset(watcher, who(), timeout))


@estop.command()
def status(robot: Robot = None, connect: Connect = None, timeout: Timeout = 3.0) -> None:
    """Whether the robot's emergency stop is engaged, by whom and why.

    Exit code: 0 released; 1 engaged; 2 unknown.
    """
    from giraff_cli.estop import client as it  # noqa: PLC0415

    _tell(robot, connect, timeout, lambda watcher: it.status(watcher, timeout))


@check.command()
def wheels(
    port: Annotated[
        str | None, typer.Option(metavar="PATH", help="Of the base board; else the robot file's.", show_default=False)
    ] = None,
) -> None:
    """With the wheels lifted: find out how motors and encoders are wired, and write it into the robot file.

    Asks before each step; giraff_base must not run. Exit code: 0 written; 1 in doubt, nothing written; 2 not begun.
    """
    from giraff_cli.check.wheels import check_wheels  # noqa: PLC0415

    raise typer.Exit(check_wheels(port))


@app.command()
def dst(
    seeds: Annotated[int, typer.Option(metavar="N", min=1, help="How many; of a single one the story is told.")] = 100,
    seed: Annotated[int, typer.Option(metavar="K", min=0, help="The first of them.")] = 0,
    json: Annotated[Path | None, typer.Option(metavar="FILE", help="Also write the totals as JSON.")] = None,
    jobs: Annotated[int, typer.Option(metavar="J", min=1, help="Processes.")] = os.cpu_count() or 1,
) -> None:
    """Deterministic simulation of the command path, 20 s a seed, with faults drawn from the seed.

    Exit code: 0 no invariant is violated; 1 one is: the story of each such seed is told.
    """
    from giraff_cli.dst.explore import explore  # noqa: PLC0415

    raise typer.Exit(explore(seeds, seed, jobs, json))


@keys.callback()
def needs_cryptography() -> None:
    """Certificates by which hosts know each other: see docs/keys.md."""
    if find_spec("cryptography") is None:
        typer.echo("giraff keys: the library cryptography is missing: pip install 'giraff[cli,keys]'", err=True)
        raise typer.Exit(_REFUSED)


@keys.command()
def init(folder: Folder = Path("keys")) -> None:
    """Make a certificate authority (CA) of one's own, in a new folder that stays on this machine.

    Exit code: 0 made; 2 not, and nothing is changed.
    """
    from giraff_cli.keys import manage as it  # noqa: PLC0415

    raise typer.Exit(it.init(folder, it.now()))


@keys.command()
def host(
    name: Annotated[str, typer.Argument(metavar="NAME", help="As the access rules call the host.", show_default=False)],
    addresses: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ADDRESS",
            help="IP addresses and DNS names at which others reach it; its loopback is added.",
            show_default=False,
        ),
    ] = None,
    folder: Folder = Path("keys"),
    days: Annotated[int, typer.Option(metavar="N", min=1, max=3650, help="How long it is valid.")] = 730,
    renew: Annotated[bool, typer.Option("--renew", help="New certificate, new key; addresses as before.")] = False,
) -> None:
    """Make the bundle of a host: the folder that is copied to it as /etc/giraff/keys.

    Exit code: 0 made; 2 not, and nothing is changed.
    """
    from giraff_cli.keys import manage as it  # noqa: PLC0415

    raise typer.Exit(it.host(folder, name, addresses or (), days=days, renew=renew, moment=it.now()))


@keys.command("list")
def list_keys(
    folder: Folder = Path("keys"), as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False
) -> None:
    """The hosts that have keys, until when, and what is wrong with them.

    Exit code: 0 all is well; 1 there is something to do; 2 something cannot be read.
    """
    from giraff_cli.keys import manage as it  # noqa: PLC0415

    raise typer.Exit(it.show(folder, it.now(), as_json=as_json))


def _tell(
    robot: str | None,
    connect: list[str] | None,
    timeout: float,
    act: Callable[[Watcher], Told],
    lost: Callable[[], str] | None = None,
) -> None:
    from giraff_cli.network.command import UNUSABLE, visit  # noqa: PLC0415

    def tell(watcher: Watcher) -> int:
        code, text = act(watcher)
        typer.echo(text, err=code >= UNUSABLE)
        return code

    raise typer.Exit(visit(robot, connect or (), timeout, tell, lost))
