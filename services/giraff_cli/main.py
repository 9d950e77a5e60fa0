"""The `giraff` command: its verbs in groups. A verb's module is imported when the verb is typed."""

from collections.abc import Iterator, Mapping, MutableMapping
from importlib import import_module
from typing import Annotated, Any, Final

import typer
from typer.core import TyperGroup
from typer.main import get_command, get_group, solve_typer_info_help
from typer.models import TyperInfo

from giraff_cli.options import NEGATIVE
from giraff_cli.usage import first_sentence, with_plain_help

GROUPS: Final[Mapping[str, Mapping[str, str]]] = {
    "Drive": {
        **dict.fromkeys(("move", "turn", "arc", "go"), "motion"),
        **{verb: verb for verb in ("run", "drive", "web", "ros2", "estop")},
        "stop": "estop",
    },
    "Watch": {verb: verb for verb in ("watch", "view", "top", "camera", "localize")},
    "Ask": {verb: verb for verb in ("why", "doctor", "logs", "topic", "node", "param", "graph", "frames", "odom")},
    "Record": {verb: verb for verb in ("record", "play", "replay", "vision")},
    "Set up": {
        verb: verb
        for verb in ("commission", "check", "calibrate", "tune", "encoder", "map", "place", "keys", "completion")
    },
    "Develop": {verb: verb for verb in ("dst",)},
}
"""By the heading of its section in the help: each verb with the folder of its module `commands`."""
_FOLDERS: Final = {verb: folder for verbs in GROUPS.values() for verb, folder in verbs.items()}
_ATTRIBUTES: Final = {"map": "maps"}
"""Names in the module that differ from the verb: Python has a `map` of its own."""
_TAKES_NUMBERS: Final = {"move", "turn", "arc", "go"}


class _Verbs(Mapping[str, Any]):
    """Typer's commands by verb. A look at one imports it; the names cost nothing."""

    def __init__(self) -> None:
        self._built: dict[str, Any] = {}

    def __iter__(self) -> Iterator[str]:
        return iter(_FOLDERS)

    def __len__(self) -> int:
        return len(_FOLDERS)

    def __contains__(self, verb: object) -> bool:
        return verb in _FOLDERS

    def __getitem__(self, verb: str) -> Any:
        if verb not in self._built:
            command: Any = _built(verb)
            command.name = verb
            self._built[verb] = with_plain_help(command, verb)
        return self._built[verb]


class VerbGroup(TyperGroup):
    """The command line of all verbs, which imports the one that is typed."""

    def __init__(self, *, commands: MutableMapping[str, Any] | None = None, **more: Any) -> None:
        super().__init__(**more)
        del commands  # Typer knows of none
        verbs: Any = _Verbs()
        self.commands = verbs

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the verbs."""
        del ctx
        return list(self.commands)

    def shell_complete(self, ctx: Any, incomplete: str) -> list[Any]:
        """Return what a shell may complete: verbs, with their help, and options."""
        from typer._click.shell_completion import CompletionItem  # noqa: PLC0415

        verbs = [verb for verb in self.commands if verb.startswith(incomplete)]
        items = [CompletionItem(verb, help=first_sentence(_help(_imported(verb)))) for verb in verbs]
        return items + super(TyperGroup, self).shell_complete(ctx, incomplete)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write a section for each group."""
        del ctx
        for heading, verbs in GROUPS.items():
            with formatter.section(heading):
                formatter.write_dl([(verb, first_sentence(_help(_imported(verb)))) for verb in verbs], col_max=12)


def _imported(verb: str) -> Any:
    module = import_module(f"giraff_cli.{_FOLDERS[verb]}.commands")
    return getattr(module, _ATTRIBUTES.get(verb, verb))


def _built(verb: str) -> Any:
    """Typer's command of a verb. Raises KeyError."""
    found = _imported(verb)
    if isinstance(found, typer.Typer):
        return get_group(found)
    alone = typer.Typer(add_completion=False)
    alone.command(context_settings=NEGATIVE if verb in _TAKES_NUMBERS else None)(found)
    return get_command(alone)


def _help(found: Any) -> str:
    """Return the help of what a module has for a verb, without its options, which take Typer long to build."""
    return solve_typer_info_help(TyperInfo(found)) if isinstance(found, typer.Typer) else found.__doc__ or ""


def _print_version(asked: bool) -> None:
    if asked:
        from giraff_node.process.version import version  # noqa: PLC0415

        typer.echo(f"giraff {version()}")
        raise typer.Exit


app = typer.Typer(
    name="giraff",
    cls=VerbGroup,
    help="A masterless multi-machine robot.",
    epilog="Example: giraff run",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def giraff(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Number and digest of the program."),
    ] = False,
) -> None:
    """A masterless multi-machine robot."""
    del version
