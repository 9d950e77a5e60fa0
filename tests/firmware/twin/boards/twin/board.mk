# A TW-2 on a serial line of the robot's computer, where a process runs the base board's program.
FIRMWARE := base
ENCODERS := counted
CONTROLLER := twin
