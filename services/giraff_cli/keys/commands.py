"""The verbs of `giraff keys`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, require_extra

keys = typer.Typer(no_args_is_help=True)

Folder = Annotated[Path, typer.Option(metavar="FOLDER", help="Where the CA and all bundles are kept.")]


@keys.callback()
def needs_cryptography() -> None:
    """Certificates by which hosts know each other: see docs/keys.md."""
    require_extra("keys", "cryptography", "cli,keys")


@keys.command()
def init(folder: Folder = Path("keys"), as_json: AsJson = False) -> None:
    """Make a certificate authority (CA) of one's own, in a new folder that stays on this machine.

    Exit code: 0 made; 2 not, and nothing is changed.
    """
    from giraff_setup.keys import manage  # noqa: PLC0415

    raise typer.Exit(manage.init(folder, manage.now(), as_json=as_json))


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
    as_json: AsJson = False,
) -> None:
    """Make the bundle of a host: the folder that is copied to it as /etc/giraff/keys.

    Exit code: 0 made; 2 not, and nothing is changed.
    """
    from giraff_setup.keys import manage  # noqa: PLC0415

    raise typer.Exit(
        manage.host(folder, name, addresses or (), days=days, renew=renew, moment=manage.now(), as_json=as_json)
    )


@keys.command("list")
def list_keys(folder: Folder = Path("keys"), as_json: AsJson = False) -> None:
    """The hosts that have keys, until when, and what is wrong with them.

    Exit code: 0 all is well; 1 there is something to do; 2 something cannot be read.
    """
    from giraff_setup.keys import manage  # noqa: PLC0415

    raise typer.Exit(manage.show(folder, manage.now(), as_json=as_json))
