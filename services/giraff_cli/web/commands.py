"""The options of `giraff web`. What it does is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import Connect, Robot, require_extra, require_service


def web(
    robot: Robot = None,
    connect: Connect = None,
    port: Annotated[
        int | None,
        typer.Option(metavar="N", min=0, max=65535, help="Else 8443, or any that is free.", show_default=False),
    ] = None,
    devices: Annotated[bool, typer.Option("--devices", help="List the pages that are open on this host.")] = False,
    end: Annotated[
        str | None,
        typer.Option(metavar="DEVICE", help="End one of them: its number, device or address.", show_default=False),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="For programs: the addresses as an object a line, or the pages.")
    ] = False,
) -> None:
    """Serve a page for phones and laptops: watch, STOP and drive a robot; no robot file is needed.

    Open an address that is printed, or scan its code: the first device that opens it may drive, by tilting, touch or
    keys. Whoever else opens the page watches, and may stop. It takes the robot from nobody. Ctrl-C ends it, and whoever
    drives by it stops.

    --devices lists the pages that are open at this host's page services, and --end ends one. Its device may watch after
    a reload, and needs a new address to drive.

    Exit code: 0; 1 it failed; 2 there is no robot that tells its limits, no port, no page service or no such page.
    """
    if devices or end is not None:
        if robot or connect or port is not None or (devices and end is not None):
            raise typer.BadParameter("--devices and --end each stand alone: they ask the page services of this host")
        from giraff_cli.web import devices as pages  # noqa: PLC0415

        raise typer.Exit(pages.list_devices(as_json=as_json) if end is None else pages.end_device(end, as_json=as_json))
    from giraff_schemas.services import WEB  # noqa: PLC0415

    require_service("web", WEB, "cli")
    require_extra("web", "segno", "cli,web")  # it draws the code of an address
    from giraff_cli.web.serve import serve  # noqa: PLC0415

    raise typer.Exit(serve(robot, connect or (), port, as_json=as_json))
