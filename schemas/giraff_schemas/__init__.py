"""What Giraff's services say to each other, and what hosts and boards say over the serial line."""
