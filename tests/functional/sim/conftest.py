"""What the tests of the simulator share, here as in tests/sim."""

from tests.sim.conftest import implementation

__all__ = ["implementation"]
