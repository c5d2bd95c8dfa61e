#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the Node tests: run.sh GOLDEN_PROGRAM SOURCE_FOLDER WORK_FOLDER ASYNCAPI. Packages are installed
# into the work folder by the lock file, so the source tree stays clean.
set -eu
golden=$1 source=$2 work=$3 asyncapi=$4
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
	echo "skipped: node and npm are not installed"
	exit 77
fi
mkdir -p "$work/golden"
cp "$source"/*.mjs "$source"/package.json "$source"/package-lock.json "$source"/.npmrc "$work"
cd "$work"
if ! cmp -s package-lock.json node_modules/.installed; then
	npm ci --ignore-scripts --no-progress
	cp package-lock.json node_modules/.installed
fi
"$golden" "$work/golden"
CAUTERY_GOLDEN=$work/golden CAUTERY_ASYNCAPI=$asyncapi node --test frames.test.mjs messages.test.mjs
