#!/usr/bin/env bash
# Labels all buildings with truth and prints a table by kind of building: score.sh DATA OUT [MODELS]
#
# MODELS is a folder of models that have not seen a building: BUILDING.model.json labels the maps of BUILDING, the default
# model all others (leave one building out). PLACEGRAPH names the program. REPORT=1 adds the buildings of eval2, which nobody
# chooses by: the run goes into docs/dev/eval2-runs.md with its date. docs/dev/training-set.md says more.
set -euo pipefail
data=$1 out=$2 models=${3:-} program=${PLACEGRAPH:-placegraph}
here=$(cd "$(dirname "$0")" && pwd)

# The building of a map: that of meta.json, or the name of a plan without its floor.
building() {
    local named
    named=$(sed -n 's/^ *"building": *"\([^"]*\)".*/\1/p' "$1/meta.json" 2>/dev/null | head -1) || true
    [ -n "$named" ] && { echo "$named"; return; }
    basename "$1" | sed -E 's/_[0-9]+_[0-9]{3}$//; s/(_P[01]|[12]|firstfloor|groundfloor|secondfloor)$//; s/_$//'
}

# score SET FOLDER TRUTH [PATTERN]: labels the maps of FOLDER that have TRUTH, and prints a row.
score() {
    local set=$1 folder=$2 truth=$3 pattern=${4:-*} map name model links=$out/truth/$1
    mkdir -p "$links" "$out/maps/$set"
    for map in "$folder"/$pattern/; do
        map=${map%/} name=$(basename "$map")
        [ -f "$map/$truth" ] || continue
        [ "$set" = eval2-clean ] && [[ "$name" = *_robot ]] && continue
        ln -sfn "$map" "$links/$name"
        model=$models/$(building "$map").model.json
        [ -n "$models" ] && [ -f "$model" ] || model=
        "$program" map "$map/map.yaml" --out "$out/maps/$set/$name" ${model:+--model "$model"} 2>>"$out/log.txt" ||
            echo "no result: $map" >>"$out/log.txt"
    done
    "$program" evaluate "$out/maps/$set" "$links" --truth "$truth" --csv "$out/$set.csv" >"$out/$set.txt" || [ $? = 1 ]
    awk -v set="$set" '
        $1 == "mean" && !n { cells = $2; f1 = $3; rooms = $6 " / " $7 " / " $8; n = NR - 2 }
        $1 == "corridor" && $4 == "%" && corridor == "" { corridor = $5 }
        $1 == "all" && NF == 9 { found = $4; right = $8; doors = $2 }
        END { printf "| %s | %d | %s | %s | %s | %d | %s | %s | %s |\n", set, n, cells, f1, corridor, doors, found, right, rooms }' "$out/$set.txt"
}

mkdir -p "$out"
echo "| buildings | maps | cells | macro-F1 | corridor recall | doors | found | right | rooms: recall / precision / IoU |"
echo "|---|---|---|---|---|---|---|---|---|"
score eval-authors "$data/eval" labels.png
score eval-hand "$data/eval" labels_hand.png
score plans "$data/plans" labels.png
# Flats that no training set has: those from the 900th on.
for mapping in clean slam; do
    [ -d "$out/flats-$mapping" ] || "$program" generate --plan "$data/flats/flats.jsonl" --seed 7 --first 900 --count 40 \
        --mapping "$mapping" --resolution 0.05 --out "$out/flats-$mapping" 2>>"$out/log.txt" || [ $? = 1 ]
    score "flats-$mapping" "$out/flats-$mapping" labels.png
done
if [ "${REPORT:-}" = 1 ]; then
    {
        echo
        echo "$(date -u +%F\ %H:%M), commit $(git -C "$here" rev-parse --short HEAD)${models:+, models of other buildings}:"
        echo
        echo "| buildings | maps | cells | macro-F1 | corridor recall | doors | found | right | rooms: recall / precision / IoU |"
        echo "|---|---|---|---|---|---|---|---|---|"
        score eval2-clean "$data/eval2" labels.png
        score eval2-robot "$data/eval2" labels.png '*_robot'
    } | tee -a "$here/eval2-runs.md"
fi
