#!/bin/sh
# Tests the live view in Chromium; installs what it needs where it can, and says so where it cannot. An argument is the
# number of seconds for the soak, 20 without it. TRUERAY is the program's path; without it it is built.
set -eu
cd "$(dirname "$0")"

skip() {
    echo "browser tests skipped: $1" >&2
    exit 0
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi
}

has_chromium() {
    [ -n "${CHROMIUM:-}" ] && return
    for path in /usr/bin/chromium /usr/bin/chromium-browser /usr/bin/google-chrome; do
        [ -x "$path" ] && return
    done
    return 1
}

has_node() {
    command -v npm >/dev/null && [ "$(node -p 'parseInt(process.versions.node)')" -ge 20 ]
}

# Node may be there from elsewhere, and its package conflict with that one.
missing=
has_chromium || missing=chromium
has_node || missing="$missing nodejs npm"
if [ -n "$missing" ]; then
    command -v apt-get >/dev/null || skip "no Chromium or no Node 20, and no apt-get to install them"
    as_root apt-get update -q || skip "the package lists cannot be read"
    # shellcheck disable=SC2086 # one word for each package
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing ||
        skip "$missing cannot be installed"
    has_chromium && has_node || skip "Chromium or Node 20 is not there after their installation"
fi
npm ci --no-audit --no-fund || skip "npm ci cannot fetch playwright-core"

if [ -z "${TRUERAY:-}" ]; then
    # As optimised as a release, and there where other tests ran; with the Python package dependencies have the features of those.
    cargo build --locked --package trueray --package trueray-python --bin trueray
    TRUERAY=$(cd ../.. && pwd)/target/debug/trueray
fi
export TRUERAY NODEVICE_SELECT=1
npm test
node soak.js "${1:-20}"
