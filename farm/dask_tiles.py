"""A picture in parts on Dask: on the workers of a scheduler, which share its files, or on this machine.

python farm/dask_tiles.py [--scheduler ADDRESS] SCENE PICTURE TILES [OPTION of `trueray render`]...
"""

import argparse
import os
import subprocess

from distributed import Client

TRUERAY = os.environ.get("TRUERAY", "trueray")


def render(tile, args):
    """Renders one part; a repeated task leaves a part as it is that is there."""
    part = f"{args.picture}.parts/{tile}.png"
    where = ["--tile", f"{tile}/{args.tiles}", args.scene, "-o", part]
    subprocess.run([TRUERAY, "render", "--resume", *args.options, *where], check=True)
    return part


def merge(parts, picture):
    """Puts the parts together."""
    subprocess.run([TRUERAY, "merge", *parts, "-o", picture], check=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--scheduler", help="its address; without it workers are started here")
    parser.add_argument("scene", type=os.path.abspath)
    parser.add_argument("picture", type=os.path.abspath)
    parser.add_argument("tiles", type=int)
    parser.add_argument("options", nargs=argparse.REMAINDER)
    args = parser.parse_args()
    os.makedirs(f"{args.picture}.parts", exist_ok=True)
    # A tile uses all cores of a worker's machine.
    with Client(args.scheduler) if args.scheduler else Client(threads_per_worker=1) as client:
        parts = client.map(render, range(args.tiles), args=args, retries=3, pure=False)
        client.submit(merge, parts, args.picture, pure=False).result()


if __name__ == "__main__":
    main()
