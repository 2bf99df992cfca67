#!/usr/bin/env python3
"""Plants the faults of mutations.txt in a copy of the tree, one at a time: the tests have to catch each of them.

    python3 tests/mutations/run.py --check         only says which faults no longer apply; nothing is compiled
    python3 tests/mutations/run.py                 all faults
    python3 tests/mutations/run.py --only TEXT     those with TEXT in their names; may be repeated
    python3 tests/mutations/run.py --new           those without a row in the table

Runs what the README says, `sh tests/run.sh`, without TRUERAY_KEYS: first the expected pictures and claims of
the scenes, then what is calculated by hand, and the whole suite for faults that pass these. It takes a minute or two for each fault, so it runs on demand.
What is found goes into tests/mutations/table.md, row by row. The copy and its build are in target/mutations/. The exit code is 0 if every fault applies, compiles and is caught.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
WORK = ROOT / "target" / "mutations"
TREE = WORK / "tree"
TABLE = HERE / "table.md"

# What catches most faults, the quickest first: the modules of the suite that are compiled, or all tests of all binaries. The rest of the suite
# would take longer to compile than these to run.
STAGES = [["golden", "claims", "support"], ["phong", "support"], None]

ESCAPED = "**nothing**"

# How long one stage may take: a fault may make a loop endless.
LIMIT_S = 1800


def parse(text):
    """Name -> list of (file, times, old, new)."""
    faults = {}
    changes = None
    for number, line in enumerate(text.splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        if line.startswith("["):
            name = line.strip("[]")
            assert name not in faults, f"line {number}: {name} is there twice"
            changes = faults[name] = []
        elif line.startswith("- "):
            changes[-1][2].append(line[2:])
        elif line == "+" or line.startswith("+ "):
            changes[-1][3].append(line[2:])
        else:
            file, _, times = line.partition(" x")
            changes.append((file, int(times or 1), [], []))
    return {
        name: [(file, times, "\n".join(old), "\n".join(new)) for file, times, old, new in changes]
        for name, changes in faults.items()
    }


def problems(faults, tree):
    """What keeps faults from being planted, one line each."""
    for name, changes in faults.items():
        for file, times, old, _ in changes:
            path = tree / file
            found = path.read_text().count(old) if path.exists() else None
            if found is None:
                yield f"{name}: there is no {file}"
            elif not old or found != times:
                yield f"{name}: {found} times, not {times}, in {file}: {old}"


def copy_tree():
    """The files that git tracks or would add, as they are now; unchanged ones keep their time, so that little is compiled again."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True
    )
    wanted = {name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()}
    if TREE.exists():
        for path in [path for path in TREE.rglob("*") if path.is_file()]:
            if str(path.relative_to(TREE)) not in wanted:
                path.unlink()
    for name in wanted:
        source, target = ROOT / name, TREE / name
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, target)


def choose(modules):
    """Compiles these modules of the suite alone, or all."""
    main = (ROOT / "tests/suite/main.rs").read_text()
    if modules:
        main = re.sub(r"^(#\[cfg.*\]\n)?mod (\w+);\n", lambda m: m.group() if m[2] in modules else "", main, flags=re.MULTILINE)
    (TREE / "tests/suite/main.rs").write_text(main)


def run(modules):
    """Failed tests of a stage, and why there is no answer, if there is none."""
    choose(modules)
    environment = dict(os.environ, CARGO_TARGET_DIR=str(WORK / "target"), RUST_BACKTRACE="0", CARGO_PROFILE_DEV_DEBUG="false")
    for variable in ["TRUERAY_KEYS", "TRUERAY_BLESS"]:
        environment.pop(variable, None)
    arguments = ["--no-fail-fast", "--test", "suite"] if modules else ["--no-fail-fast"]
    process = subprocess.Popen(
        ["sh", "tests/run.sh", *arguments], cwd=TREE, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        errors="replace", start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.communicate()
        return ["(a test that did not end)"], None
    failed = re.findall(r"^test (\S+) (?:- .* )?\.\.\. FAILED$", output, re.MULTILINE)
    if process.returncode == 0:
        return [], None
    if "could not compile" in output:
        return [], "does not compile:\n" + "\n".join(re.findall(r"^error.*\n.*$", output, re.MULTILINE)[:5])
    # A shader that no longer parses is caught by anything, and says nothing.
    broken = re.search(r"^.*(?:shaders/\S+\.wgsl:\d+|wgsl error|shader parsing).*$", output, re.MULTILINE)
    if broken:
        return [], f"breaks a shader: {broken.group()}"
    return (failed, None) if failed else ([], "failed without a failed test:\n" + output[-2000:])


def plant(changes):
    for file, _, old, new in changes:
        path = TREE / file
        path.write_text(path.read_text().replace(old, new))


def restore(changes):
    for file, *_ in changes:
        (TREE / file).write_bytes((ROOT / file).read_bytes())


def in_short(tests):
    names = ", ".join(f"`{test}`" for test in tests[:3])
    return f"{len(tests)}: {names}" + (", …" if len(tests) > 3 else "")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true")
    arguments.add_argument("--only", action="append", metavar="TEXT")
    arguments.add_argument("--new", action="store_true")
    arguments = arguments.parse_args()
    every = parse((HERE / "mutations.txt").read_text())
    faults = {name: changes for name, changes in every.items() if any(text in name for text in arguments.only or [""])}
    if arguments.new:
        faults = {name: changes for name, changes in faults.items() if name not in rows()}
    unfit = list(problems(faults, ROOT))
    print("\n".join(unfit + [f"{len(faults)} faults, {len(unfit)} places that do not fit"]), flush=True)
    if arguments.check or unfit or not faults:
        return bool(unfit or not faults)

    TREE.mkdir(parents=True, exist_ok=True)
    copy_tree()
    for modules in STAGES[:2]:
        failed, trouble = run(modules)
        if failed or trouble:
            print(f"without any fault: {trouble or in_short(failed)}")
            return True

    escaped = []
    for name, changes in faults.items():
        start = time.monotonic()
        plant(changes)
        try:
            for modules in STAGES:
                failed, trouble = run(modules)
                if failed or trouble:
                    break
        finally:
            restore(changes)
        result = trouble or (in_short(failed) if failed else ESCAPED)
        if trouble or not failed:
            escaped.append(name)
        files = ", ".join(f"`{file}`" for file, *_ in changes)
        row = f"| {name} | {files} | {result.splitlines()[0]} | {time.monotonic() - start:.0f} |"
        print(f"{row}\n{result}" if trouble else row, flush=True)
        write_row(every, name, row)
    print(f"{len(faults) - len(escaped)} of {len(faults)} faults caught" + "".join(f"\nnot caught: {name}" for name in escaped))
    return bool(escaped)


def rows():
    """Name of the fault -> row of the table."""
    lines = TABLE.read_text().splitlines() if TABLE.exists() else []
    return {line.split(" | ")[0].removeprefix("| "): line for line in lines if line.startswith("| ")}


def write_row(every, name, row):
    """Puts a fault's row in its place in the table; rows of faults that are no more fall out."""
    known = rows() | {name: row}
    listed = [known[name] for name in every if name in known]
    caught = sum(row.split(" | ")[2][0].isdigit() for row in listed)
    head = (
        f"# Planted faults\n\nOf {len(every)} faults {len(listed)} were run, and {caught} of these caught by `sh tests/run.sh` without "
        "TRUERAY_KEYS; written by `python3 tests/mutations/run.py`.\nTests are those of the first stage that catches the fault: expected pictures and "
        "claims, colours by hand, all.\n\n| fault | files | caught by | s |\n|---|---|---|---|\n"
    )
    TABLE.write_text(head + "\n".join(listed) + "\n")


if __name__ == "__main__":
    sys.exit(main())
