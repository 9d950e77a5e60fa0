from giraff_odometry.main import main

main()
