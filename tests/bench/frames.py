#!/usr/bin/env python3
"""Processor time of a frame among many of one process, and of a process for a single one, in ms.

usage: frames.py SCENE [PROGRAM…] -- [OPTIONS OF trueray render]     e.g. frames.py s.txt -- --precision fast --res 480x270

Programs take turns, five times; the medians are printed. A frame is a twentieth of what 24 frames take more than 4.
"""
import resource
import statistics
import subprocess
import sys
import tempfile

at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
scene, *programs = sys.argv[1:at]
options = sys.argv[at + 1 :]


def took(program, *frames):
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return (usage.ru_utime + usage.ru_stime) * 1e3

    before = used()
    subprocess.run([program, "render", "-q", *options, *frames, scene], check=True)
    return used() - before


with tempfile.TemporaryDirectory() as folder:

    def of_many(program, count):
        return took(program, "--turntable", "200", "--frames", f"1-{count}", "-o", f"{folder}/%d.ppm")

    runs = {program: ([], []) for program in programs or ["target/release/trueray"]}
    for _ in range(5):
        for program, (frames, singles) in runs.items():
            frames.append((of_many(program, 24) - of_many(program, 4)) / 20)
            singles.append(took(program, "--eye", "0.1,0,0", "-o", f"{folder}/one.ppm"))
    for program, times in runs.items():
        frame, single = map(statistics.median, times)
        print(f"{program}: a frame {frame:.0f} ms, a process {single:.0f} ms, {frame / single:.2f} of it")
