"""The options of `giraff web`. What it does is imported when it is asked for."""

from __future__ import annotations

from typing import Annotated

import typer

from giraff_cli.options import Connect, Robot, require_extra


def web(
    robot: Robot = None,
    connect: Connect = None,
    port: Annotated[
        int | None,
        typer.Option(metavar="N", min=0, max=65535, help="Else 8443, or any that is free.", show_default=False),
    ] = None,
) -> None:
    """Serve a page for phones and laptops: watch, STOP and drive a robot; no robot file is needed.

    Open an address that is printed, or scan its code: the first device that opens it may drive, by tilting, touch or
    keys. Whoever else opens the page watches, and may stop. It takes the robot from nobody. Ctrl-C ends it, and whoever
    drives by it stops. Exit code: 0; 1 it failed; 2 there is no robot that tells its limits, or no port.
    """
    for library in ("aiohttp", "cryptography", "segno"):
        require_extra("web", library, "cli,web")
    from giraff_cli.web.serve import serve  # noqa: PLC0415

    raise typer.Exit(serve(robot, connect or (), port))
