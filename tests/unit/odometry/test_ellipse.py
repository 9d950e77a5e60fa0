"""The ellipse that odometry claims, against where drawn robots truly are."""

import pytest

from tests.unit.odometry.ellipses import PATHS, Path, held


@pytest.mark.parametrize("path", PATHS)
def test_the_ellipse_holds_most_robots_that_nobody_has_calibrated(path: Path) -> None:
    found = held(path, range(10))
    print(f"{path.__name__}: holds {found.share:.0%}; {found.area:.3f} m², {found.least:.3f} would hold 95 %")
    assert found.share >= 0.8
