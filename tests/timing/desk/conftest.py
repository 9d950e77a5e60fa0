"""For each file a robot, and a desk beside it, as the functional tests have them."""

from tests.functional.desk.conftest import desk, robot

__all__ = ["desk", "robot"]
