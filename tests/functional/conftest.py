"""Which functional tests come to one worker, after each other (`--dist=loadgroup`)."""

from __future__ import annotations

from pathlib import Path

import pytest

_HERE = Path(__file__).parent
_SHARED = _HERE / "one_robot"
"""Its files share a robot, which is dear to start and dearer to keep."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Make a group of each file, since its tests share what they have started, and one of all that share a robot."""
    for item in items:
        if item.path.is_relative_to(_HERE):
            group = _SHARED if item.path.is_relative_to(_SHARED) else item.path
            item.add_marker(pytest.mark.xdist_group(str(group.relative_to(_HERE))))
