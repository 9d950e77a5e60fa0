"""The emergency stop: its latch, and how those who are not base ask for it and for its release."""
