"""The table `[ros2]` of the robot file."""

import re
from typing import Annotated, ClassVar, Final, Literal

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.network import host_and_port
from giraff_core.tuning import Tuning
from giraff_schemas.topics import require_chunk

_NAMESPACE: Final = re.compile(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)


def endpoint(host: str, port: int) -> str:
    """Return an address as Zenoh writes it."""
    return f"tcp/[{host}]:{port}" if ":" in host else f"tcp/{host}:{port}"


class Ros2Config(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The way to ROS 2, and the robot's names there."""

    LIVE: ClassVar = Tuning.READ_ONLY

    operator: str = "ros2"
    """Name under which the commands of `/cmd_vel` are published: `cmd_vel/<operator>`."""
    namespace: str = ""
    """Namespace of the robot's topics, like "r1" for `/r1/odom`; empty: `/odom`. Each of several robots needs one."""
    domain: Annotated[int, Bounds(0, 232)] = 0
    """`ROS_DOMAIN_ID` of the ROS processes. It separates, it does not protect."""
    distribution: Literal["humble", "jazzy", "kilted"] = "kilted"
    """ROS 2 distribution of the ROS processes. Jazzy and Kilted hear each other. Humble hears neither of them."""
    router: str = "127.0.0.1:7447"
    """Address of the Zenoh router of the ROS processes. Where nobody answers there and it is an address of this host,
    this service is the router."""

    def __post_init__(self) -> None:
        require_chunk(self.operator)
        check_bounds(self)
        if self.namespace and not _NAMESPACE.fullmatch(self.namespace):
            raise ValueError(
                f"namespace is {self.namespace!r}: write names of ROS, like r1 or lab/r1, without a slash first"
            )
        host_and_port(self.router, "router")
