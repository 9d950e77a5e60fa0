"""`giraff web --devices` and `--end`: the pages that are open at this host's page services."""

import contextlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from giraff_schemas.text import printable
from giraff_tools.network.command import UNUSABLE, print_error
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json, print_table
from giraff_tools.terminal.text import duration
from giraff_web.messages import OpenPage
from giraff_web.server.host import PATIENCE, Answer, Ask, ask, sockets

_DONE: Final = 0
_NOBODY: Final = (
    "no page service of this user runs on this host; start one with giraff web, or ask on the host that serves the "
    "page, as the user who started it or as root"
)


class _PageMatch(NamedTuple):
    """A page, and the service that has it."""

    path: Path
    of: Answer
    page: OpenPage

    @property
    def number(self) -> str:
        """It differs from every other one's of this host."""
        return f"{self.of.port}/{self.page.page}"

    def is_called(self, wanted: str) -> bool:
        """Whether this text names it: its number, its device, or one of the two halves of that."""
        kind, _, address = self.page.device.rpartition(" at ")
        names = (str(self.page.page), self.number, self.page.device, kind, address)
        return wanted.strip().casefold() in (name.casefold() for name in names if name)


def list_devices(*, as_json: bool) -> int:
    """Print the open pages; return the exit code."""
    return guard_stdout(lambda: _list(*_ask_all(), as_json=as_json))


def end_device(device: str, *, as_json: bool) -> int:
    """End the only page that is called so; return the exit code."""
    return guard_stdout(lambda: _end(device, *_ask_all(), as_json=as_json))


def _ask_all() -> tuple[dict[Path, Answer], list[str]]:
    """The answers of this host's services, and why others gave none."""
    answers, faults = {}, []
    for path in sockets():
        try:
            answers[path] = ask(path, Ask())
        except ConnectionRefusedError:  # its service has died without a word, and left it
            with contextlib.suppress(OSError):
                path.unlink()
        except (FileNotFoundError, ConnectionResetError):  # it ends just now
            continue
        except (OSError, ValueError) as error:
            faults.append(_why(path, error))
    return answers, faults


def _why(path: Path, error: OSError | ValueError) -> str:
    if isinstance(error, PermissionError):
        return f"{path}: not permitted; ask as root, or as the user that the page service runs as"
    if isinstance(error, TimeoutError):
        return f"{path}: no answer for {PATIENCE:g} s: the page service hangs; start it again"
    if isinstance(error, OSError):
        return f"{path}: {error.strerror or error}; start the page service again"
    return f"{path}: no page service of this version answers there; start it again"


def _list(answers: dict[Path, Answer], faults: Sequence[str], *, as_json: bool) -> int:
    if as_json and answers:
        print_json([_as_object(answer) for answer in answers.values()])
        return _told(answers, faults)
    for answer in answers.values():
        print(
            f"{printable(answer.robot)}, port {answer.port}: {'' if answer.pages else 'no page is open'}".rstrip(": ")
        )
        if answer.pages:
            print_table(
                (">page", "device", "address", ">open for", "state"), (_row(answer, page) for page in answer.pages)
            )
    return _told(answers, faults)


def _as_object(answer: Answer) -> dict[str, Any]:
    return {
        "robot": answer.robot,
        "port": answer.port,
        "pages": [{**msgspec.structs.asdict(page), "drives": page.page == answer.driver} for page in answer.pages],
    }


def _row(answer: Answer, page: OpenPage) -> tuple[str, ...]:
    kind, _, address = page.device.rpartition(" at ")
    does = "drives" if page.page == answer.driver else "may drive" if page.may_drive else "watches"
    return str(page.page), kind, address, duration(page.age), does


def _told(answers: dict[Path, Answer], faults: Sequence[str]) -> int:
    """Print what is wrong; the exit code."""
    for fault in faults if answers or faults else (_NOBODY,):
        print_error(fault)
    return _DONE if answers else UNUSABLE


def _end(wanted: str, answers: dict[Path, Answer], faults: Sequence[str], *, as_json: bool) -> int:
    if not answers:
        return _told(answers, faults)
    pages = [_PageMatch(path, answer, page) for path, answer in answers.items() for page in answer.pages]
    found = [each for each in pages if each.is_called(wanted)]
    if not found:
        there = "; ".join(_name(each) for each in pages) or "none"
        return print_error(f"no open page is called {printable(wanted)!r}; there are: {there}")
    if len(found) > 1:
        there = "; ".join(_name(each) for each in found)
        return print_error(f"{len(found)} pages are called {printable(wanted)!r}: {there}; end one by its number")
    (page,) = found
    try:
        ended = ask(page.path, Ask(end=page.page.page)).ended
    except (OSError, ValueError) as error:
        return print_error(_why(page.path, error))
    if as_json:
        print_json({"port": page.of.port, "page": page.page.page, "device": page.page.device, "ended": ended})
    else:
        print(f"{_name(page)} {'is ended' if ended else 'was closed already'}")
    return _DONE


def _name(found: _PageMatch) -> str:
    return f"{found.number} ({printable(found.page.device)})"
