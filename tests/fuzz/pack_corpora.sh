#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes tests/fuzz/corpora anew from the minimised corpora that the fuzz tests of a tree have kept, best
# after `deploy/test.sh --long`. Usage: pack_corpora.sh TREE
set -euo pipefail
corpora=$(cd "$(dirname "$0")" && pwd)/corpora
mkdir -p "$corpora"
for kept in "$1"/fuzz/corpus/*/; do
	# the same files make the same bytes
	tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=644 -C "$kept" -cf - --files-from \
		<(cd "$kept" && find . -type f | sort) | gzip -9n >"$corpora/$(basename "$kept").tar.gz"
done
