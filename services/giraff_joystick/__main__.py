import sys

from giraff_node.start import start

sys.exit(start("joystick"))
