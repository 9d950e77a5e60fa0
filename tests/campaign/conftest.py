"""What all campaigns share: boards and simulator that are built from the sources which their records name."""

from __future__ import annotations

import subprocess

import pytest

from giraff_sim.board import ROOT


@pytest.fixture(scope="session", autouse=True)
def built_of_these_sources() -> None:
    """As `make campaign` has it; where pytest alone began, what an earlier day left would be run."""
    subprocess.run([ROOT / "scripts" / "setup"], check=True)
