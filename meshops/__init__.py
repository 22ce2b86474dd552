"""What can be done to a mesh, and how good it is."""
