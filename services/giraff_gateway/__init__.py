"""Lines of text between any Arduino and the network."""
