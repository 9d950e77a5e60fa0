"""Types of ROS messages: their hashes, and CDR. All of it is rosbags', by the message definitions of a distribution."""

from typing import Any, Final, Literal

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

Distribution = Literal["humble", "jazzy", "kilted"]
_STORES: Final = {"humble": Stores.ROS2_HUMBLE, "jazzy": Stores.ROS2_JAZZY, "kilted": Stores.ROS2_KILTED}
_NO_HASH: Final = "TypeHashNotSupported"
"""Humble writes it for every type."""
_TRIGGER: Final = "std_srvs/srv/Trigger"
_TRIGGER_HASH: Final = "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"
"""As std_srvs of Jazzy and Kilted has it in its Trigger.json."""
_TRIGGER_RESPONSE: Final = "std_srvs/msg/Trigger_Response"


class TornError(Exception):
    """A payload is not of its type."""


class Definitions:
    """Types of one distribution."""

    def __init__(self, distribution: Distribution) -> None:
        self._has_hashes = distribution != "humble"
        self._store = get_typestore(_STORES[distribution])
        self._store.register(get_types_from_msg("bool success\nstring message\n", _TRIGGER_RESPONSE))

    def hash_of(self, type_name: str) -> str:
        """Return the hash that keys and tokens have."""
        if not self._has_hashes:
            return _NO_HASH
        return _TRIGGER_HASH if type_name == _TRIGGER else self._store.hash_rihs01(type_name)

    def encode(self, message: Any, type_name: str) -> bytes:
        """Return the CDR of a message of rosbags' class for Kilted. Humble's lacks fields that came later."""
        return bytes(self._store.serialize_cdr(message, type_name))

    def decode(self, data: bytes, type_name: str) -> Any:
        """Return the message. Raises TornError."""
        try:
            return self._store.deserialize_cdr(data, type_name)
        except (SerdeError, ValueError, ArithmeticError, MemoryError) as error:
            raise TornError(f"its payload of {len(data)} bytes is no {type_name}") from error

    def trigger_response(self, *, success: bool, message: str) -> bytes:
        """Return the CDR of an answer of std_srvs/srv/Trigger."""
        response = self._store.types[_TRIGGER_RESPONSE]
        return self.encode(response(success=success, message=message), _TRIGGER_RESPONSE)
