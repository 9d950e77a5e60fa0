# An Arduino with ros_arduino_bridge on a serial line of the robot's computer, where a process runs the base board's program.
FIRMWARE := base
ENCODERS := counted
CONTROLLER := ros_arduino_bridge
