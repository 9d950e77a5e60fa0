"""python -m giraff_health SERVICE: exit 0 when the service is well, 1 when it is not, 2 when it does not answer.

It prints the whole answer of a service that is well, and what is wrong, a line each, of one that is not. Docker's
check, which must cost less, is wait.sh.
"""

import os
import socket
import sys
import time
from collections.abc import Mapping

TIMEOUT = 2.0  # s; a loop that turns answers within a tenth of a second
WELL = b'"ok":true'  # no text within the answer can hold this: there a quotation mark has a backslash before it

_HANGS = f"its loop has not turned for {TIMEOUT:g} s: it hangs, or this machine is overloaded"
_EXPLANATIONS: dict[type[OSError], str] = {
    FileNotFoundError: "it does not run, or not with this $RUNTIME_DIRECTORY",
    ConnectionRefusedError: "it has died without a word; see its log",
    ConnectionResetError: "it ended just now",
    PermissionError: "not permitted; ask as root, or as the user that the service runs as",
    TimeoutError: _HANGS,
    BlockingIOError: _HANGS,  # so many have asked before that no more can wait
}


def socket_path(service: str, environment: Mapping[str, str] = os.environ) -> str:
    """Where a service answers: below $RUNTIME_DIRECTORY, else where systemd's unit has it."""
    given = environment.get("RUNTIME_DIRECTORY", "").partition(":")[0]
    return f"{given or f'/run/giraff/{service}'}/{service}.sock"


def ask(path: str, timeout: float = TIMEOUT) -> bytes:
    """The answer, one JSON line. Raises OSError, such as TimeoutError, when there is none within `timeout` s."""
    deadline = time.monotonic() + timeout
    answer = b""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
        client.settimeout(timeout)
        client.connect(path)
        while not answer.endswith(b"\n"):
            client.settimeout(max(0.001, deadline - time.monotonic()))
            received = client.recv(65536)
            if not received:
                raise ConnectionResetError
            answer += received
    return answer


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or not arguments[0].isidentifier():
        print("usage: python -m giraff_health SERVICE, like base or guard")
        return 2
    (service,) = arguments
    path = socket_path(service)
    try:
        answer = ask(path)
    except OSError as error:
        print(f"{service} does not answer at {path}: {_EXPLANATIONS.get(type(error), error)}")
        return 2
    if WELL in answer:
        print(answer.decode(errors="replace"), end="")
        return 0
    return _unwell(service, answer)


def _unwell(service: str, answer: bytes) -> int:
    import json  # noqa: PLC0415  each service imports this module for the path alone

    try:
        faults = list(map(_line, json.loads(answer)["faults"]))
    except (ValueError, KeyError, TypeError, RecursionError):
        print(f"{service}: not an answer of a service of this version: {answer[:200]!r}")
        return 2
    print("\n".join(faults or [f"{service} is not well and does not say why"]))
    return 1


def _line(fault: dict[str, str]) -> str:
    """Return a fault as `giraff_schemas.trouble` does. Nothing is imported here that a service has not."""
    command = f"run `{fault['argument']}`" if fault["action"] == "run" else ""
    remedy = ", then ".join(filter(None, (fault["remedy"], command)))
    return "; ".join(filter(None, (fault["what"], remedy)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
