"""python -m giraff_sim.camera"""

import sys

from giraff_sim.camera.main import main

sys.exit(main())
