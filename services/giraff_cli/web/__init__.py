"""`giraff web`: a page to watch and drive a robot, for the browsers around."""
