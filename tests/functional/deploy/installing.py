"""scripts/install on a copy of the tree, below a directory, with the true Python or with one that only seems to be."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Final

from giraff_sim.board import ROOT

TRUE_PYTHON: Final = Path(sys.executable).resolve()

# Makes something like a virtual environment in no time. PIP_FAILS: as without a network.
_SEEMING: Final = f"""#!/bin/sh
case $1 in
    -VV) echo "Python 3 of the test" ;;
    -c) exec {TRUE_PYTHON} "$@" ;;
    -m)
        mkdir -p "$3/bin" "$3/lib"
        echo "home = $3" >"$3/pyvenv.cfg"
        printf '#!/bin/sh\\nexec {sys.executable} "$@"\\n' >"$3/bin/python"
        printf '#!/bin/sh\\n# %s\\ntest -z "$PIP_FAILS"\\n' "$3" >"$3/bin/pip"
        touch "$3/bin/giraff"
        chmod +x "$3/bin/python" "$3/bin/pip"
        ;;
esac
"""


class Tree:
    """A copy of what an installation is made of, and the directory that it goes to."""

    def __init__(self, directory: Path) -> None:
        self.source = directory / "source"
        self.target = directory / "target"
        for name in ("scripts", "deploy", "requirements", "schemas", "services"):
            ignored = shutil.ignore_patterns("__pycache__", "build")
            shutil.copytree(ROOT / name, self.source / name, ignore=ignored, symlinks=True)
        (self.source / "docs").mkdir()
        for name in ("pyproject.toml", "README.md", "LICENSE", "docs/install.md"):
            shutil.copy(ROOT / name, self.source / name)
        self.seeming_python = directory / "seeming-python"
        self.seeming_python.write_text(_SEEMING)
        self.seeming_python.chmod(0o755)

    def install(self, **variables: str) -> tuple[int, str]:
        """Exit code and all words of the script."""
        given = {"DESTDIR": str(self.target), "ROLE": "", "PYTHON": str(self.seeming_python)}
        run = subprocess.run(
            [self.source / "scripts" / "install"],
            env=os.environ | given | variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        return run.returncode, run.stdout

    def installed(self, path: str) -> Path:
        return self.target / path.lstrip("/")
