"""`giraff odom`: reset, set."""
