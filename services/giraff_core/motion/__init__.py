"""The side of whoever asks giraff_motion for a motion: when to hold on to it, and how it has ended."""
