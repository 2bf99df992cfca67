"""Pictures of spheres and ellipsoids, on any Vulkan device, checked against a CPU reference.

>>> picture = render([[0, 0, 0], [2, 0, 0]], 1.0, [[1.0, 0.5, 0.2], [0.2, 0.5, 1.0]])
>>> picture.shape
(480, 640, 3)
"""

from ._compare import Comparison, compare
from ._errors import DeviceError, Error, PictureError, SceneError
from ._render import devices, render
from ._scene import Scene

__all__ = [
    "Comparison",
    "DeviceError",
    "Error",
    "PictureError",
    "Scene",
    "SceneError",
    "compare",
    "devices",
    "render",
]
