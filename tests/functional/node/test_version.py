"""A version tells programs apart that the number alone does not."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from giraff_node.process.version import version
from tests.rules.repository import ROOT


def test_other_sources_have_another_version(tmp_path: Path) -> None:
    assert re.fullmatch(r"\d+\.\d+\.\d+-[0-9a-f]{8}", version())
    shutil.copytree(ROOT / "schemas", tmp_path / "schemas")
    print_it = [sys.executable, "-c", "from giraff_node.process.version import version; print(version())"]
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "schemas")}
    told = []
    for change in ("", "# changed\n"):
        with (tmp_path / "schemas" / "giraff_schemas" / "messages.py").open("a") as source:
            source.write(change)
        told.append(
            subprocess.run(print_it, env=environment, check=True, capture_output=True, text=True).stdout.strip()
        )
    assert told[0] == version()
    assert told[1] != version()
