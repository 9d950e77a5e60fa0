"""A file that a command makes, where none of that name is yet."""

from __future__ import annotations

from pathlib import Path


def require_fresh(path: Path) -> None:
    """Raise ValueError, with the cause and the remedy, unless `write_fresh` can make this file now."""
    try:
        write_fresh(path, "")
        path.unlink()
    except FileExistsError as error:
        raise ValueError(f"{path} is there already: name another file, or delete it first") from error
    except FileNotFoundError as error:
        raise ValueError(f"{path} cannot be written: there is no such folder; make it, or name another") from error
    except OSError as error:
        raise ValueError(f"{path} cannot be written: {error.strerror}; name another file") from error


def write_fresh(path: Path, text: str) -> None:
    """Write a file that is not there yet. A piece of it serves nobody and is deleted."""
    with path.open("x", encoding="utf-8") as fresh:
        try:
            fresh.write(text)
            fresh.flush()
        except OSError:
            path.unlink()
            raise
