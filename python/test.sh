#!/bin/sh
# Builds the wheel and tests it in an environment of its own: tests, the README's examples, types.
set -eu
cd "$(dirname "$0")"
environment=$(mktemp -d)
trap 'rm -rf "$environment"' EXIT
cargo fmt --check
python3 -m venv "$environment"
pip="$environment/bin/python -m pip --disable-pip-version-check install --quiet"
$pip maturin mypy numpy pytest
# What the main project has compiled is not compiled again.
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/../target}"
"$environment/bin/maturin" build --quiet --locked --profile dev --out "$environment/wheel"
$pip "$environment"/wheel/*.whl
# As tests/run.sh does.
export NODEVICE_SELECT=1
"$environment/bin/python" -m pytest --quiet -p no:cacheprovider "$@"
"$environment/bin/python" -m mypy --no-incremental package tests
"$environment/bin/python" -m mypy.stubtest trueray._native
