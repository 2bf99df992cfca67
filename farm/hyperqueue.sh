#!/bin/sh
# A picture in parts on HyperQueue, whose server and workers run: an array of tiles, then the merge.
#   farm/hyperqueue.sh SCENE PICTURE TILES [OPTION of `trueray render`]...
# TRUERAY is the program's path, HQ that of hq.
set -eu
scene=$1 picture=$2 tiles=$3
shift 3
trueray=${TRUERAY:-trueray}
parts=$picture.parts
mkdir -p "$parts"
"${HQ:-hq}" submit --wait --name trueray --cpus all --array "0-$((tiles - 1))" --stdout none --stderr "$parts/%{TASK_ID}.log" \
    sh -c 'trueray=$0 scene=$1 parts=$2 tiles=$3; shift 3
           exec "$trueray" render --resume "$@" --tile "$HQ_TASK_ID/$tiles" "$scene" -o "$parts/$HQ_TASK_ID.png"' \
    "$trueray" "$scene" "$parts" "$tiles" "$@"
exec "$trueray" merge "$parts"/*.png -o "$picture"
