"""`giraff encoder`: parts of an encoder that one makes oneself."""
