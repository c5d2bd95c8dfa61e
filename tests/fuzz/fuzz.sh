#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fuzzes for some seconds, from the seeds, from what long runs found (corpora/) and from what earlier
# ones of this tree did, and keeps the smallest corpus that reaches as much, so that the next run
# spends its time on what is new.
# Usage: fuzz.sh PROGRAM SECONDS CORPUS ARTIFACT_PREFIX [SEEDS]
set -euo pipefail
program=$1 seconds=$2 corpus=$3 prefix=$4
seeds=("${@:5}")
limits=(-timeout=10 -rss_limit_mb=2048 -max_len=65536 "-artifact_prefix=$prefix")

mkdir -p "$corpus"
found=$(dirname "$0")/corpora/$(basename "$corpus").tar.gz # by pack_corpora.sh
if [ -f "$found" ]; then
	tar -xzf "$found" -C "$corpus"
fi
"$program" "${limits[@]}" -max_total_time="$seconds" -print_final_stats=1 "$corpus" "${seeds[@]}"
smallest=$corpus.smallest
rm -rf "$smallest"
mkdir "$smallest"
"$program" "${limits[@]}" -merge=1 "$smallest" "$corpus" "${seeds[@]}"
rm -rf "$corpus"
mv "$smallest" "$corpus"
