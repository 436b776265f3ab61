#!/usr/bin/env bash
# Writes the maps that doors and spaces are learned from: training-set.sh OUT [DATA]
#
# OUT gets generated/, and with DATA (a folder with plans/xml/*.xml and flats/flats.jsonl) also plans/ and flats/, each
# with the folders clean/, furnished/ and slam/. Same program, same DATA, same bytes. PLACEGRAPH names the program.
# docs/dev/training-set.md describes the files.
set -euo pipefail
out=$1 data=${2:-} program=${PLACEGRAPH:-placegraph} seed=101

generate() { "$program" generate --seed "$seed" "$@" || [ $? = 1 ]; }

for mapping in clean furnished slam; do
    count=5
    [ "$mapping" = slam ] && count=12
    for style in office home hospital hotel school warehouse campus open-office flat; do
        generate --style "$style" --mapping "$mapping" --count "$count" --out "$out/generated/$mapping"
    done
done
[ -n "$data" ] || exit 0

plans=()
for plan in "$data"/plans/xml/*.xml; do plans+=(--plan "$plan"); done
first=0
for mapping in clean furnished slam; do
    generate "${plans[@]}" --license MIT --mapping "$mapping" --out "$out/plans/$mapping"
    count=80
    [ "$mapping" = slam ] && count=160
    generate --plan "$data/flats/flats.jsonl" --license MIT --mapping "$mapping" --first "$first" --count "$count" \
        --out "$out/flats/$mapping"
    first=$((first + count))
done
