"""Somebody to ask: a socket that answers what the test says, or nothing."""

import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def check(directory: Path | str, *arguments: str) -> tuple[int, str]:
    """Exit code and words of the program."""
    environment = os.environ | {"RUNTIME_DIRECTORY": str(directory)}
    command = [sys.executable, "-m", "giraff_health", *arguments]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)
    assert run.stderr == ""
    return run.returncode, run.stdout


@contextmanager
def answering(directory: Path, *parts: bytes, then_silent: bool = False) -> Iterator[None]:
    """Answer one client at `base.sock` with these bytes."""
    done = threading.Event()
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(directory / "base.sock"))
        listener.listen()

        def answer() -> None:
            client, _ = listener.accept()
            with client:
                for part in parts:
                    client.send(part)
                if then_silent:
                    done.wait(600.0)

        thread = threading.Thread(target=answer, daemon=True)
        thread.start()
        yield
        done.set()
        thread.join(60.0)
