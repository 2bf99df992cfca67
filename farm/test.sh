#!/usr/bin/env bash
# Renders a picture in parts on a scheduler, kills a task and, on Slurm and Dask, loses a worker in the middle, and compares the
# picture's bytes with those of one run: farm/test.sh openjd|slurm|dask|hyperqueue. Installs what it needs: Python packages into a
# folder that goes with the test, Slurm with apt-get. TRUERAY is the program's path; without it it is built.
set -euo pipefail
cd "$(dirname "$0")/.."
engine=${1:?"usage: farm/test.sh openjd|slurm|dask|hyperqueue"}

work=$(mktemp -d)
started=()
clean_up() {
    for pid in "${started[@]}"; do kill -KILL "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap clean_up EXIT

program=${TRUERAY:-}
if [ -z "$program" ]; then
    # With the Python package beside it dependencies have the features that they have in tests, so that they are not compiled again.
    cargo build --quiet --locked --package trueray --package trueray-python --bin trueray
    program=$PWD/target/debug/trueray
fi
scene=$PWD/scenes/show/showcase.txt
# A second or two for each of four tiles.
tiles=4 options=(--device cpu --res 400x300 --spp 36)
"$program" render -q "${options[@]}" "$scene" -o "$work/one.png"

# Says which processes become the program, and with which arguments.
mkdir "$work/pids"
cat >"$work/noted" <<END
#!/bin/sh
echo "\$@" >"$work/pids/\$\$"
exec "$program" "\$@"
END
chmod +x "$work/noted"
export TRUERAY=$work/noted

# A process that renders a tile now: its file is begun.
rendering() {
    local note pid file
    for _ in $(seq 600); do
        for note in "$work"/pids/*; do
            pid=${note##*/}
            file=$(sed -n 's/.* --tile .* -o //p' "$note" 2>/dev/null) || continue
            if [ -n "$file" ] && [ -e "${file%/*}/.${file##*/}.trueray-0.part" ] &&
                [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = trueray ]; then
                echo "$pid"
                return
            fi
        done
        sleep 0.1
    done
    echo "no tile is being rendered" >&2
    return 1
}

wait_for() {
    for _ in $(seq 3000); do
        if "$@" >/dev/null 2>&1; then return; fi
        sleep 0.1
    done
    echo "in vain: $*" >&2
    return 1
}

install_python() {
    python3 -m venv "$work/venv"
    "$work/venv/bin/pip" install --quiet --disable-pip-version-check "$@"
    PATH=$work/venv/bin:$PATH
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

test_openjd() {
    install_python openjd-cli
    # Names and options that a shell would read as text of its own.
    parts="$work/it's; touch $work/broken #" named="$work/a scene's #1.txt"
    cp "$scene" "$named"
    run() {
        openjd run farm/openjd.yaml --step Merge --run-dependencies -p "Scene=$named" -p "Output=$work/picture.png" \
            -p "Parts=$parts" -p "Tiles=$tiles" -p "Options=${options[*]}" -p "Trueray=$TRUERAY" >"$work/log" 2>&1
    }
    mkdir -p "$parts"
    run &
    kill -KILL "$(rendering)"
    if wait $!; then
        echo "the run did not notice that a task was killed" >&2
        return 1
    fi
    run || { cat "$work/log" >&2; return 1; }
    test ! -e "$work/broken"
}

# What renders a tile on a node of this test, with the daemons that would tell of its end.
on_node() {
    local found=1
    for process in /proc/[0-9]*; do
        if grep -qzx "SLURMD_NODENAME=$1" "$process/environ" && grep -qzx "SLURM_CONF=$SLURM_CONF" "$process/environ" &&
            parent=$(awk '/^PPid/ { print $2 }' "$process/status"); then
            echo "${process##*/}"
            if grep -q slurmstepd "/proc/$parent/comm"; then echo "$parent"; fi
            if grep -qx trueray "$process/comm"; then found=0; fi
        fi
    done 2>/dev/null
    return $found
}

test_slurm() {
    command -v slurmctld slurmd sbatch >/dev/null ||
        { as_root apt-get update -q; as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
            slurmctld slurmd slurm-client; } >"$work/apt" 2>&1 || { cat "$work/apt" >&2; return 1; }
    user=$(id -un) host=$(hostname -s)
    mkdir "$work/state" "$work/spool-a" "$work/spool-b"
    cat >"$work/slurm.conf" <<END
ClusterName=farm
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/none
AuthInfo=cred_expire=5
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/linear
JobRequeue=1
ReturnToService=2
SlurmdTimeout=5
SlurmctldPort=16817
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
SchedulerType=sched/builtin
SchedulerParameters=sched_min_interval=100000,sched_interval=1
NodeName=a NodeHostname=$host NodeAddr=127.0.0.1 Port=16818
NodeName=b NodeHostname=$host NodeAddr=127.0.0.1 Port=16819
PartitionName=all Nodes=a,b Default=YES State=UP
END
    export SLURM_CONF=$work/slurm.conf
    slurmctld -D >"$work/slurmctld.log" 2>&1 & started+=($!)
    for node in a b; do
        slurmd -D -N "$node" >"$work/slurmd-$node.log" 2>&1 & started+=($!)
    done
    wait_for sh -c 'sinfo -h -o %t | grep -qx idle && [ "$(sinfo -h -o %D -t idle)" = 2 ]'
    farm/slurm.sh "$scene" "$work/picture.png" "$tiles" "${options[@]}"
    # SIGTERM to a tile, as before the time limit: it is queued again.
    kill -TERM "$(rendering)"
    wait_for grep -rq "ended as it was asked to" "$work/picture.png.parts"
    # A node goes down while it renders: its tile is rendered on the other.
    wait_for on_node b
    # All at once: what ends first must not be reported by what ends later.
    local all
    all=$(on_node b)
    kill -STOP "${started[2]}" $all
    kill -KILL "${started[2]}" $all
    wait_for test -e "$work/picture.png" || { squeue; tail "$work"/*.log "$work"/*.parts/*.log; return 1; } >&2
}

test_dask() {
    install_python distributed
    dask scheduler --host 127.0.0.1 --port 18786 --no-dashboard >"$work/scheduler.log" 2>&1 & started+=($!)
    for _ in a b; do
        dask worker --no-nanny --nthreads 1 --no-dashboard tcp://127.0.0.1:18786 >>"$work/worker.log" 2>&1 & started+=($!)
    done
    python farm/dask_tiles.py --scheduler tcp://127.0.0.1:18786 "$scene" "$work/picture.png" "$tiles" "${options[@]}" \
        >"$work/log" 2>&1 &
    run=$!
    kill -KILL "$(rendering)"
    rendering >/dev/null
    kill -KILL "${started[2]}"
    wait $run || { cat "$work/log" >&2; return 1; }
}

test_hyperqueue() {
    install_python hyperqueue
    run() { python farm/hyperqueue_tiles.py "$scene" "$work/picture.png" "$tiles" "${options[@]}" >"$work/log" 2>&1; }
    run &
    kill -KILL "$(rendering)"
    if wait $!; then
        echo "the run did not notice that a task was killed" >&2
        return 1
    fi
    run || { cat "$work/log" >&2; return 1; }
}

"test_$engine"
cmp "$work/one.png" "$work/picture.png"
echo "$engine: the bytes of one run"
