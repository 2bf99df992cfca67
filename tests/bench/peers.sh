#!/usr/bin/env sh
# The same scenes rendered by trueray and by whichever of POV-Ray, Tachyon and a program on Embree there is, in alternation on this
# machine. The last is embree.cpp beside this file, which is compiled where a C++ compiler finds Embree 3 (Debian: libembree-dev).
#
# usage: sh tests/bench/peers.sh [SCENE…]      without scenes: those of `trueray bench`
#
# One sample a pixel, as many bounces, as many threads for all. `prepare` is what each program reports of the time between
# reading the scene and the first ray, `render` of tracing alone, `both` of the two in one run; `process` is from its start to
# the finished picture. All are medians in ms with the least and the greatest run behind.
# The ratios are to trueray: above 1 is slower. Behind them: how far the picture is from trueray's, as `trueray compare`
# counts it, at the rounding of levels that the program has.
#
# From the environment: RUNS (5), THREADS (2, at most the number of cores), RES (1920x1080), FAMILIES (spheres) and MAX_SPHERES
# (1000) of the scenes, PRECISION (auto), DEVICE (auto), PEERS (povray tachyon embree), TRUERAY (target/release/trueray),
# KEEP (a folder that keeps pictures and exported scenes), RAW (a CSV file of every run, with this machine in its head).
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
trueray=${TRUERAY:-$root/target/release/trueray}
runs=${RUNS:-5}
cores=$(getconf _NPROCESSORS_ONLN)
threads=${THREADS:-2}
[ "$threads" -le "$cores" ] || threads=$cores
res=${RES:-1920x1080}
device=${DEVICE:-auto}
precision=${PRECISION:-auto}
wanted=${PEERS:-povray tachyon embree}

if [ ! -x "$trueray" ]; then
    echo "there is no $trueray: build it with cargo build --release, or set TRUERAY" >&2
    exit 2
fi
# lavapipe and the CPU reference use as many threads as the others.
export LP_NUM_THREADS="$threads" RAYON_NUM_THREADS="$threads"

if [ -n "${KEEP:-}" ]; then
    mkdir -p "$KEEP"
    folder=$(cd "$KEEP" && pwd)
else
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' EXIT
fi

log=$folder/embree.log
peers=
for peer in $wanted; do
    if [ "$peer" != embree ] && ! command -v "$peer" >/dev/null; then
        echo "$peer: not installed, left out"
    elif [ "$peer" = embree ] && ! c++ -O3 -march=native -std=c++17 "$root/tests/bench/embree.cpp" -lembree3 -lpthread \
        -o "$folder/embree" 2>"$log"; then
        echo "embree: cannot be compiled ($(grep -m 1 -E 'error|not found' "$log")), left out"
    else
        peers="$peers $peer"
    fi
done

raw=${RAW:-/dev/null}
{
    echo "# $("$trueray" -V), $res, $threads threads, precision $precision, device $device, $runs runs in turn after one that warms up"
    echo "# $(uname -sm), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1), $cores cores, $(date -u +%F)"
    echo "scene,program,what,run,ms"
} >"$raw"

now() { date +%s%N; }
since() { echo "$1 $(now)" | awk '{ printf "%.3f\n", ($2 - $1) / 1e6 }'; }

# What a program says that something took: the seconds that the pattern finds in its log, in ms.
seconds() { sed -n "s/.*$1.*/\\1/p" "$2" | awk '{ printf "%.3f\n", $1 * 1e3 }'; }

failed() { # log
    echo "this failed:" >&2
    tail -n 5 "$1" >&2
    exit 1
}

# Each runs one program once and appends its times in ms to NAME.render and NAME.process.
run_trueray() { # scene, quantize, picture
    start=$(now)
    "$trueray" render "$1" -o "$3" --res "$res" --quantize "$2" --device "$device" --precision "$precision" \
        --stats-json "$3.json" --no-ray-counts -q
    since "$start" >>"$folder/trueray.process"
    for what in prepare render; do
        awk -F'[:,]' "/\"${what}_ms\"/"' { printf "%.3f\n", $2 }' "$3.json" >>"$folder/trueray.$what"
    done
}

run_povray() { # scene, picture
    start=$(now)
    povray "+I$1" "+O$2" +FP File_Gamma=1 "+W${res%x*}" "+H${res#*x}" -A -D "+WT$threads" >"$2.log" 2>&1 || failed "$2.log"
    since "$start" >>"$folder/povray.process"
    seconds 'Bounding Time:.*(\([0-9.]*\) seconds)' "$2.log" >>"$folder/povray.prepare"
    seconds 'Trace Time:.*(\([0-9.]*\) seconds)' "$2.log" >>"$folder/povray.render"
}

run_tachyon() { # scene, picture
    start=$(now)
    tachyon "$1" +V -shade_phong -format PPM -o "$2" -numthreads "$threads" >"$2.log" 2>&1 || failed "$2.log"
    since "$start" >>"$folder/tachyon.process"
    seconds 'Preprocessing Time: *\([0-9.]*\) seconds' "$2.log" >>"$folder/tachyon.prepare"
    seconds 'Ray Tracing Time: *\([0-9.]*\) seconds' "$2.log" >>"$folder/tachyon.render"
}

run_embree() { # scene, picture
    start=$(now)
    "$folder/embree" "$1" "$2" "$threads" --res "$res" >"$2.log" 2>&1 || failed "$2.log"
    since "$start" >>"$folder/embree.process"
    sed -n 's/^prepare \([0-9.]*\) ms.*/\1/p' "$2.log" >>"$folder/embree.prepare"
    sed -n 's/.*trace \([0-9.]*\) ms.*/\1/p' "$2.log" >>"$folder/embree.render"
}

median() { sort -g "$1" | awk '{ x[NR] = $1 } END { if (NR) print NR % 2 ? x[(NR + 1) / 2] : (x[NR / 2] + x[NR / 2 + 1]) / 2 }'; }
range() { sort -g "$1" | awk 'NR == 1 { low = $1 } { high = $1 } END { printf "(%.1f … %.1f)", low, high }'; }

# One number of the JSON that compare prints.
number() { awk -F'[:,]' -v key="\"$1\"" 'index($1, key) { print $2 + 0; exit }' "$2"; }

row() { # name, what stands behind its first line
    paste "$folder/$1.prepare" "$folder/$1.render" | awk 'NF == 2 { print $1 + $2 }' >"$folder/$1.both"
    for what in prepare render both process; do
        file=$folder/$1.$what
        if [ ! -s "$file" ]; then
            echo "  $1 reported no $what time"
            continue
        fi
        awk -v row="$name,$1,$what" '{ print row "," NR "," $1 }' "$file" >>"$raw"
        ratio=
        if [ "$1" != trueray ] && [ "$what" != prepare ]; then
            ratio=$(echo "$(median "$file") $(median "$folder/trueray.$what")" | awk '{ printf "× %.2f", $1 / $2 }')
        fi
        printf '  %-8s %-7s %10.1f %-22s %8s  %s\n' "$1" "$what" "$(median "$file")" "$(range "$file")" "$ratio" "$2"
        set -- "$1" ""
    done
}

scene_of() { # file
    name=$(basename "$1" .txt)
    echo
    echo "$name"
    able=
    for peer in $peers; do
        # Embree's program reads scenes as they are.
        case $peer in
        povray) set -- "$1" "$trueray" export "$1" --to "$peer" --res "$res" -o "$folder/$name.pov" ;;
        tachyon) set -- "$1" "$trueray" export "$1" --to "$peer" --res "$res" -o "$folder/$name.dat" ;;
        embree) set -- "$1" "$folder/embree" "$1" "$folder/$name.embree.ppm" "$threads" --res 8x8 ;;
        esac
        scene=$1
        shift
        if "$@" >/dev/null 2>"$folder/$peer.why"; then
            able="$able $peer"
        else
            echo "  $peer cannot take part:"
            sed 's/^/    /' "$folder/$peer.why"
        fi
        set -- "$scene"
    done
    # The first round warms up: caches of files and of compiled kernels.
    round=0
    while [ "$round" -le "$runs" ]; do
        run_trueray "$1" truncate "$folder/$name.truncate.ppm"
        for peer in $able; do
            case $peer in
            povray) run_povray "$folder/$name.pov" "$folder/$name.povray.ppm" ;;
            tachyon) run_tachyon "$folder/$name.dat" "$folder/$name.tachyon.ppm" ;;
            embree) run_embree "$1" "$folder/$name.embree.ppm" ;;
            esac
        done
        [ "$round" -gt 0 ] || rm -f "$folder"/*.prepare "$folder"/*.render "$folder"/*.process
        round=$((round + 1))
    done
    row trueray "on $(sed -n 's/^ *"device": "\(.*\)",*$/\1/p' "$folder/$name.truncate.ppm.json")"
    for peer in $able; do
        quantize=truncate
        if [ "$peer" = povray ]; then
            quantize=round
            "$trueray" render "$1" -o "$folder/$name.round.ppm" --res "$res" --quantize round --device "$device" \
                --precision "$precision" -q
        fi
        code=0
        "$trueray" compare --json "$folder/$name.$quantize.ppm" "$folder/$name.$peer.ppm" >"$folder/compare.json" || code=$?
        [ "$code" -le 1 ] || exit "$code"
        set -- "$1" "$(number over_0 "$folder/compare.json")" "$(number over_2 "$folder/compare.json")" \
            "$(number over_10 "$folder/compare.json")" "$(number pixels "$folder/compare.json")"
        row "$peer" "of $5 pixels $2 differ, $3 by more than 2 levels, $4 by more than 10"
    done
}

echo "$("$trueray" -V), $res, $threads threads, precision $precision, $runs runs, medians in ms (least … greatest)"
for peer in $peers; do
    case $peer in
    povray) povray --version 2>&1 | sed -n 's/^\(POV-Ray [0-9.a-z]*\).*/\1/p' | head -n 1 ;;
    tachyon) echo "Tachyon $(tachyon -version)" ;;
    embree) "$folder/embree" --version ;;
    esac
done

if [ $# -eq 0 ]; then
    rm -rf "$folder/scenes"
    "$trueray" bench --families "${FAMILIES:-spheres}" --max-spheres "${MAX_SPHERES:-1000}" --write "$folder/scenes" 2>/dev/null
    # By size, not by name.
    set -- $(ls -rS "$folder/scenes"/*.txt)
fi
for scene in "$@"; do
    scene_of "$scene"
done
