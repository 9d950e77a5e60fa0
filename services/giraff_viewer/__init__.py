"""A robot on rerun's screen: what was heard of it becomes what is drawn. Only a desk needs it."""
