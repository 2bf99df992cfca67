"""What a Python program gets, and what it is told where it asks for something that cannot be."""

from __future__ import annotations

import os
import subprocess
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import trueray

#: The program, whose pictures are the same.
PROGRAM = os.environ["TRUERAY"]
SCENES = Path(__file__).parents[2] / "scenes"
DEVICE = "0" if trueray.devices() else "cpu"
THREE = np.array([[0.0, 0.0, 0.0], [2.0, 0.5, 0.0], [-1.0, 1.0, 1.0]])
SMALL: dict[str, Any] = {"size": (48, 32)}


def picture(**changes: Any) -> Any:
    arguments: dict[str, Any] = {"positions": THREE, "radii": 0.7, "colors": (1.0, 0.5, 0.2), **SMALL, **changes}
    return trueray.render(trueray.Scene.from_arrays(**arguments), device="cpu", samples=1)


def test_a_file_is_rendered_as_the_command_line_does() -> None:
    file, golden = (SCENES / "basic" / f"ellipsoid.{ending}" for ending in ["txt", "golden.png"])
    whole = [trueray.Scene.from_file(file), trueray.Scene.from_text(file.read_text())]
    assert whole[0].size == (181, 149)
    from_file, from_text = (trueray.render(scene, device="cpu") for scene in whole)
    assert np.array_equal(from_file, from_text)
    scene = trueray.Scene.from_text(file.read_text().replace("RES 181 149", "RES 61 50"))
    found = trueray.compare(trueray.render(scene, device="cpu"), golden, scene, device="cpu")
    assert (found.differing, found.max_level, found.mean, found.unexplained) == (0, 0, 0.0, 0)
    on_device = trueray.compare(trueray.render(scene, device=DEVICE), scene=scene, device=DEVICE)
    assert on_device.unexplained == 0
    again = trueray.Scene.from_text(scene.text())
    assert np.array_equal(trueray.render(again, device="cpu"), trueray.render(scene, device="cpu"))


@pytest.mark.parametrize(
    ("settings", "options"),
    [
        ({}, ""),
        ({"samples": 4}, "--spp 4"),
        ({"samples": 5, "pattern": "fibonacci"}, "--spp 5 --pattern fibonacci"),
        ({"samples": 5, "pattern": "fibonacci", "filter": "tent"}, "--spp 5 --pattern fibonacci --filter tent"),
        ({"samples": 4, "pattern": "fibonacci", "filter": "gaussian"}, "--spp 4 --pattern fibonacci --filter gaussian"),
        ({"projection": "orthographic"}, "--projection orthographic"),
        (
            {"projection": "orthographic", "samples": 3, "pattern": "fibonacci", "filter": "tent", "convention": "exact"},
            "--projection orthographic --spp 3 --pattern fibonacci --filter tent --convention exact",
        ),
    ],
)
def test_settings_give_the_bytes_of_the_program(settings: dict[str, Any], options: str, tmp_path: Path) -> None:
    text = (SCENES / "effects" / "three-mirrors.txt").read_text()
    file, image = tmp_path / "scene.txt", tmp_path / "picture.ppm"
    # Parallel rays see a part of the mirrors through so small a window, too.
    file.write_text(text.replace("RES 203 151", "RES 61 45"))
    eyes: list[tuple[dict[str, Any], str]] = [
        ({}, ""), ({"eye": (0.5, 0.25, 0), "look_at": (0, 0, -4)}, "--eye 0.5,0.25,0 --look-at 0,0,-4")
    ]
    for eye, words in eyes:
        command = [PROGRAM, "render", "-q", "--device", "cpu", *options.split(), *words.split(), str(file)]
        subprocess.run([*command, "-o", str(image)], check=True)
        scene = trueray.Scene.from_file(file)
        assert (scene.projection, scene.size) == ("perspective", (61, 45))
        if eye:
            scene = scene.seen_from(**eye, projection=settings.get("projection"))
        ours = trueray.render(scene, device="cpu", **settings)
        assert b"P6\n61 45\n255\n" + ours.tobytes() == image.read_bytes()
        assert not settings or not np.array_equal(ours, trueray.render(trueray.Scene.from_file(file), device="cpu"))
        assert trueray.compare(image, scene=scene, device="cpu", **settings).unexplained == 0
        if settings:
            assert trueray.compare(image, scene=trueray.Scene.from_file(file), device="cpu").unexplained != 0


def test_certified_pictures_are_those_of_the_reference() -> None:
    scene = trueray.Scene.from_arrays(THREE, reflection=0.3, **SMALL)
    certified = trueray.render(scene, device=DEVICE, precision="certified")
    assert np.array_equal(certified, trueray.render(scene, device="cpu"))


def test_without_a_word_about_it_all_spheres_are_seen_from_all_sides() -> None:
    cases = [
        (size, offset, projection)
        for size in [(60, 40), (40, 60)]
        for offset in [(0, 0, 0), (1e5, -3e4, 7e3)]
        for projection in ["perspective", "orthographic"]
    ]
    for size, offset, projection in cases:
        for near in [None, 8.0] if projection == "orthographic" else [None]:
            image = trueray.render(
                THREE + offset, 0.7, background=0.0, size=size, projection=projection, near=near, device="cpu"
            )
            assert image.shape == (size[1], size[0], 3)
            seen = np.asarray(image.any(axis=2))
            assert 0.05 < seen.mean() < 0.9
            edges = [seen[0], seen[-1], seen[:, 0], seen[:, -1]]
            assert not any(edge.any() for edge in edges)
    nothing = trueray.render(np.zeros((0, 3)), background=(1, 0, 0), **SMALL, device="cpu")
    assert (nothing == (255, 0, 0)).all()


def test_arrays_of_other_types_and_strides_give_the_same_picture() -> None:
    expected = picture()
    for positions in [THREE.astype(np.float32), THREE.tolist(), np.asfortranarray(THREE), THREE.repeat(2, axis=0)[::2],
                      THREE.astype(">f8")]:
        assert np.array_equal(picture(positions=positions), expected)
    for radii in [np.full(3, 0.7), np.full((3, 3), 0.7), [0.7, 0.7, 0.7]]:
        assert np.array_equal(picture(radii=radii), expected)
    levels = np.array([255, 0, 51], dtype=np.uint8)
    assert np.array_equal(picture(colors=levels), picture(colors=np.tile([1.0, 0.0, 0.2], (3, 1))))
    assert np.array_equal(picture(specular=np.full(3, 0.3)), expected)
    assert not np.array_equal(picture(specular=[0.3, 0.0, 0.3]), expected)


def test_each_argument_changes_the_picture() -> None:
    expected = picture()
    changes: dict[str, Any] = {
        "radii": (0.7, 0.7, 0.8), "colors": (0.9, 0.5, 0.2), "ambient": 0.5, "diffuse": 0.5, "specular": 0.0,
        "reflection": 0.5, "exponent": 3.0, "transmission": 0.5, "lights": [[0, 9, 0]], "light_colors": 0.1,
        "ambient_light": 0.9, "background": 0.9, "eye": (0, 0, 9), "look_at": (1, 0, 0), "up": (1, 0, 0),
        "fov": 80.0, "near": 8.0, "window": (-0.5, 0.5, -0.2, 0.2), "projection": "orthographic",
    }
    for name, value in changes.items():
        assert not np.array_equal(picture(**{name: value}), expected), name
    assert not np.array_equal(picture(transmission=0.5), picture(transmission=0.5, eta=1.5))


def test_another_eye_shares_the_scene() -> None:
    scene = trueray.Scene.from_arrays(THREE, **SMALL, lights=[[5, 5, 5]])
    assert scene.seen_from((4, 1, 6)).projection == "perspective"
    flat = trueray.Scene.from_arrays(THREE, **SMALL, projection="orthographic")
    assert (flat.projection, flat.seen_from((4, 1, 6)).projection) == ("orthographic", "orthographic")
    moved = scene.seen_from((4, 1, 6), look_at=(0, 0, 0))
    made = trueray.Scene.from_arrays(THREE, **SMALL, lights=[[5, 5, 5]], eye=(4, 1, 6), look_at=(0, 0, 0))
    assert moved.eye == (4, 1, 6) and len(moved) == 3 and moved.size == (48, 32)
    assert np.array_equal(trueray.render(moved, device="cpu"), trueray.render(made, device="cpu"))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"positions": [[0, 0]]}, r"positions: expected shape \(N, 3\), not \(1, 2\)"),
        ({"positions": [[0, 0, 0], [1, 2]]}, "positions: "),
        ({"positions": [["a", "b", "c"]]}, "positions: expected numbers, not <U1"),
        ({"positions": np.zeros((2, 3), dtype=complex)}, "positions: expected numbers, not complex128"),
        ({"positions": [[0, 0, 0], [0, np.nan, 0]]}, r"positions\[1, 1\]: expected a finite number, not nan"),
        ({"radii": [1.0, 2.0]}, r"radii: expected a number or shape \(3,\) or \(3, 3\), not \(2,\)"),
        ({"radii": [1.0, 0.0, 1.0]}, "radii: sx of sphere 1 is 0: expected a number other than 0"),
        ({"radii": np.inf}, "radii: expected a finite number, not inf"),
        ({"colors": np.zeros((2, 3))}, r"colors: expected shape \(3, 3\) or \(3,\), not \(2, 3\)"),
        ({"colors": [255, 0, 0]}, "colors: integers in 0..255 have to be of type uint8"),
        ({"exponent": -1.0}, "exponent: n of sphere 0 is -1: expected 0 or a number greater than 0"),
        ({"eta": [1.0, 0.0, 1.0]}, "eta: eta of sphere 1 is 0"),
        ({"lights": [1, 2, 3]}, r"lights: expected shape \(N, 3\), not \(3,\)"),
        ({"light_colors": [[1, 1, 1]] * 5}, r"light_colors: expected shape \(2, 3\)"),
        ({"size": (0, 5)}, "size: expected an integer from 1 to 16777216, not 0"),
        ({"size": (5.5, 5)}, "size: expected an integer"),
        ({"size": 5}, "size: expected columns and rows, not 5"),
        ({"near": 0.0}, "near: expected a number greater than 0, not 0"),
        ({"near": [1.0]}, r"near: expected a number, not shape \(1,\)"),
        ({"window": (1, 1, 0, 1)}, "window: right of the window is 1"),
        ({"fov": 180.0}, "fov: expected an angle between 0 and 180 degrees, not 180"),
        ({"eye": (0, 0)}, r"eye: expected 3 numbers, not shape \(2,\)"),
        ({"eye": (1, 1, 1), "look_at": (1, 1, 1)}, "eye and look-at are the same point"),
        ({"up": (0, 0, 0)}, "up is 0,0,0"),
        ({"projection": "isometric"}, "projection: expected perspective or orthographic, not 'isometric'"),
        ({"projection": "orthographic", "fov": 30.0}, "fov: an orthographic picture has no field of view"),
        ({"background": [1.0, 2.0]}, r"background: expected a number or shape \(3,\)"),
    ],
)
def test_arguments_that_make_no_sense_are_named(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        picture(**changes)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"precision": "best"}, "precision: expected auto, fast, robust, double or certified, not 'best'"),
        ({"convention": "mine"}, "convention: no convention is called 'mine'"),
        ({"samples": 3}, "samples: expected a square number from 1 to 256.* pattern='fibonacci' takes any number"),
        ({"samples": 257, "pattern": "fibonacci"}, "samples: expected an integer from 1 to 256, not 257"),
        ({"pattern": "sobol"}, "pattern: expected grid or fibonacci, not 'sobol'"),
        ({"filter": "tent"}, "filter: a regular grid has no tent filter, pattern='fibonacci' has"),
        ({"filter": "mitchell", "pattern": "fibonacci"}, "filter: expected box, tent or gaussian, not 'mitchell'"),
        ({"projection": "isometric"}, "projection: expected perspective or orthographic, not 'isometric'"),
        ({"samples": 1.5}, "samples: expected an integer"),
        ({"max_depth": -1}, "max_depth: expected an integer from 0 to 1000, not -1"),
        ({"verify": "some"}, "verify: expected a number of pixels, all or none"),
    ],
)
def test_settings_that_make_no_sense_are_named(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        trueray.render(THREE, **SMALL, device="cpu", **settings)


def test_errors_are_exceptions_with_the_messages_of_the_program() -> None:
    with pytest.raises(trueray.SceneError, match="cannot read the scene nowhere.txt"):
        trueray.Scene.from_file("nowhere.txt")
    with pytest.raises(trueray.SceneError, match=r"mine:2:1"):
        trueray.Scene.from_text("NEAR 1\nSPHEER", name="mine")
    with pytest.raises(trueray.SceneError, match="the scene cannot be rendered"):
        trueray.render([[1e300, 0.0, 0.0], [0.0, 0.0, 0.0]], [1.0, 1e-300], **SMALL, device="cpu")
    with pytest.raises(trueray.DeviceError, match="no such thing"):
        trueray.render(THREE, device="no such thing")
    with pytest.raises(trueray.PictureError, match="differ in size: A is 2x1, B is 1x1"):
        trueray.compare(np.zeros((1, 2, 3), np.uint8), np.zeros((1, 1, 3), np.uint8))
    with pytest.raises(trueray.PictureError, match="nowhere.png"):
        trueray.compare("nowhere.png", np.zeros((1, 1, 3), np.uint8))
    for error in [trueray.SceneError, trueray.DeviceError, trueray.PictureError]:
        assert issubclass(error, trueray.Error)
    with pytest.raises(TypeError, match="radii: a Scene has all of this already"):
        trueray.render(trueray.Scene.from_arrays(THREE), 1.0)
    with pytest.raises(TypeError, match="colour"):
        trueray.render(THREE, colour=1)


def test_comparisons_tell_what_the_command_line_tells() -> None:
    scene = trueray.Scene.from_arrays(THREE, **SMALL)
    right = trueray.render(scene, device="cpu")
    wrong = right.copy()
    wrong[3, 5] += 40
    found = trueray.compare(wrong, right)
    assert (found.differing, found.max_level, found.unexplained, found.explanation) == (1, 40, None, None)
    worst = found.difference["worst"]
    assert (worst["x"], worst["y"]) == (5, 3)
    assert "worst pixel       x 5, y 3: 40 levels" in str(found)
    judged = trueray.compare(wrong, scene=scene, device="cpu")
    assert (judged.differing, judged.unexplained) == (1, 1)
    assert judged.explanation is not None and judged.explanation["listed"][0]["x"] == 5
    assert "1  unexplained" in str(judged)
    upside_down = trueray.compare(right[::-1], right)
    assert upside_down.difference["resemblances"][0]["kind"] == "flipped_vertically"
    for a, message in [(right.astype(float), "a: expected uint8"), (right[0], "a: expected shape")]:
        with pytest.raises(ValueError, match=message):
            trueray.compare(a, right)
    with pytest.raises(ValueError, match="b: expected a picture"):
        trueray.compare(right)


def test_other_threads_run_while_it_renders() -> None:
    scene = trueray.Scene.from_arrays(np.random.default_rng(1).normal(size=(300, 3)), 0.2, reflection=0.5, size=(400, 300))
    done = threading.Event()
    longest = 0.0

    def watch() -> None:
        nonlocal longest
        before = time.perf_counter()
        while not done.is_set():
            time.sleep(0.001)
            longest, before = max(longest, time.perf_counter() - before), time.perf_counter()

    watcher = threading.Thread(target=watch)
    watcher.start()
    start = time.perf_counter()
    trueray.render(scene, device="cpu", samples=16)
    took = time.perf_counter() - start
    done.set()
    watcher.join()
    assert longest < took / 2, (longest, took)


def test_where_there_is_no_device_auto_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    from trueray import _native, _render

    class Reference:
        device = None

    monkeypatch.setattr(_native, "Renderer", lambda device: Reference())
    _render.renderer.cache_clear()
    with pytest.warns(RuntimeWarning, match="there is no Vulkan device"):
        _render.renderer("auto")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _render.renderer("cpu")
    _render.renderer.cache_clear()
