"""The table `[door]` of the robot file. Where it listens is in `[network]`."""

import msgspec


class DoorConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Nothing to set: whatever a door needs to know, the network's table says."""
