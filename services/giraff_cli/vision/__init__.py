"""`giraff vision`: visual odometry of pictures that were taken before."""
