"""The options of `giraff run`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from giraff_cli.options import require_extra, require_service, require_tree

_REFUSED = 2  # exit code: nothing was started


def run(  # noqa: PLR0913, PLR0917  one argument an option
    file: Annotated[
        Path | None,
        typer.Option(metavar="FILE", exists=True, dir_okay=False, help="The robot file, instead of GIRAFF_CONFIG's."),
    ] = None,
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
    hand: Annotated[
        Literal["demo", "keyboard", "none"],
        typer.Option(help="Who drives: a scripted hand, you in this terminal, or nobody as yet."),
    ] = "demo",
    boards: Annotated[
        Literal["avr", "host"] | None,
        typer.Option(help="The real firmware on simavr, or the same C compiled for this machine.", show_default=False),
    ] = None,
    summary: Annotated[Path | None, typer.Option(metavar="FILE", help="Also write the summary as JSON.")] = None,
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the last live view as SVG.")] = None,
    web: Annotated[
        bool, typer.Option("--web", help="Also serve a page, to drive and watch it by phone or laptop.")
    ] = False,
    localize: Annotated[
        bool,
        typer.Option("--localize", help="Also look for it on the room's map; tell how far off that is."),
    ] = False,
    camera: Annotated[
        bool, typer.Option("--camera", help="Also give it a simulated camera; tell how that sees it move.")
    ] = False,
    local: Annotated[bool, typer.Option("--local", help="Keep off the network.")] = False,
) -> None:
    """Drive the simulated robot through its services, and watch it."""
    given = dict(locals())
    require_tree("run")
    from giraff_schemas.services import SERVICES  # noqa: PLC0415

    for service in SERVICES:
        if service.option and given[service.option]:
            require_service(f"run --{service.option}", service, "cli,sim")
    if web:
        require_extra("run --web", "segno", "cli,sim,web")  # it draws the code of an address
    from giraff_cli.run.begin import drive  # noqa: PLC0415
    from giraff_cli.run.plan import Options, PlanError, make_plan  # noqa: PLC0415

    try:
        plan = make_plan(Options(**given))
    except PlanError as error:
        typer.echo(f"giraff run: {error}", err=True)
        raise typer.Exit(_REFUSED) from None
    raise typer.Exit(drive(plan))
