"""What the wearer looks at: textured meshes in the wear frame, and which of their points a ray meets first."""
