"""Reading and writing meshes: one file a format."""
