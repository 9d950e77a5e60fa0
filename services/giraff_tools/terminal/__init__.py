"""What is printed: screen, layout, tables, JSON, Ctrl-C. Knows no robot."""
