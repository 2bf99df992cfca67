"""A picture in parts on HyperQueue: on the workers of a server, which share its files, or on this machine.

python farm/hyperqueue_tiles.py [--server DIRECTORY] SCENE PICTURE TILES [OPTION of `trueray render`]...
"""

import argparse
import os

from hyperqueue import Client, Job, LocalCluster
from hyperqueue.cluster import WorkerConfig

TRUERAY = os.environ.get("TRUERAY", "trueray")


def submit(client, args):
    """Runs the tiles, and a merge that waits for all of them; a task that fails is an exception."""
    folder = f"{args.picture}.parts"
    os.makedirs(folder, exist_ok=True)
    job = Job(name="trueray")
    tiles, parts = [], []
    for tile in range(args.tiles):
        part = f"{folder}/{tile}.png"
        where = ["--tile", f"{tile}/{args.tiles}", args.scene, "-o", part]
        render = [TRUERAY, "render", "--resume", *args.options, *where]
        tiles.append(job.program(render, stdout=f"{folder}/{tile}.out", stderr=f"{folder}/{tile}.log"))
        parts.append(part)
    merge = [TRUERAY, "merge", *parts, "-o", args.picture]
    job.program(merge, deps=tiles, stdout=f"{folder}/merge.out", stderr=f"{folder}/merge.log")
    client.wait_for_jobs([client.submit(job)])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--server", help="its directory; without it a server and a worker are started here")
    parser.add_argument("scene", type=os.path.abspath)
    parser.add_argument("picture", type=os.path.abspath)
    parser.add_argument("tiles", type=int)
    parser.add_argument("options", nargs=argparse.REMAINDER)
    args = parser.parse_args()
    if args.server:
        submit(Client(args.server), args)
    else:
        with LocalCluster(worker_config=WorkerConfig()) as cluster:
            submit(cluster.client(), args)


if __name__ == "__main__":
    main()
