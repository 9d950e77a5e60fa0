"""Why a frame cannot be told in another. Each message names the cause and the way out."""

from __future__ import annotations


class FrameError(Exception):
    """Whatever stands between two frames."""


class UnknownFrameError(FrameError):
    """Nobody has told of such a frame."""


class UnconnectedError(FrameError):
    """Both frames are known, and nothing joins them."""


class PastError(FrameError):
    """The moment is before what is remembered, or of a clock that is over."""


class FutureError(FrameError):
    """Nothing of that moment, or of a later one, has been heard yet."""


class GapError(FrameError):
    """The robot did not come from the sample before that moment to the one after it, or nobody can tell how."""
