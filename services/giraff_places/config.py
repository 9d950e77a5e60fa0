"""The table `[places]` of the robot file."""

import msgspec


class PlacesConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Nothing has to be set: the floor plan is the one that `map` of [localization] names."""
