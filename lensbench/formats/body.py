"""A lens's body as CAD, mesh and design files hold it: two surfaces and their distance, without material and side."""

from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import InputError
from ..optics.lens import Lens, Outline, circle_outline
from ..optics.materials import Material
from ..optics.surfaces import Surface

USUAL_DIAMETER = 60.0


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """front, back: None where the file holds one surface only; centre_thickness: mm; outline: None if the file has none.

    understood: how the file was read, a line each.
    """

    front: Surface | None
    back: Surface | None
    centre_thickness: float
    outline: Outline | None
    understood: tuple[str, ...]
    material: Material | None = None

    def lens(self, path: Path, material: Material | None = None, side: str = "R") -> Lens:
        """The lens of a material (which wins over the file's own) and a side. Raises InputError for what is missing."""
        from .lens_file import check_body

        if self.front is None or self.back is None:
            held = "front" if self.back is None else "back"
            raise InputError(
                f"{path}: holds one surface, taken for the {held}; a lens needs two: name it in a lens file"
            )
        chosen = material or self.material
        if chosen is None:
            raise InputError(f"{path}: says nothing of the material; name one (--material MR-8)")
        outline = self.outline or circle_outline(USUAL_DIAMETER)
        lens = Lens(self.front, self.back, self.centre_thickness, chosen, outline, side, name=path.stem)
        check_body(path, lens)
        return lens

    def surface(self, name: str, path: Path) -> Surface:
        """The surface called "front" or "back"; a file of one surface gives that. Raises InputError."""
        found = self.front if name == "front" else self.back
        found = found or self.front or self.back
        if found is None:
            raise InputError(f"{path}: holds no surface")
        return replace(found)
