from giraff_ros2.main import main

main()
