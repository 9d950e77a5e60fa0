"""The TAB key of real shells completes `giraff`, and expands nothing."""

import os
import shutil
import sys
from pathlib import Path
from typing import Final

import pytest

from tests.support.terminals import screen

_SHELLS: Final = {
    "bash": (["--norc", "--noprofile", "-i"], "source <(giraff completion bash)"),
    "zsh": (["-f", "-i"], "source <(giraff completion zsh)"),
    "fish": (["--no-config", "-i"], "giraff completion fish | source"),
}
_REQUIRED: Final = {"bash", "zsh"}
"""Shells that `make setup` sees to. The other is tried where it is installed."""
_TYPED: Final = (
    ("giraff comple", "[giraff][completion]"),
    ("giraff topic pub rang", "[giraff][topic][pub][range/*]"),
    ("giraff topic pub odom --con", "[giraff][topic][pub][odom][--connect]"),
    ("giraff param set guard.run_", "[giraff][param][set][guard.run_on]"),
    ("giraff param get guar", "[giraff][param][get][guard.]"),
    ("giraff run --boards=a", "[giraff][run][--boards=avr]"),
    ("giraff map show ha", "[giraff][map][show][hall $(touch bad).toml]"),
)
"""What is typed before TAB, and the words that the shell then has."""


@pytest.mark.parametrize("shell", [shell for shell in _SHELLS if shell in _REQUIRED or shutil.which(shell)])
def test_the_tab_key_completes(shell: str, tmp_path: Path) -> None:
    (tmp_path / "hall $(touch bad).toml").touch()
    (tmp_path / "range").mkdir()
    (tmp_path / "range" / "expanded").touch()  # by a shell that takes a candidate for a pattern
    environment = {
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "HOME": str(tmp_path),
        "TERM": "xterm",
        "GIRAFF_NETWORK_LOCAL": "true",
        "GIRAFF_CONFIG": os.devnull,
    }
    options, ready = _SHELLS[shell]
    assert shutil.which(shell), f"{shell} is missing: make setup installs it"
    with screen([str(shutil.which(shell)), *options], tmp_path / "errors", environment) as shown:
        shown.type(f"cd {tmp_path}; {ready}; printf '%s-' all is set\n".encode())
        shown.wait_for("all-is-set-", 30.0)
        for words, expected in _TYPED:
            shown.forget()
            shown.type(words.encode() + b"\t\x01printf '[%s]' \n")
            shown.wait_for(expected)
    assert not (tmp_path / "bad").exists()
