"""The Qt window's room: the only place that may import Qt."""
