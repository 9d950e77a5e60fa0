"""`giraff graph`: who publishes what to whom."""
