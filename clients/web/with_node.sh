#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a program of node_modules with the Node that package-lock.json pins, where npm has installed
# one for this machine's system and processor, or else with the machine's own: with_node.sh PROGRAM...
# npm itself may be of an older Node, such as Debian's.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
for folder in "$here"/node_modules/node-*/bin; do
	if "$folder/node" --version >/dev/null 2>&1; then
		PATH=$folder:$PATH
	fi
done
# What `engines` in package.json says, which is what the packages want.
if ! node -e 'const [major, minor] = process.versions.node.split("."); process.exit(major > 22 || (major == 22 && minor >= 13) ? 0 : 1)'; then
	echo "clients/web: Node 22.13 or newer is wanted here (\`npm ci\` installs one for Linux on x64 and arm64)" >&2
	exit 1
fi
exec "$@"
