"""What a host's folder of keys says of itself, for those who cannot read certificates: `bundle.toml`.

`giraff keys` writes it; the certificate beside it decides. The robot has no library that could read that one.
"""

from datetime import datetime, timedelta
from pathlib import Path
from typing import Annotated, Final

import msgspec

from giraff_schemas.text import plain
from giraff_schemas.trouble import NO_TROUBLE, Trouble

CA_CERTIFICATE: Final = "ca.pem"
HOST_CERTIFICATE: Final = "host.pem"
HOST_KEY: Final = "host.key"
BUNDLE_FILE: Final = "bundle.toml"
EXPIRES_SOON: Final = timedelta(days=30)  # from then on everyone who sees it says so
BACKDATED: Final = timedelta(days=1)  # home machines' clocks disagree; one that keeps local time as UTC, by hours
COPY_AGAIN: Final = "copy this host's bundle there again"

_Moment = Annotated[datetime, msgspec.Meta(tz=True)]


class BundleError(Exception):
    """The file says nothing; the text says why."""


class KeyBundle(msgspec.Struct, frozen=True, kw_only=True):
    """Whose keys they are, and until when."""

    name: str
    """The host, as the access rules call it."""
    addresses: tuple[str, ...]
    """Where others reach it."""
    made: _Moment
    expires: _Moment


class ExpiryWatch:
    """Says when the keys that a process has started with are about to fail it."""

    def __init__(self, folder: Path) -> None:
        self._bundle: KeyBundle | None = None
        self._why_not = NO_TROUBLE
        try:
            self._bundle = read_bundle(folder)  # once: Zenoh, too, has its keys from the start
        except BundleError as error:
            self._why_not = Trouble(f"nobody is warned before this host's keys expire: {error}", COPY_AGAIN)

    def warning(self, now: datetime) -> Trouble:
        """What is wrong or soon will be."""
        if self._bundle is None:
            return self._why_not
        name, left = self._bundle.name, self._bundle.expires - now
        if now < self._bundle.made - BACKDATED:
            early = f"the keys of {name} are not valid yet: this machine's clock says {now:%Y-%m-%d %H:%M} UTC"
            return Trouble(early, "set it")
        if left >= EXPIRES_SOON:
            return NO_TROUBLE
        when = (
            f"expire on {self._bundle.expires:%Y-%m-%d}" if left > timedelta() else "have expired, no link comes about"
        )
        renew = f"`giraff keys host {name} --renew`, copy them here, restart the services"
        return Trouble(f"the keys of {name} {when}", renew)


def read_bundle(folder: Path) -> KeyBundle:
    """What the bundle in this folder says of itself. Raises BundleError."""
    path = folder / BUNDLE_FILE
    try:
        return msgspec.toml.decode(path.read_bytes(), type=KeyBundle)
    except OSError as error:
        raise BundleError(f"{path} cannot be read: {error.strerror}") from error
    except (msgspec.MsgspecError, ValueError, RecursionError) as error:
        raise BundleError(f"{path} is damaged: {plain(error)}") from error
