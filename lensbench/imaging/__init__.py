"""Pictures of the scene as seen, with what the optics know of each pixel; no graphics library."""
