"""The pictures of a robot's cameras, for a command."""

from functools import partial

from giraff_core.picture.receiver import PictureReceiver
from giraff_node.picture_client import PictureClient
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.program import user_at_host


def pictures_for(connection: RobotConnection, verb: str) -> PictureReceiver:
    """Return what looks at the cameras in the name of the user who typed this verb. It is to be closed."""
    by = f"{user_at_host()} (giraff {verb})"
    return PictureReceiver(partial(PictureClient, connection.network, connection.robot), by)
