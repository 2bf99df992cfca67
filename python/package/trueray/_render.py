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


def settings_of(scene: Scene | None, convention: str | None, max_depth: int, samples: int | None) -> _native.Settings:
    """The settings; what is None is as the scene has it."""
    if convention is None:
        convention = scene.convention if scene else "classic"
    if samples is None:
        samples = scene.samples if scene else 1
    depth = integer("max_depth", max_depth, 0, 1000)
    return _native.Settings(convention, depth, integer("samples", samples, 1, 256))


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
    verify: str | int | None = None,
    **arrays: Any,
) -> NDArray[np.uint8]:
    """The picture of a scene, (height, width, 3).

    scene: a `Scene`, or the positions of spheres; then `radii`, `colors` and all further arguments are those of
    `Scene.from_arrays`.
    device: auto, gpu, cpu, an index of `devices()`, or a part of a name. auto is the best device, or the CPU reference
    with a warning where there is none.
    precision: auto, fast, robust, double, or certified for the reference's picture in every pixel.
    convention: classic or exact. samples: a pixel, a square number. max_depth: greatest number of reflections.
    verify: how many pixels the CPU reference calculates again: a number, all, or none.

    Other threads run while it renders.
    """
    given: dict[str, Any] = {name: value for name, value in (("radii", radii), ("colors", colors)) if value is not None}
    if not isinstance(scene, Scene):
        scene = Scene.from_arrays(scene, **given, **arrays)
    elif given or arrays:
        raise TypeError(f"{next(iter({**given, **arrays}))}: a Scene has all of this already")
    settings = settings_of(scene, convention, max_depth, samples)
    count = None if verify is None else str(verify)
    return renderer(str(device)).render(scene._packed, settings, precision, count)
