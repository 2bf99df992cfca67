"""The compiled part; src/lib.rs and the files beside it."""

import os
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = ["Renderer", "Scene", "Settings", "View", "compare", "devices"]

@final
class View:
    def __new__(
        cls, eye: list[float], look_at: list[float] | None, up: list[float], projection: str
    ) -> View: ...
    @property
    def axes(self) -> list[list[float]]: ...

@final
class Scene:
    @staticmethod
    def from_text(text: str, name: str) -> Scene: ...
    @staticmethod
    def from_file(path: str | os.PathLike[str]) -> Scene: ...
    @staticmethod
    def from_tables(
        size: list[int],
        near: float,
        window: list[float],
        view: View,
        positions: NDArray[Any],
        radii: NDArray[Any],
        colors: NDArray[Any],
        material: list[NDArray[Any]],
        lights: NDArray[Any],
        light_colors: NDArray[Any],
        background: list[float],
        ambient_light: list[float],
    ) -> Scene: ...
    def seen_from(self, view: View) -> Scene: ...
    def projected(self, projection: str) -> Scene: ...
    def text(self) -> str: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def spheres(self) -> int: ...
    @property
    def lights(self) -> int: ...
    @property
    def eye(self) -> list[float]: ...
    @property
    def projection(self) -> str: ...

@final
class Settings:
    def __new__(
        cls, convention: str, max_depth: int, samples: int, pattern: str, filter: str
    ) -> Settings: ...

@final
class Renderer:
    def __new__(cls, device: str) -> Renderer: ...
    @property
    def device(self) -> str | None: ...
    def render(
        self, scene: Scene, settings: Settings, precision: str, verify: str | None
    ) -> NDArray[np.uint8]: ...

def devices() -> list[str]: ...
def compare(
    a: NDArray[np.uint8] | str | os.PathLike[str],
    b: NDArray[np.uint8] | str | os.PathLike[str] | None,
    scene: Scene | None,
    renderer: Renderer | None,
    settings: Settings,
    precision: str,
) -> tuple[str, str | None, str]: ...
