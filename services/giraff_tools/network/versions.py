"""Tell which versions run on the machines of one robot: two formats of samples do not understand each other."""

from collections.abc import Iterable

from giraff_schemas.format import SAME_VERSION
from giraff_schemas.health import Health
from giraff_schemas.trouble import NO_TROUBLE, Trouble


def version_trouble(host: str, version: str, answers: Iterable[Health]) -> Trouble:
    """Return which versions run where. NO_TROUBLE: all are the `version` of this command on `host`."""
    places = {version: {f"{host} (this command)"}}
    for health in answers:
        places.setdefault(health.version, set()).add(f"{health.host} ({health.service})")
    if len(places) == 1:
        return NO_TROUBLE
    told = "; ".join(f"{running} on {', '.join(sorted(where))}" for running, where in places.items())
    return Trouble(f"versions differ: {told}", SAME_VERSION)
