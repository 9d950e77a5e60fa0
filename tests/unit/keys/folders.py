"""Folders of keys for the tests."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

from giraff_setup.keys.manage import make_authority, make_bundle

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
DAY = timedelta(days=1)


def authority(folder: Path, moment: datetime = NOW) -> Path:
    """A new CA in this folder."""
    make_authority(folder, moment)
    return folder


def bundle(folder: Path, name: str = "robot", moment: datetime = NOW, *, days: int = 730, renew: bool = False) -> Path:
    """The bundle of a host at 10.0.0.1 and robot.lan."""
    make_bundle(folder, name, ["10.0.0.1", "robot.lan"], days=days, renew=renew, moment=moment)
    return folder / name


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
