"""Where islands run: in this process, or on Ray."""
