import sys

from giraff_ros2.main import main

sys.exit(main())
