#!/usr/bin/env python3
"""Plants the faults of kernels.txt in a copy of the shaders, one at a time: `trueray stress` has to catch each of them.

    python3 tests/mutations/kernels.py --check         only says which faults no longer apply; nothing is compiled
    python3 tests/mutations/kernels.py                 all faults; writes tests/mutations/kernels.md
    python3 tests/mutations/kernels.py --only TEXT     those with TEXT in their names; the table stays as it is

The copy, in target/kernels/, reads its shaders when it runs, so that it is compiled once. Each fault then takes as long as
`trueray stress` at its default counts until the first promise breaks. The exit code is 0 if every fault applies and breaks a promise.
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TREE = ROOT / "target" / "kernels" / "tree"
TARGET = ROOT / "target" / "kernels" / "target"

# Where the copy takes its shaders from.
READ_WHEN_COMPILED = b'Cow::Borrowed(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl")))'
READ_WHEN_RUN = b'Cow::Owned(std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl")).unwrap())'


def parse(text):
    """Name -> (file, times, old, new)."""
    faults = {}
    for line in text.splitlines():
        if not line or line.startswith("#"):
            continue
        if line.startswith("["):
            name = line[1:-1]
            assert name not in faults, f"{name} is there twice"
        elif line.startswith("- "):
            faults[name][2] = line[2:]
        elif line.startswith("+ "):
            faults[name][3] = line[2:]
        else:
            file, _, times = line.partition(" x")
            faults[name] = [file, int(times or 1), "", ""]
    return faults


def problems(faults):
    """What keeps faults from being planted, one line each."""
    for name, (file, times, old, _) in faults.items():
        found = (ROOT / file).read_text().count(old)
        if not old or found != times:
            yield f"{name}: {found} times, not {times}, in {file}: {old}"


def put(path, text):
    """Leaves a file that is right already as old as it is, so that little is compiled again."""
    if not path.exists() or path.read_bytes() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text)


def build():
    """A copy of the tree that reads its shaders when it runs, compiled."""
    files = [path for name in ["Cargo.toml", "Cargo.lock", "src", "shaders"] for path in [ROOT / name, *(ROOT / name).rglob("*")]]
    for file in filter(Path.is_file, files):
        name, text = file.relative_to(ROOT), file.read_bytes()
        if str(name) == "src/gpu/kernel/compose.rs":
            assert text.count(READ_WHEN_COMPILED) == 1, "shaders are read otherwise now"
            text = text.replace(READ_WHEN_COMPILED, READ_WHEN_RUN)
        put(TREE / name, text)
    # For this alone it need not be compiled for as long as a release is.
    profile = dict(CARGO_PROFILE_RELEASE_LTO="off", CARGO_PROFILE_RELEASE_CODEGEN_UNITS="16")
    environment = dict(os.environ, CARGO_TARGET_DIR=str(TARGET), **profile)
    command = ["cargo", "build", "--locked", "--release", "--no-default-features", "--bin", "trueray"]
    subprocess.run(command, cwd=TREE, env=environment, check=True)
    return TARGET / "release" / "trueray"


def stress(program):
    """The first broken promise in words, or the first kernel that is refused; none where all hold. An error is an exception."""
    with subprocess.Popen([program, "stress"], stdout=subprocess.PIPE, text=True, errors="replace") as running:
        for line in running.stdout:
            name, case, kernel = line[3:18].strip(), line[19:38].strip(), line[39:49].strip()
            _, broken, why = line.partition(" FAIL ")
            _, refused, objection = line.partition(" refused ")
            if broken or refused:
                running.kill()
                return f"{name}{', ' if case else ''}{case} at {kernel}: {why.strip() or 'refused: ' + objection.strip()}"
    if running.returncode != 0:
        raise RuntimeError(f"exit code {running.returncode}")
    return None


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true")
    arguments.add_argument("--only", default="", metavar="TEXT")
    arguments = arguments.parse_args()
    every = parse((HERE / "kernels.txt").read_text())
    faults = {name: fault for name, fault in every.items() if arguments.only in name}
    unfit = list(problems(faults))
    print("\n".join(unfit + [f"{len(faults)} faults, {len(unfit)} places that do not fit"]), flush=True)
    if arguments.check or unfit or not faults:
        return bool(unfit or not faults)

    program = build()
    broken = stress(program)
    if broken:
        print(f"without any fault: {broken}")
        return True

    rows, escaped = [], []
    for name, (file, _, old, new) in faults.items():
        start = time.monotonic()
        text = (ROOT / file).read_text()
        put(TREE / file, text.replace(old, new).encode())
        try:
            broken = stress(program)
        except RuntimeError as error:
            broken, trouble = None, f"**{error}**"
        else:
            trouble = "**nothing**"
        finally:
            put(TREE / file, text.encode())
        if not broken:
            escaped.append(name)
        rows.append(f"| {name} | {file} | {broken or trouble} | {time.monotonic() - start:.0f} |")
        print(rows[-1], flush=True)
    caught = f"{len(faults) - len(escaped)} of {len(faults)} faults caught"
    if not arguments.only:
        head = (
            f"# Planted faults of kernels\n\n{caught} by `trueray stress` at its default counts; written by "
            "`python3 tests/mutations/kernels.py`. By what: the first promise that breaks.\n\n"
            "| fault | file | caught by | s |\n|---|---|---|---|\n"
        )
        (HERE / "kernels.md").write_text(head + "\n".join(rows) + "\n")
    print(caught + "".join(f"\nnot caught: {name}" for name in escaped))
    return bool(escaped)


if __name__ == "__main__":
    sys.exit(main())
