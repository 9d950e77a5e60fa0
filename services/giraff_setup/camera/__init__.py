"""`giraff calibrate camera`: a camera's lens from a chessboard, its height and tilt from a sheet on the floor."""
