"""Where eye, window and lights are when nobody has said it."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, radians, sin, tan
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ._arguments import Table

#: From the middle of the scene to the eye: from the front, a little from the right and from above.
TOWARDS_EYE = (0.25, 0.35, 1.0)
#: Free room around the scene.
ROOM = 1.03
#: The image plane's distance in radii of the scene; what is nearer to the eye is not seen.
NEAR = 1e-3
#: The angle from the lower to the upper edge of a picture, in degrees.
FOV = 40.0
#: Lights: how far to the right, upwards and towards the eye, in radii of the scene, and how bright.
LIGHTS = ((-2.5, 4.0, 3.5, 0.75), (4.0, 1.0, 2.0, 0.25))


@dataclass(frozen=True)
class Extent:
    """A ball around all spheres."""

    middle: tuple[float, float, float]
    radius: float

    @staticmethod
    def of(positions: Table, semi_axes: Table) -> Extent:
        """Without spheres it is the unit ball."""
        if len(positions) == 0:
            return Extent((0.0, 0.0, 0.0), 1.0)
        reach = np.abs(semi_axes).max(axis=1).astype(np.float64)
        low = (positions - reach[:, None]).min(axis=0)
        high = (positions + reach[:, None]).max(axis=0)
        middle = (low + high) / 2
        # In a unit of its own size, so that squares are in range.
        unit = max(float((high - low).max()), np.finfo(float).tiny)
        radius = float(((np.linalg.norm((positions - middle) / unit, axis=1) + reach / unit).max()) * unit)
        return Extent((float(middle[0]), float(middle[1]), float(middle[2])), radius)

    def window(
        self, fov: float | None, size: tuple[int, int], near: float, projection: str
    ) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of a window with square pixels: `fov` degrees high, or around the whole ball."""
        columns, rows = size
        if projection != "orthographic":
            fov = FOV if fov is None else fov
            if not 0 < fov < 180:
                raise ValueError(f"fov: expected an angle between 0 and 180 degrees, not {fov}")
            top = near * tan(radians(fov) / 2)
        elif fov is None:
            top = ROOM * self.radius * max(1.0, rows / columns)
        else:
            raise ValueError("fov: an orthographic picture has no field of view, window says how much it shows")
        right = top * columns / rows
        return -right, right, -top, top

    def eye(self, window: tuple[float, float, float, float], near: float, projection: str) -> list[float]:
        """From where the whole ball is in the window, or, where rays are parallel, beyond it."""
        towards = np.asarray(TOWARDS_EYE) / np.linalg.norm(TOWARDS_EYE)
        if projection == "orthographic":
            away = near + ROOM * self.radius
        else:
            narrowest = min(abs(edge) for edge in window)
            # A window with its middle elsewhere has no such place: then it is as if the narrowest edge were as far as the others.
            away = ROOM * self.radius / sin(atan((narrowest or near) / near))
        return [float(x) for x in np.asarray(self.middle) + towards * away]

    def lights(self, axes: Table) -> tuple[Table, Table]:
        """Positions and colours of a bright light and a dim one, by the axes of the picture."""
        places = np.asarray(LIGHTS)
        return self.middle + places[:, :3] * self.radius @ axes, np.repeat(places[:, 3:], 3, axis=1)
