# A RoboClaw on a serial line of the robot's computer, where a process runs the base board's program.
FIRMWARE := base
ENCODERS := counted
CONTROLLER := roboclaw
