#!/bin/sh
# Builds the wheel and tests it in an environment of its own: tests, the README's examples, types. TRUERAY is the program whose
# pictures are the same; without it it is built.
set -eu
cd "$(dirname "$0")"
environment=$(mktemp -d)
trap 'rm -rf "$environment"' EXIT
cargo fmt --check
python="$environment/bin/python"
pip="$python -m pip --disable-pip-version-check install --quiet"
{ python3 -m venv "$environment" && $pip --no-compile maturin mypy numpy pytest; } || {
    echo "the Python package is NOT tested: there is no python3 with venv, or pip cannot install maturin, mypy, numpy and pytest" >&2
    exit 1
}
# Types need no wheel.
"$python" -m mypy --no-incremental package tests & types=$!
if [ -z "${TRUERAY:-}" ]; then
    cargo build --quiet --locked --package trueray --package trueray-python --bin trueray
    TRUERAY=$(cd .. && pwd)/target/debug/trueray
fi
export TRUERAY
# With the program's features, what is compiled for it, or for the main project's tests, is not compiled again.
"$environment/bin/maturin" build --quiet --locked --profile dev --features trueray/default --out "$environment/wheel"
$pip "$environment"/wheel/*.whl
"$python" -m mypy.stubtest trueray._native & stubs=$!
# As tests/run.sh does.
export NODEVICE_SELECT=1
"$python" -m pytest --quiet -p no:cacheprovider "$@"
wait $types
wait $stubs
