#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds, and starts cauteryd on this machine with the demo session.
set -euo pipefail

usage() {
	cat <<'END'
Usage: deploy/run.sh [--no-install] [--detach] [FLAG VALUE]...

  --no-install  fail if a package is missing, instead of installing it
  --detach      return once the daemon is ready; its log goes to daemon.log beside its store
  --help        this text

Everything else goes to cauteryd (build/bin/cauteryd --help lists its flags), for example
`deploy/run.sh --port 9000`. The store stands in the user's state folder,
${XDG_STATE_HOME:-~/.local/state}/cautery, and sessions go on where they were at the next start.
END
}

install=yes
detach=no
flags=()
for argument in "$@"; do
	case $argument in
	--no-install) install=no ;;
	--detach) detach=yes ;;
	--help | -h)
		usage
		exit 0
		;;
	*) flags+=("$argument") ;;
	esac
done

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$source_folder"
script=deploy/run.sh
logs=$source_folder/build/log
jobs=${CAUTERY_JOBS:-$(nproc)}
export LC_ALL=C.UTF-8
if [ ! -w "${HOME:-}" ]; then
	export HOME=$source_folder/build/home
	mkdir -p "$HOME"
fi
mkdir -p "$logs"
. deploy/install.sh

install_packages build libraries viewer
heading "build (logs in build/log)"
if [ ! -f build/CMakeCache.txt ]; then
	quietly configure-run env CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}" \
		cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DCAUTERY_TESTS=OFF
fi
targets=(cauteryd)
known=$(cmake --build build --target help)
for program in cautery cautery-sim; do
	if grep -qE "(^|\.\.\. )$program(:|\$)" <<<"$known"; then
		targets+=("$program")
	fi
done
quietly build-run cmake --build build --target "${targets[@]}" --parallel "$jobs"

state=${XDG_STATE_HOME:-$HOME/.local/state}/cautery
mkdir -p "$state"
chmod 700 "$state"
viewer=()
if [ "$install" = yes ]; then
	install_npm_packages clients/web
fi
if [ -d clients/web/node_modules/vite ]; then
	heading "build the viewer"
	quietly build-viewer npm run --silent --prefix clients/web build
fi
if [ -d clients/web/dist ]; then
	viewer=(--viewer clients/web/dist)
fi

ready=$(mktemp -u "$state/ready.XXXXXX")
mkfifo "$ready"
trap 'rm -f "$ready"' EXIT
command=(build/bin/cauteryd --json --store "$state/cautery.db" --demo layers "${viewer[@]}"
	"${flags[@]}")
if [ "$detach" = yes ]; then
	setsid "${command[@]}" >"$ready" 2>>"$state/daemon.log" </dev/null &
else
	"${command[@]}" >"$ready" &
fi
daemon=$!
if ! read -r line <"$ready"; then
	status=0
	wait "$daemon" || status=$?
	echo "deploy/run.sh: cauteryd ended (status $status)" >&2
	exit 1
fi
rm -f "$ready"
url=$(sed -n 's/.*"url": "\([^"]*\)".*/\1/p' <<<"$line")
cat <<END

cauteryd is running (process $daemon), with the demo session d1-layers.

  open      $url
  look      curl ${url}api/sessions
END
if [ -x build/bin/cautery ]; then
	cat <<END
  next      build/bin/cautery --url ws${url#http} watch d1-layers
            build/bin/cautery --url ws${url#http} run d1-layers deploy/scenes/scripts/layers-cut.jsonl
END
fi
if [ "$detach" = yes ]; then
	echo "  stop      kill $daemon"
	exit 0
fi
echo "  stop      Ctrl-C (sessions are kept and go on at the next start)"
echo
trap 'kill -TERM "$daemon" 2>/dev/null || true' INT TERM
status=0
wait "$daemon" || status=$?
if kill -0 "$daemon" 2>/dev/null; then # the signal ended the first wait
	status=0
	wait "$daemon" || status=$?
fi
exit "$status"
