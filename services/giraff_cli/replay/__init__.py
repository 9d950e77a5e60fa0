"""`giraff replay`: run policies over a recording, and compare."""
