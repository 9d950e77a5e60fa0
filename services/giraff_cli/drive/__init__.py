"""`giraff drive`: the keyboard as an operator, on one screen."""
