"""Comparison of pictures."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _native
from ._render import projected, renderer, settings_of
from ._scene import Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Source = Union[NDArray[np.uint8], str, os.PathLike[str]]


@dataclass(frozen=True)
class Comparison:
    """How two pictures differ, and what explains it. `str()` has all of it as a table."""

    #: Pixels that differ.
    differing: int
    #: The greatest difference of a channel, 0 to 255.
    max_level: int
    #: Mean of the absolute difference over all samples, in levels.
    mean: float
    #: Pixels of `a` that no rounding error explains; None without a scene.
    unexplained: int | None
    #: What `trueray compare --json` has of the difference.
    difference: dict[str, Any]
    #: What it has of the explanation; None without a scene.
    explanation: dict[str, Any] | None
    _report: str

    def __str__(self) -> str:
        return self._report


def compare(
    a: Source,
    b: Source | None = None,
    scene: Scene | None = None,
    *,
    device: str | int = "auto",
    precision: str = "auto",
    convention: str | None = None,
    max_depth: int = 3,
    samples: int | None = None,
    pattern: str = "grid",
    filter: str = "box",
    projection: str | None = None,
) -> Comparison:
    """Where and how the pictures differ; each is an array (height, width, 3) of uint8 or the name of a PPM or PNG file.

    With a scene, each pixel in which `a` differs from the picture of the scene's CPU reference is judged: rounding
    explains it or not. That picture is also `b` where there is none. `device` and `precision` say as whose picture `a`
    is judged; they and the other arguments are those of `render`.
    """
    if b is None and scene is None:
        raise ValueError("b: expected a picture, since there is no scene")
    difference, explanation, report = _native.compare(
        source("a", a),
        None if b is None else source("b", b),
        None if scene is None else projected(scene, projection),
        None if scene is None else renderer(str(device)),
        settings_of(scene, convention, max_depth, samples, pattern, filter),
        precision,
    )
    found = json.loads(difference)
    judged = None if explanation is None else json.loads(explanation)
    return Comparison(
        differing=found["differing"]["over_0"],
        max_level=found["max_level"],
        mean=found["mean"],
        unexplained=None if judged is None else judged["unexplained"],
        difference=found,
        explanation=judged,
        _report=report,
    )


def source(name: str, value: Source) -> Source:
    """A picture that the native part can read."""
    if isinstance(value, (str, os.PathLike)):
        return value
    array = np.asarray(value)
    if array.dtype != np.uint8:
        raise ValueError(f"{name}: expected uint8, not {array.dtype}")
    if array.ndim != 3 or array.shape[2] != 3:
        raise ValueError(f"{name}: expected shape (height, width, 3), not {array.shape}")
    return array
