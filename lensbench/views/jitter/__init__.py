"""What the wearer sees, drawn by multipass vertex jitter on VTK.

Each vertex is drawn at its apparent direction for the point d of the pupil, at its true distance, so that what is nearer
hides what is farther in every pass; the passes over many d are averaged in linear light.
Source: Kakimoto, Tatsukawa & Nishita 2010; here one pass moves all vertices in the vertex shader.
"""

from .light import decode, encode
from .picture import Studio, render_view, side_by_side
from .view_pass import JitterPass

__all__ = ["JitterPass", "Studio", "decode", "encode", "render_view", "side_by_side"]
