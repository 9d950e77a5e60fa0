"""The committed codec is what the protocol header gives."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from tests.rules.repository import ROOT

HEADER = Path("firmware/common/protocol.h")
GENERATOR = Path("firmware/generate_codec.py")
CODEC = Path("schemas/giraff_schemas/wire.py")


def check(tree: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(tree / GENERATOR), "--check"]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def test_the_codec_is_generated_from_the_header() -> None:
    run = check(ROOT)
    assert run.returncode == 0, run.stdout + run.stderr


def test_an_edited_codec_shows(tmp_path: Path) -> None:
    for path in (HEADER, GENERATOR, CODEC):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    assert check(tmp_path).returncode == 0
    with (tmp_path / CODEC).open("a") as codec:
        codec.write("EXTRA = 1\n")
    assert check(tmp_path).returncode != 0
