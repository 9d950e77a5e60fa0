"""Keys, tokens, QoS and attachments as rmw_zenoh_cpp 0.6 writes and reads them. No I/O.

Source: https://github.com/ros2/rmw_zenoh, `rmw_zenoh_cpp/src/detail/liveliness_utils.cpp` and `attachment_helpers.cpp`.
"""

import struct
from typing import Final, NamedTuple

import xxhash

from giraff_ros2.topics import Qos

_SPACE: Final = "@ros2_lv"
_DEFAULT_DEPTH: Final = 42
_GID_SIZE: Final = 16
_ATTACHMENT: Final = struct.Struct(f"<qqB{_GID_SIZE}s")
_NODE_PARTS: Final = 9
_ENDPOINT_PARTS: Final = (13, 14)
"""Lyrical adds a part for types with buffers."""


def dds_type(type_name: str) -> str:
    """Return a type as keys have it: std_srvs::srv::dds_::Trigger_ of std_srvs/srv/Trigger."""
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def key_of(domain: int, name: str, type_name: str, type_hash: str) -> str:
    """Return the key of a topic or service. `name`: with its namespace, like /r1/odom."""
    return f"{domain}/{name.strip('/')}/{dds_type(type_name)}/{type_hash}"


def qos_text(qos: Qos) -> str:
    """Return a QoS as tokens have it, where what is default is empty."""
    depth = "" if qos.depth == _DEFAULT_DEPTH else str(qos.depth)
    return f"{'' if qos.is_reliable else '2'}:{'1' if qos.is_latched else ''}:,{depth}:,:,:,,"


def token_space(domain: int) -> str:
    """Return the key expression of all tokens of a domain."""
    return f"{_SPACE}/{domain}/**"


class Entity(NamedTuple):
    """A node, publisher, subscription, service or client, as its liveliness token tells."""

    session: str
    """Zenoh id of its process."""
    node_id: int
    id: int
    """Counted in its session. A node's is the node's id."""
    kind: str
    """NN, MP, MS, SS or SC."""
    namespace: str
    node: str
    name: str = ""
    """Name of the topic or service, with its namespace; empty for a node."""
    type: str = ""
    """As keys have it."""
    type_hash: str = ""
    qos: str = ""

    @property
    def full_node(self) -> str:
        """Name of its node, with its namespace."""
        return f"{self.namespace.rstrip('/')}/{self.node}"

    def token(self, domain: int) -> str:
        """Return the key of its token. The enclave is none."""
        parts = [_SPACE, str(domain), self.session, str(self.node_id), str(self.id), self.kind, "%"]
        parts += [_escaped(self.namespace), self.node]
        if self.kind != "NN":
            parts += [_escaped(self.name), self.type, self.type_hash, self.qos]
        return "/".join(parts)


def gid_of(token: str) -> bytes:
    """Return the id of the entity of a token: XXH3-128 of it, low 64 bits first, each little-endian."""
    number = xxhash.xxh3_128_intdigest(token.encode())
    return struct.pack("<QQ", number & 0xFFFF_FFFF_FFFF_FFFF, number >> 64)


def entity_of(token: str) -> Entity | None:
    """Return what a token tells; None: it is none of rmw_zenoh's, as one of a later release may be."""
    parts = token.split("/")
    if parts[0] != _SPACE or len(parts) not in (_NODE_PARTS, *_ENDPOINT_PARTS) or not all(parts):
        return None
    _, _, session, node_id, entity_id, kind, _, namespace, node, *rest = parts
    if not (session.isalnum() and node_id.isdecimal() and entity_id.isdecimal()):
        return None
    name, type_name, type_hash, qos = rest[:4] if rest else ("", "", "", "")
    return Entity(
        session, int(node_id), int(entity_id), kind, _plain(namespace), node, _plain(name), type_name, type_hash, qos
    )


class Attachment(NamedTuple):
    """Each sample and each call carries it beside its payload."""

    sequence: int
    """From 1, without gaps."""
    sent_ns: int
    """Wall clock of the sender's host, ns since 1970."""
    gid: bytes
    """Id of the sender's publisher or client."""

    def encode(self) -> bytes:
        return _ATTACHMENT.pack(self.sequence, self.sent_ns, _GID_SIZE, self.gid)


def attachment_of(data: bytes) -> Attachment | None:
    """Return what an attachment tells; None: it is none of rmw_zenoh's, or of a release before spring 2025."""
    if len(data) != _ATTACHMENT.size:
        return None
    sequence, sent_ns, size, gid = _ATTACHMENT.unpack(data)
    return Attachment(sequence, sent_ns, gid) if size == _GID_SIZE else None


def _escaped(name: str) -> str:
    return name.replace("/", "%")


def _plain(name: str) -> str:
    return name.replace("%", "/")
