#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds a tree as a test of the suite that deploy/test.sh runs: what the compiler says goes to a log,
# of which a failure shows the end. Usage: build_tree.sh LOG COMMAND...
set -euo pipefail
log=$1
shift
if ! "$@" >"$log" 2>&1; then
	tail -n 60 "$log"
	echo "failed: $* (all of it: $log)"
	exit 1
fi
