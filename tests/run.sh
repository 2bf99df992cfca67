#!/bin/sh
# Runs all tests; installs the software Vulkan driver first where there is no driver at all.
set -eu
cd "$(dirname "$0")/.."

has_driver() {
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return
    for file in /usr/share/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json; do
        [ -e "$file" ] && return
    done
    return 1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

install_driver() {
    if command -v apt-get >/dev/null; then
        as_root apt-get update -q
        as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q mesa-vulkan-drivers
    elif command -v dnf >/dev/null; then
        as_root dnf install -y mesa-vulkan-drivers vulkan-loader
    elif command -v pacman >/dev/null; then
        as_root pacman -S --noconfirm vulkan-swrast vulkan-icd-loader
    else
        echo "install Mesa's software Vulkan driver (lavapipe) and the Vulkan loader, then run this again" >&2
        exit 1
    fi
}

has_driver || install_driver
# A device is there now: a test that finds none has failed. Mesa would ask for a display that nothing here needs.
# wgpu's test builds would look where each lock is taken, for backtraces of its own; those of panics are kept.
export TRUERAY_REQUIRE_GPU=1 NODEVICE_SELECT=1 RUST_LIB_BACKTRACE=0
exec cargo test --locked "$@"
