#!/bin/sh
# Submits a picture in parts to Slurm: an array of tiles, and a merge that waits for all of them.
#   farm/slurm.sh SCENE PICTURE TILES [OPTION of `trueray render`]...
# SBATCH_TIMELIMIT and the other variables of sbatch hold; so does TRUERAY, the program's path. Prints the number of the merge.
set -eu
scene=$1 picture=$2 tiles=$3
shift 3
trueray=${TRUERAY:-trueray}
parts=$picture.parts
mkdir -p "$parts"

# Ten seconds before the time limit, and where a job is preempted, SIGTERM ends a tile with code 75: it is queued again.
render=$(sbatch --parsable --job-name=trueray-tile --array=0-$((tiles - 1)) --requeue --signal=TERM@10 \
    --output="$parts/%a.log" --open-mode=append /dev/stdin "$trueray" "$scene" "$parts" "$tiles" "$@" <<'TILE'
#!/bin/sh
trueray=$1 scene=$2 parts=$3 tiles=$4
shift 4
srun "$trueray" render --resume "$@" --tile "$SLURM_ARRAY_TASK_ID/$tiles" "$scene" -o "$parts/$SLURM_ARRAY_TASK_ID.png"
code=$?
if [ $code = 75 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 10 ]; then
    scontrol requeue "$SLURM_JOB_ID"
fi
exit $code
TILE
)
sbatch --parsable --job-name=trueray-merge --dependency="afterok:$render" --output="$parts/merge.log" /dev/stdin \
    "$trueray" "$parts" "$picture" <<'MERGE'
#!/bin/sh
exec "$1" merge "$2"/*.png -o "$3"
MERGE
