"""What all campaigns share: boards that are built from the sources which their records name."""

from __future__ import annotations

import subprocess

import pytest

from giraff_sim.board import ROOT


@pytest.fixture(scope="session", autouse=True)
def boards_of_these_sources() -> None:
    """Firmware for the real boards and for this machine; nothing is done where both are up to date."""
    for target in ("all", "host"):
        subprocess.run(["make", "--no-print-directory", "-C", ROOT / "firmware", target], check=True)
