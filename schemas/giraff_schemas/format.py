"""The number of the format of samples. Each recording carries it, and a reader of another number refuses the file."""

from typing import Final

SAME_VERSION: Final = "install the same version on all machines, and restart the services"
"""Remedy where two formats or versions meet."""

FORMAT: Final = 6
"""It rises with each change of a key, or of a field's name or type."""
DIGEST: Final = "eb5cd4bfa55603c5"
"""Digest of all keys, fields and types of this number, as `tests/rules/test_format.py` computes it."""
