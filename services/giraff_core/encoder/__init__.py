"""The disk of a two-channel encoder: its drawing, and the edges that two light sensors see on it."""
