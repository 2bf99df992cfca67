"""Pictures."""

from __future__ import annotations

import warnings
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from . import _native
from ._arguments import integer
from ._scene import Scene

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def devices() -> list[str]:
    """The Vulkan devices, in words; the place of one in the list is a name for it."""
    return _native.devices()


@lru_cache(maxsize=8)
def renderer(device: str) -> _native.Renderer:
    """What renders on a device. It stays open, since it keeps the kernels that it has compiled."""
    opened = _native.Renderer(device)
    if device == "auto" and opened.device is None:
        warnings.warn(
            "there is no Vulkan device: the CPU reference renders, which device='cpu' asks for",
            RuntimeWarning,
            stacklevel=3,
        )
    return opened


def settings_of(
    scene: Scene | None, convention: str | None, max_depth: int, samples: int | None, pattern: str, filter: str
) -> _native.Settings:
    """The settings; what is None is as the scene has it."""
    if convention is None:
        convention = scene.convention if scene else "classic"
    if samples is None:
        samples = scene.samples if scene else 1
    depth = integer("max_depth", max_depth, 0, 1000)
    return _native.Settings(convention, depth, integer("samples", samples, 1, 256), pattern, filter)


def projected(scene: Scene, projection: str | None) -> _native.Scene:
    """The scene in another projection than its own, if there is one."""
    return scene._packed if projection is None else scene._packed.projected(projection)


def render(
    scene: Scene | ArrayLike,
    radii: ArrayLike | None = None,
    colors: ArrayLike | None = None,
    *,
    device: str | int = "auto",
    precision: str = "auto",
    convention: str | None = None,
    max_depth: int = 3,
    samples: int | None = None,
    pattern: str = "grid",
    filter: str = "box",
    projection: str | None = None,
    verify: str | int | None = None,
    **arrays: Any,
) -> NDArray[np.uint8]:
    """The picture of a scene, (height, width, 3).

    scene: a `Scene`, or the positions of spheres; then `radii`, `colors` and all further arguments are those of
    `Scene.from_arrays`.
    device: auto, gpu, cpu, an index of `devices()`, or a part of a name. auto is the best device, or the CPU reference
    with a warning where there is none.
    precision: auto, fast, robust, double, or certified for the reference's picture in every pixel.
    convention: classic or exact. max_depth: greatest number of reflections.
    samples: a pixel, up to 256. pattern: how they are placed, on a regular grid of a square number of them, or on a
    fibonacci lattice of any number. filter: how a lattice is spread over the pixel and around it; box, tent or gaussian.
    projection: perspective, or orthographic, which shows the window's own width and height of the world; None is as the
    scene has it.
    verify: how many pixels the CPU reference calculates again: a number, all, or none.

    Other threads run while it renders.
    """
    given: dict[str, Any] = {name: value for name, value in (("radii", radii), ("colors", colors)) if value is not None}
    if not isinstance(scene, Scene):
        if projection is not None:
            given["projection"] = projection
        scene = Scene.from_arrays(scene, **given, **arrays)
    elif given or arrays:
        raise TypeError(f"{next(iter({**given, **arrays}))}: a Scene has all of this already")
    settings = settings_of(scene, convention, max_depth, samples, pattern, filter)
    count = None if verify is None else str(verify)
    return renderer(str(device)).render(projected(scene, projection), settings, precision, count)
