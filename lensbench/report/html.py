"""Pages from the templates beside this file, and the pictures in them; text is escaped, a name that is missing is an error."""

import base64
from dataclasses import dataclass
from datetime import date
from typing import Any

from .. import __version__
from ..optics.conventions import VERSION


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of a page: file name, caption, PNG bytes."""

    name: str
    caption: str
    png: bytes

    @property
    def data_uri(self) -> str:
        """The picture as the page holds it."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


def picture_of(name: str, caption: str, picture: Any) -> Picture:
    """A figure or pixels (h, w, 3) as a picture of a page."""
    from ..views.maps import png_bytes

    return Picture(f"{name}.png", caption, png_bytes(picture))


def render(template: str, **values: Any) -> str:
    """A template as one HTML page; every page also knows today, version and conventions."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("lensbench", "report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    given = {"today": date.today().isoformat(), "version": __version__, "conventions": VERSION}
    return environment.get_template(template).render(given | values)
