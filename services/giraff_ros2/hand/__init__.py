"""From what ROS publishes on `/cmd_vel` to an operator's hand."""
