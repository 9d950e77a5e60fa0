"""`giraff record --repair`: what a crash or damage has left, as a file that any tool opens."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from giraff_cli.record.report import Report, told
from giraff_mcap.reading import RecordingError
from giraff_mcap.repair import repair as repair_into
from giraff_tools.network.command import print_error
from giraff_tools.terminal.progress import Progress

_IS_MISSING: Final = 1


def repair(path: Path, output: Path | None, *, as_json: bool) -> int:
    """Return the exit code, 1 where anything is missing. The file itself is left as it is."""
    into = output or path.with_name(f"{path.stem}-repaired.mcap")
    try:
        with Progress("repairing", shown=not as_json) as progress:
            writer = repair_into(path, into, progress.move)
    except RecordingError as error:
        return print_error(str(error))
    except FileExistsError:
        return print_error(f"{into} is there already: name another with -o; nothing is ever written over")
    except OSError as error:
        return print_error(f"{into}: cannot be written: {error.strerror}")
    sys.stdout.write(told(Report.of(writer, f"the repair of {path}", 0), as_json=as_json))
    return _IS_MISSING if writer.unread else 0
