"""Arguments as arrays that the native part reads where they lie."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Table = NDArray[Any]


def numbers(name: str, value: ArrayLike) -> Table:
    """The array of `value`, all of whose numbers are finite. Doubles, singles and bytes are not copied."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name}: expected numbers, not {array.dtype}")
    if array.dtype not in (np.float64, np.float32, np.uint8) or not array.dtype.isnative:
        array = array.astype(np.float64)
    finite = np.isfinite(array)
    if not finite.all():
        place = np.unravel_index(int(np.argmin(finite)), array.shape)
        raise ValueError(f"{name}{[int(i) for i in place] or ''}: expected a finite number, not {array[place]}")
    return array


def lengths(name: str, value: ArrayLike) -> Table:
    """Numbers that may be bytes, but are no colours."""
    array = numbers(name, value)
    return array.astype(np.float64) if array.dtype == np.uint8 else array


def shades(name: str, value: ArrayLike) -> Table:
    """Colours or intensities in 0..1, or bytes."""
    array = numbers(name, value)
    if np.asarray(value).dtype.kind in "iu" and array.dtype != np.uint8 and array.size and array.max() > 1:
        raise ValueError(f"{name}: integers in 0..255 have to be of type uint8, others are in 0..1")
    return array


def triples(name: str, array: Table, rows: int | None = None) -> Table:
    """A table (rows, 3); one triple stands for all rows."""
    if array.ndim == 2 and array.shape[1] == 3 and rows in (None, len(array)):
        return array
    if array.shape == (3,) and rows is not None:
        return np.broadcast_to(array, (rows, 3))
    if rows is None:
        raise ValueError(f"{name}: expected shape (N, 3), not {array.shape}")
    raise ValueError(f"{name}: expected shape ({rows}, 3) or (3,), not {array.shape}")


def column(name: str, value: ArrayLike, rows: int) -> Table:
    """A table (rows, 1); one number stands for all rows."""
    array = lengths(name, value)
    if array.shape not in ((), (rows,)):
        raise ValueError(f"{name}: expected a number or shape ({rows},), not {array.shape}")
    return np.broadcast_to(array.reshape(-1, 1), (rows, 1))


def semi_axes(name: str, value: ArrayLike, rows: int) -> Table:
    """A table (rows, 3) of radii; one number stands for all, one number in a row for all of its axes."""
    array = lengths(name, value)
    if array.shape not in ((), (rows,), (rows, 3)):
        raise ValueError(f"{name}: expected a number or shape ({rows},) or ({rows}, 3), not {array.shape}")
    return array if array.ndim == 2 else np.broadcast_to(array.reshape(-1, 1), (rows, 3))


def numbered(name: str, value: ArrayLike, count: int) -> list[float]:
    """So many numbers."""
    array = lengths(name, value)
    if array.shape != (count,):
        raise ValueError(f"{name}: expected {count} numbers, not shape {array.shape}")
    return [float(number) for number in array]


def number(name: str, value: ArrayLike) -> float:
    """One number."""
    array = lengths(name, value)
    if array.shape != ():
        raise ValueError(f"{name}: expected a number, not shape {array.shape}")
    return float(array)


def color(name: str, value: ArrayLike) -> list[float]:
    """A colour in 0..1, or in bytes; one number is a grey."""
    array = shades(name, value)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name}: expected a number or shape (3,), not {array.shape}")
    levels = array / 255.0 if array.dtype == np.uint8 else array
    return [float(level) for level in np.broadcast_to(levels, 3)]


def integer(name: str, value: Any, least: int, greatest: int) -> int:
    """A whole number within bounds."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and least <= value <= greatest:
        return int(value)
    raise ValueError(f"{name}: expected an integer from {least} to {greatest}, not {value!r}")
