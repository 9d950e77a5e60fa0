"""In the place of giraff_localization, beside a real robot: it knows where the robot is, by odometry alone."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import zenoh

from giraff_core.kinematics.pose import Pose
from giraff_node import Publisher
from giraff_schemas.codec import decode
from giraff_schemas.localization import LocalizationState, MapPose
from giraff_schemas.messages import Odometry
from giraff_schemas.topics import ODOM, POSE, key_of
from tests.support.map_poses import map_pose
from tests.support.talker import INSTANCE, talker

_EVERY = 0.1  # s


class Locating:
    """What it says."""

    def __init__(self, odom: Pose) -> None:
        self.odom = odom
        self.state: LocalizationState = "lost"
        self.newest: Odometry | None = None

    def hear(self, received: zenoh.Sample) -> None:
        """Take where the robot is in `odom`."""
        self.newest = decode(ODOM, str(received.key_expr), bytes(received.payload), str(received.encoding))

    def talk(self, publisher: Publisher[MapPose], ended: threading.Event) -> None:
        """Until it has ended."""
        while not ended.wait(_EVERY):
            if (newest := self.newest) is not None:
                here = Pose(newest.x, newest.y, newest.yaw)
                publisher.put(map_pose(self.odom, here, newest.tick, self.state))


@contextmanager
def locating(rendezvous: str, robot: str, odom: Pose) -> Iterator[Locating]:
    """Says where the robot is as long as the block lasts; `odom`: where that is in `map`."""
    made, ended = Locating(odom), threading.Event()
    with talker(rendezvous, robot, "localization") as it:
        it.session.declare_subscriber(key_of(robot, ODOM), made.hear)
        publisher = Publisher(it.session, robot, POSE, INSTANCE)
        thread = threading.Thread(target=made.talk, args=(publisher, ended))
        thread.start()
        try:
            yield made
        finally:
            ended.set()
            thread.join()
