"""Any desk: the robot as ROS 2 sees one of its own, over rmw_zenoh. Nothing of ROS is installed."""
