"""`giraff watch`: a live view of one robot."""
