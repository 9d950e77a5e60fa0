"""Which picture of a camera is taken by who wants one. No clock and no I/O."""

from __future__ import annotations

from typing import Final

from giraff_schemas.camera import Picture

_FULL_WITHIN: Final = 2.0
"""s after the first small picture in which a full one comes, where the link carries it."""


class PictureChoice:
    """Prefers a full picture, and takes small ones where no full one comes: everybody begins with small ones."""

    def __init__(self) -> None:
        self._since: float | None = None
        self._small: Picture | None = None

    def choose(self, picture: Picture | None, full_width: int, now: float) -> Picture | None:
        """Take what has come, and return the picture that counts; None: wait for a better one.

        `full_width`: px of a full picture. `now`: s of any one monotonic clock.
        """
        if picture is not None:
            if picture.width >= full_width:
                self._small = None
                return picture
            self._since = now if self._since is None else self._since
            self._small = picture
        return self.give_up() if self._since is not None and now - self._since >= _FULL_WITHIN else None

    def give_up(self) -> Picture | None:
        """Return the newest small picture that was not taken; None: there is none."""
        picture, self._small = self._small, None
        return picture
