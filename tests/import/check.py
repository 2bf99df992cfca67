"""Compares scenes that `trueray import` writes with what ASE and gemmi read of the same files."""

import pathlib
import subprocess
import sys

import ase.data
import ase.data.colors
import ase.data.vdw_alvarez
import ase.io
import gemmi
import numpy

HERE = pathlib.Path(__file__).parent
# Bondi's radii of the elements in the files; Alvarez has others for these.
BONDI = {"H": 1.20, "C": 1.70, "N": 1.55, "O": 1.52, "S": 1.80, "Ar": 1.88, "Kr": 2.02}


def spheres(program, name, frame):
    """Names, centres, radii and colours that the program writes."""
    command = [program, "import", "-q", "--frame", str(frame), str(HERE / name)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in text.splitlines() if line.startswith("SPHERE")]
    numbers = numpy.array([row[2:11] for row in rows], float)
    return [row[1] for row in rows], numbers[:, :3], numbers[:, 3], numbers[:, 6:]


def by_ase(name, frame):
    """Symbols and positions of a frame; ASE sorts the atoms of a dump by their numbers, the file does not."""
    atoms = ase.io.read(HERE / name, index=frame - 1)
    return atoms.get_chemical_symbols(), atoms.get_positions()


def by_gemmi(name, frame):
    model = gemmi.read_structure(str(HERE / name))[frame - 1]
    atoms = [cra.atom for cra in model.all()]
    return [atom.element.name for atom in atoms], numpy.array([atom.pos.tolist() for atom in atoms])


def check(program, name, frame, reader):
    names, centers, radii, colors = spheres(program, name, frame)
    symbols, positions = reader(name, frame)
    assert sorted(names) == sorted(symbols), f"{name}: {len(names)} and {len(symbols)} atoms, or other elements"
    moved = centers - centers.min(axis=0)
    expected = positions - positions.min(axis=0)
    order = lambda points: points[numpy.lexsort(numpy.round(points, 6).T)]
    worst = numpy.abs(order(moved) - order(expected)).max()
    assert worst < 1e-6, f"{name}: positions differ by {worst}"
    for symbol, radius, color in zip(names, radii, colors):
        number = ase.data.atomic_numbers[symbol]
        assert radius == BONDI.get(symbol, ase.data.vdw_alvarez.vdw_radii[number]), (name, symbol, radius)
        assert numpy.abs(color - ase.data.colors.jmol_colors[number]).max() < 0.002, (name, symbol, color)
    print(f"{name}, frame {frame}: {len(names)} atoms, positions within {worst:.1e}")


if __name__ == "__main__":
    program = sys.argv[1]
    # ASE takes the names of carbons for elements where the file has no column of these.
    check(program, "gramicidin.pdb", 1, by_gemmi)
    check(program, "1yjp.cif", 1, by_gemmi)
    for frame in (1, 2):
        check(program, "benzene.xyz", frame, by_ase)
    for frame in (1, 2, 3):
        check(program, "argon.lammpstrj", frame, by_ase)
