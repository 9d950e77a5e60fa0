"""Measurements of the robot and of the operator's hand as ROS messages. NaN stands for what is not known."""

import math
from typing import Final

import numpy as np
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Quaternion as Quaternion
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3
from rosbags.typesys.stores.ros2_kilted import sensor_msgs__msg__BatteryState as BatteryState
from rosbags.typesys.stores.ros2_kilted import sensor_msgs__msg__CompressedImage as CompressedImage
from rosbags.typesys.stores.ros2_kilted import sensor_msgs__msg__Imu as Imu
from rosbags.typesys.stores.ros2_kilted import sensor_msgs__msg__Range as RosRange

from giraff_core.senses import Ultrasonic
from giraff_ros2.messages.header import header, single
from giraff_ros2.messages.pose import optical_frame
from giraff_schemas.camera import Picture
from giraff_schemas.frames import range_frame
from giraff_schemas.messages import Battery, Range, Tilt

HAND_FRAME: Final = "hand_link"
"""Frame of the sensor in the operator's hand. It is in no other frame: nobody knows where the hand is."""
NEAREST: Final = 0.02
"""m. Least range of an HC-SR04 by its data sheet."""
_NOT_MEASURED: Final = -1.0  # first number of a covariance, as sensor_msgs/Imu defines it
_WITHOUT_ECHO: Final = {"clear": math.inf, "fault": math.nan}  # REP-117


def range_reading(sample: Range, sensor: Ultrasonic) -> RosRange:
    """Return a reading: +inf where nothing answered, NaN where the sensor has a fault."""
    return RosRange(
        header(sample.stamp_ns, range_frame(sample.sensor)),
        RosRange.ULTRASOUND,
        field_of_view=2.0 * sensor.half_cone,
        min_range=NEAREST,
        max_range=sensor.reach,
        range=_WITHOUT_ECHO[sample.state] if sample.range is None else single(sample.range),
        variance=0.0,  # unknown
    )


def imu(sample: Tilt) -> Imu | None:
    """Return the hand's acceleration; None while the sensor does not run."""
    if sample.status != "running":
        return None
    absent = np.array([_NOT_MEASURED, *(0.0,) * 8])
    return Imu(
        header(sample.stamp_ns, HAND_FRAME),
        Quaternion(0.0, 0.0, 0.0, 1.0),
        absent,
        Vector3(0.0, 0.0, 0.0),
        absent.copy(),
        Vector3(sample.x, sample.y, sample.z),
        np.zeros(9),  # unknown
    )


def battery(sample: Battery) -> BatteryState:
    """Return the battery's voltage. Nothing else of it is measured."""
    none = np.zeros(0, dtype=np.float32)
    return BatteryState(
        header(sample.stamp_ns, ""),
        voltage=single(sample.voltage),
        temperature=math.nan,
        current=math.nan,
        charge=math.nan,
        capacity=math.nan,
        design_capacity=math.nan,
        percentage=math.nan,
        power_supply_status=BatteryState.POWER_SUPPLY_STATUS_UNKNOWN,
        power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_UNKNOWN,
        power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_UNKNOWN,
        present=True,
        cell_voltage=none,
        cell_temperature=none.copy(),
        location="",
        serial_number="",
    )


def picture(sample: Picture) -> CompressedImage:
    """Return a camera's picture as it is."""
    return CompressedImage(
        header(sample.stamp_ns, optical_frame(sample.camera)), "jpeg", np.frombuffer(sample.jpeg, dtype=np.uint8)
    )
