"""The robot's description (URDF) by its robot file, for the RobotModel of rviz."""

from typing import Final
from xml.etree import ElementTree as ET

from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera, Sense, Ultrasonic
from giraff_ros2.messages.pose import fixed_parts
from giraff_schemas.frames import BASE_FRAME

# Sizes that no robot file tells. They are drawn, and nothing computes with them. m.
_BODY_HEIGHT: Final = 0.06
_WHEEL_RADIUS: Final = 0.033
_WHEEL_WIDTH: Final = 0.02
_SIZES: Final[dict[type[Sense], str]] = {Ultrasonic: "0.015 0.045 0.02", Camera: "0.02 0.03 0.03"}
_OTHER_SIZE: Final = "0.03 0.03 0.03"
_QUARTER: Final = "1.5707963267948966 0 0"
_BODY, _WHEEL, _PART = "0.8 0.6 0.2 1", "0.15 0.15 0.15 1", "0.2 0.4 0.8 1"


def urdf(robot: RobotConfig) -> str:
    """Return the description. Its joints are those of the static transforms, and all fixed."""
    root = ET.Element("robot", name=robot.name)
    base = ET.SubElement(root, "link", name=BASE_FRAME)
    _cylinder(base, f"0 0 {_WHEEL_RADIUS + _BODY_HEIGHT / 2:g}", "0 0 0", robot.footprint_radius, _BODY_HEIGHT, _BODY)
    # The wheels are drawn on the body: a link of their own would need a joint, and somebody who publishes its state.
    track = robot.kinematics.track_width
    for y in (track / 2, -track / 2):
        _cylinder(base, f"0 {y!r} {_WHEEL_RADIUS}", _QUARTER, _WHEEL_RADIUS, _WHEEL_WIDTH, _WHEEL)
    places = robot.sensor_transforms.items()
    sizes = {place.child: _SIZES.get(type(robot.sensors[name]), _OTHER_SIZE) for name, place in places}
    for part in fixed_parts(robot):
        link = ET.SubElement(root, "link", name=part.child)
        if part.child in sizes:
            ET.SubElement(_visual(link, "0 0 0", "0 0 0", _PART), "box", size=sizes[part.child])
        joint = ET.SubElement(root, "joint", name=f"{part.child}_joint", type="fixed")
        ET.SubElement(joint, "parent", link=part.parent)
        ET.SubElement(joint, "child", link=part.child)
        ET.SubElement(
            joint,
            "origin",
            xyz=f"{part.x!r} {part.y!r} {part.z!r}",
            rpy=f"{part.roll!r} {part.pitch!r} {part.yaw!r}",
        )
    return ET.tostring(root, encoding="unicode")


def _cylinder(link: ET.Element, xyz: str, rpy: str, radius: float, length: float, color: str) -> None:
    ET.SubElement(_visual(link, xyz, rpy, color), "cylinder", radius=repr(radius), length=repr(length))


def _visual(link: ET.Element, xyz: str, rpy: str, color: str) -> ET.Element:
    """Add something that is drawn, and return the element of its shape."""
    visual = ET.SubElement(link, "visual")
    ET.SubElement(visual, "origin", xyz=xyz, rpy=rpy)
    shape = ET.SubElement(visual, "geometry")
    # Each has its own name: URDF takes a second material of the same name for the first one.
    ET.SubElement(ET.SubElement(visual, "material", name=f"color {color}"), "color", rgba=color)
    return shape
