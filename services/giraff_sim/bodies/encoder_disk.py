"""The disk that a simulated robot's encoders read, from the drawing that is printed for a real one."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

from giraff_core.encoder_disk import LONGEST, Edge, Pattern, read_pattern


def read_disk(path: str) -> Pattern:
    """Return the edges of the drawing in a file, from a place on where both channels are low. Raises ValueError."""
    try:
        with Path(path).open("rb") as file:
            text = file.read(LONGEST + 1).decode()  # a little more than is read, so that a longer file is refused
        return _from_low(read_pattern(text))
    except OSError as error:
        raise ValueError(f"encoder_disk of [sim]: {path} cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        reason = "it is no text" if isinstance(error, UnicodeDecodeError) else error
        raise ValueError(f"encoder_disk of [sim]: {path}: {reason}") from error


def mirrored(pattern: Pattern) -> Pattern:
    """Return the edges of a disk that turns the other way, for the encoder whose channel B a base board has inverted.

    The board's mirrored wiring inverts B for a motor that looks the other way. B is inverted here as well, so that the
    pins have the levels of the disk.
    """
    states, edges = pattern
    before = [edges[-1], *edges]
    turned = [Edge(-edge.at % 1.0, left.a, not left.b) for left, edge in pairwise(before)]
    return _from_low(Pattern(states, tuple(sorted(turned))))


def _from_low(pattern: Pattern) -> Pattern:
    """Begin the turn where both channels become low, as the pins of a board are at its start, if they ever do."""
    states, edges = pattern
    first = next((edge.at for edge in edges if not (edge.a or edge.b)), edges[0].at)
    return Pattern(states, tuple(sorted(edge._replace(at=(edge.at - first) % 1.0) for edge in edges)))
