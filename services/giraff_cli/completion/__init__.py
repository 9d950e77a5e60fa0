"""`giraff completion`: what the TAB key of a shell completes."""
