"""What is remembered: events of a run, and the recorders that keep them."""
