"""Decides whether measurements determine the numbers that are fitted to them: each processor gives the same answer.

The last bits of a sum differ from processor to processor. One of them finds a singular matrix regular, for which
another one raises an error. A bound on the condition decides instead.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

_LEAST: Final = 1e-10
"""Smallest eigenvalue of a normal matrix, as a share of the largest one, that still tells something.

Rounding, also that of slopes by differences, leaves less than 1e-11 where nothing is told. The drives and pictures of
the tests that tell something have 1e-8 or more.
"""


def is_determined(normal: NDArray[np.float64], *, are_alike: bool = False) -> bool:
    """Tell whether a normal matrix determines each unknown. `are_alike`: the unknowns have one unit and size."""
    diagonal = np.diag(normal)
    if not np.isfinite(normal).all() or not (diagonal > 0.0).all():
        return False
    size = np.ones(len(normal)) if are_alike else np.sqrt(diagonal)
    values = np.linalg.eigvalsh(normal / np.outer(size, size))
    return bool(values[0] > _LEAST * values[-1])
