"""Screen, tables, JSON, questions and Ctrl-C of a terminal. It knows no robot."""
