"""`giraff view`: a robot or a recording, drawn in rerun."""
