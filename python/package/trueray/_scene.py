"""Scenes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from . import _native
from ._arguments import color, column, integer, lengths, number, numbered, semi_axes, shades, triples
from ._framing import NEAR, Extent

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

#: The greatest side of a picture.
MAX_SIDE = 1 << 24


class Scene:
    """Spheres, lights and an eye. Scenes do not change, and may be rendered by several threads at once."""

    __slots__ = ("_packed", "convention", "samples")

    _packed: _native.Scene
    #: The convention that `render` follows unless it is told another: classic for files, exact for arrays.
    convention: str
    #: The samples a pixel that `render` takes unless it is told other ones: 1 for files, 4 for arrays.
    samples: int

    def __init__(self) -> None:
        raise TypeError("use Scene.from_arrays, Scene.from_text or Scene.from_file")

    @classmethod
    def _of(cls, packed: _native.Scene, convention: str, samples: int) -> Scene:
        scene = cls.__new__(cls)
        scene._packed, scene.convention, scene.samples = packed, convention, samples
        return scene

    @classmethod
    def from_text(cls, text: str, name: str = "scene") -> Scene:
        """The scene that `text` says in trueray's scene format; errors call it `name`."""
        return cls._of(_native.Scene.from_text(text, name), "classic", 1)

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Scene:
        """The scene of a file in trueray's scene format. It is rendered as `trueray render` does."""
        return cls._of(_native.Scene.from_file(path), "classic", 1)

    @classmethod
    def from_arrays(
        cls,
        positions: ArrayLike,
        radii: ArrayLike = 1.0,
        colors: ArrayLike = (0.8, 0.8, 0.8),
        *,
        ambient: ArrayLike = 1.0,
        diffuse: ArrayLike = 1.0,
        specular: ArrayLike = 0.3,
        reflection: ArrayLike = 0.0,
        exponent: ArrayLike = 40.0,
        transmission: ArrayLike = 0.0,
        eta: ArrayLike = 1.0,
        lights: ArrayLike | None = None,
        light_colors: ArrayLike | None = None,
        ambient_light: ArrayLike = 0.25,
        background: ArrayLike = (0.09, 0.1, 0.12),
        size: tuple[int, int] = (640, 480),
        eye: ArrayLike | None = None,
        look_at: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float | None = None,
        near: float | None = None,
        window: ArrayLike | None = None,
        projection: str = "perspective",
    ) -> Scene:
        """The scene of N spheres or ellipsoids.

        Lists and arrays of any real type are taken; float64, float32 and uint8 are read where they lie.

        positions: centres, (N, 3).
        radii: a number, (N,), or (N, 3) for the semi-axes of ellipsoids; not 0.
        colors: (N, 3) or (3,), in 0..1, or uint8 in 0..255.
        ambient, diffuse, specular, reflection, transmission: weights of the terms of a colour; each a number or (N,).
        exponent: of the specular term, at least 0. eta: index of refraction, more than 0.
        lights: positions of point lights, (M, 3). Without them a bright and a dim one light what the eye sees.
        light_colors: (M, 3), (3,) or a number; 1 by default.
        ambient_light, background: (3,) or a grey.
        size: columns and rows of the picture.
        eye, look_at, up: where the eye is, where it looks, what is upwards. Without them all spheres are in the picture.
        fov: angle between lower and upper edge, in degrees; 40 by default. `window` = (left, right, bottom, top) on the
        image plane replaces it.
        near: distance of the image plane; what lies nearer is not seen. By default 1 with a window, next to nothing
        without.
        projection: perspective, or orthographic: rays are parallel, so there is no `fov`, and the window has the width and
        the height of what it shows; without one all spheres are in it.
        """
        centers = triples("positions", lengths("positions", positions))
        count = len(centers)
        axes = semi_axes("radii", radii, count)
        if np.shape(size) != (2,):
            raise ValueError(f"size: expected columns and rows, not {size!r}")
        columns, rows = (integer("size", side, 1, MAX_SIDE) for side in size)
        extent = Extent.of(centers, axes)
        if near is None:
            near = 1.0 if window is not None else NEAR * extent.radius
        near = number("near", near)
        if near <= 0:
            raise ValueError(f"near: expected a number greater than 0, not {near}")
        usual = extent.window(None if fov is None else number("fov", fov), (columns, rows), near, projection)
        left, right, bottom, top = usual if window is None else numbered("window", window, 4)
        view = _native.View(
            extent.eye((left, right, bottom, top), near, projection) if eye is None else numbered("eye", eye, 3),
            list(extent.middle) if look_at is None else numbered("look_at", look_at, 3),
            numbered("up", up, 3),
            projection,
        )
        if lights is None:
            places, glow = extent.lights(np.asarray(view.axes))
        else:
            places, glow = triples("lights", lengths("lights", lights)), np.ones(3)
        if light_colors is not None:
            glow = shades("light_colors", light_colors)
        if glow.ndim == 0:
            glow = np.broadcast_to(glow, 3)
        packed = _native.Scene.from_tables(
            [columns, rows],
            near,
            [left, right, bottom, top],
            view,
            centers,
            axes,
            triples("colors", shades("colors", colors), count),
            [
                column("ambient", ambient, count),
                column("diffuse", diffuse, count),
                column("specular", specular, count),
                column("reflection", reflection, count),
                column("exponent", exponent, count),
                column("transmission", transmission, count),
                column("eta", eta, count),
            ],
            places,
            triples("light_colors", glow, len(places)),
            color("background", background),
            color("ambient_light", ambient_light),
        )
        return cls._of(packed, "exact", 4)

    def seen_from(
        self,
        eye: ArrayLike,
        look_at: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        projection: str | None = None,
    ) -> Scene:
        """The same scene from another eye, which without `look_at` looks along −z; spheres are shared.

        `projection` is that of the scene, if it is None.
        """
        target = None if look_at is None else numbered("look_at", look_at, 3)
        projection = self.projection if projection is None else projection
        view = _native.View(numbered("eye", eye, 3), target, numbered("up", up, 3), projection)
        return self._of(self._packed.seen_from(view), self.convention, self.samples)

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows of the picture."""
        return self._packed.size

    @property
    def eye(self) -> tuple[float, float, float]:
        """Where the eye is."""
        x, y, z = self._packed.eye
        return x, y, z

    @property
    def projection(self) -> str:
        """perspective or orthographic."""
        return self._packed.projection

    def __len__(self) -> int:
        """How many spheres there are."""
        return self._packed.spheres

    def text(self) -> str:
        """The scene in trueray's scene format, which has no words for eye and projection: those are the command line's."""
        return self._packed.text()

    def __repr__(self) -> str:
        width, height = self.size
        return f"<Scene of {len(self)} spheres and {self._packed.lights} lights, {width} x {height}>"
