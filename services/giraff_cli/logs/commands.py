"""The options of `giraff logs`. What it does is imported when it is asked for."""

from typing import Annotated, Literal

import typer

from giraff_cli.options import AsJson


def logs(
    services: Annotated[
        list[str] | None, typer.Argument(metavar="[SERVICE]...", help="Only of these; else of all.")
    ] = None,
    follow: Annotated[
        bool, typer.Option("-f", "--follow", help="Go on until Ctrl-C, from the last 10 lines of each.")
    ] = False,
    level: Annotated[Literal["info", "warning", "error"], typer.Option(help="Only what is as bad or worse.")] = "info",
    since: Annotated[
        str | None, typer.Option(metavar="TIME", help="Like 10min, 2h, 14:30 or 2026-05-31T14:30.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show what the services of this host write: units, containers and `giraff run`, in order of time.

    Of `giraff run`: what goes on, else the last one that failed. Exit code: 0; 2 there is nothing to read.
    """
    from giraff_cli.logs.show import show  # noqa: PLC0415

    raise typer.Exit(show(services or (), follow=follow, level=level, since=since, as_json=as_json))
