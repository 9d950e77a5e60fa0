from giraff_node.start import start

start("joystick")
