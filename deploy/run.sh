#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds, and starts cauteryd on this machine with the demo session.
set -euo pipefail

usage() {
	cat <<'END_OF_USAGE'
Usage: deploy/run.sh [--no-install] [--detach] [--patience SECONDS] [FLAG VALUE]...

  --no-install        fail if a package is missing, instead of installing it
  --detach            return once the daemon is ready; its log goes to daemon.log beside its store
  --patience SECONDS  with --detach: end the daemon and fail if it is not ready by then [120]
  --help              this text

Everything else goes to cauteryd (build/bin/cauteryd --help lists its flags), for example
`deploy/run.sh --port 9000`. The store stands in the user's state folder,
${XDG_STATE_HOME:-~/.local/state}/cautery, and sessions go on where they were at the next start.

The first time it takes minutes (on two cores two or three to install packages on a bare machine,
one to build), later ones seconds. It builds in build/, as deploy/test.sh and builds by hand do, in
any order.
END_OF_USAGE
}

install=yes
detach=no
patience_s=120
# What cauteryd would take: looked at before it is built.
listen=${CAUTERY_LISTEN:-127.0.0.1}
port=${CAUTERY_PORT:-8740}
store=${CAUTERY_STORE:-}
flags=()
while [ $# -gt 0 ]; do
	case $1 in
	--no-install) install=no ;;
	--detach) detach=yes ;;
	--patience)
		patience_s=${2:-}
		if ! [[ $patience_s =~ ^[0-9]+$ ]]; then
			echo "deploy/run.sh: --patience wants a number of seconds" >&2
			exit 2
		fi
		shift
		;;
	--help | -h)
		usage
		exit 0
		;;
	--listen | --port | --store)
		declare "${1#--}=${2:-}"
		flags+=("$1" "${@:2:1}")
		shift $(($# > 1 ? 1 : 0))
		;;
	--config) # may say anything
		port=0
		flags+=("$1")
		;;
	*) flags+=("$1") ;;
	esac
	shift
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
. deploy/progress.sh
. deploy/install.sh
. deploy/trees.sh

state=${XDG_STATE_HOME:-$HOME/.local/state}/cautery
store=${store:-$state/cautery.db}
log=$(dirname "$store")/daemon.log

complain() {
	echo "$script: $*" >&2
	exit 1
}

# Before the minutes of building: what would keep the daemon from starting.
refuse_second_daemon() {
	if [ -f "$store-lock" ] && ! flock -n "$store-lock" true; then
		complain "cauteryd is running already: process $(cat "$store-lock") has the store $store." \
			"Use that one, or stop it (kill $(cat "$store-lock")), or start another beside it" \
			"(--store FILE --port 0)."
	fi
	if [ "$port" != 0 ] && (: <>"/dev/tcp/$listen/$port") 2>/dev/null; then
		complain "another program listens on $listen port $port." \
			"Stop it, or take another port (--port 9000; --port 0: any that is free)."
	fi
}

build_programs() {
	local new=() targets=(cauteryd) known program
	fresh_where_needed build
	# Tests where they can be built: on a bare machine deploy/packages.txt's tests are not installed.
	is_configured build && [ ${#fresh[@]} -eq 0 ] ||
		new=(-DCMAKE_BUILD_TYPE=Release -DCAUTERY_TESTS=AUTO)
	watched configure-run cmake "${fresh[@]}" -S . -B build \
		-DCAUTERY_SERVER=ON -DCAUTERY_CLIENTS=ON "${new[@]}"
	known=$(cmake --build build --target help)
	for program in cautery cautery-sim; do
		if grep -qE "(^|\.\.\. )$program(:|\$)" <<<"$known"; then
			targets+=("$program")
		fi
	done
	watched build-run cmake --build build --target "${targets[@]}" --parallel "$jobs"
}

build_viewer() {
	if [ "$install" = yes ]; then
		install_npm_packages clients/web
	fi
	if [ -d clients/web/node_modules/vite ] && clients/web/with_node.sh true; then
		heading "build the viewer and the manual"
		watched build-viewer npm run --silent --prefix clients/web build
		# Without a manual there is a daemon all the same.
		(watched build-manual npm run --silent --prefix clients/web manual) || true
	fi
	viewer=()
	if [ -d clients/web/dist ]; then
		viewer+=(--viewer clients/web/dist)
	fi
	if [ -d clients/web/dist-manual ]; then
		viewer+=(--manual clients/web/dist-manual)
	fi
}

# start: runs the daemon in the background, waits until it tells its address in a line, sets $daemon
# and $address.
start() {
	local status=0 ready command
	ready=$(mktemp -u "$state/ready.XXXXXX")
	mkfifo "$ready"
	command=(build/bin/cauteryd --json --store "$store" --demo layers "${viewer[@]}" "${flags[@]}")
	if [ "$detach" = yes ]; then
		setsid "${command[@]}" >"$ready" 2>>"$log" </dev/null &
	else
		"${command[@]}" >"$ready" &
	fi
	daemon=$!
	trap 'kill -TERM "$daemon" 2>/dev/null || true' INT TERM
	read -r address <"$ready" || true
	rm -f "$ready"
	if [ -z "$address" ]; then
		wait "$daemon" || status=$?
		complain "cauteryd ended (status $status)$(reason_it_gave)"
	fi
}

# The reason in the last line of the log, which nobody has seen of a detached daemon.
reason_it_gave() {
	if [ "$detach" = yes ]; then
		tail -n 1 "$log" | sed -n 's/.* reason="\(.*\)"$/: \1/p'
		echo " (its log: $log)"
	fi
}

# field NAME: of the daemon's line of JSON.
field() {
	sed -n "s/.*\"$1\": \"\{0,1\}\([^\",}]*\).*/\1/p" <<<"$address"
}

# ask_ready: the answer of /readyz, its status line and its body.
ask_ready() {
	(
		exec 3<>"/dev/tcp/$(field address)/$(field port)"
		printf 'GET /readyz HTTP/1.1\r\nHost: %s:%s\r\nConnection: close\r\n\r\n' \
			"$(field address)" "$(field port)" >&3
		timeout 5 cat <&3
	) 2>/dev/null | tr -d '\r' | sed -n '1p;$p'
}

# Its sessions are built or resumed after it has begun to listen: a large store takes its time.
await_ready() {
	local answer status=0 began=$SECONDS
	until answer=$(ask_ready) && [[ $answer == 'HTTP/1.1 200'* ]]; do
		if ! kill -0 "$daemon" 2>/dev/null; then
			wait "$daemon" || status=$?
			complain "cauteryd ended (status $status) before it was ready$(reason_it_gave)"
		fi
		waited=$((SECONDS - began))
		if [ "$detach" = yes ] && [ $waited -ge "$patience_s" ]; then
			end_unready "$answer"
		fi
		if [ $waited -ge $((told + silent_s)) ]; then
			told=$waited
			echo "   $waited s  not ready yet: $(tail -n 1 <<<"$answer")"
		fi
		sleep 0.2
	done
}

# A script that is told "failed" finds nothing running.
end_unready() {
	kill -TERM "$daemon" 2>/dev/null || true
	for ((i = 0; i < 20; i++)); do
		kill -0 "$daemon" 2>/dev/null || break
		sleep 1
	done
	kill -KILL "$daemon" 2>/dev/null || true
	complain "cauteryd was not ready after $patience_s s and has been ended. It said last:" \
		"$(tail -n 1 <<<"$1"). Its log: $log. A large store may want a longer --patience."
}

tell_running() {
	local url
	url=$(field url)
	cat <<-END_OF_TEXT

		cauteryd is running (process $daemon), with the demo session d1-layers.

		  open      $url
		  look      curl ${url}api/sessions
	END_OF_TEXT
	if [ -d clients/web/dist-manual ]; then
		echo "  read      ${url}manual/"
	fi
	if [ -x build/bin/cautery ] && [ -x build/bin/cautery-sim ]; then
		cat <<-END_OF_TEXT
			  next      build/bin/cautery --url ws${url#http} watch d1-layers
			            build/bin/cautery-sim --scene layers --print-cut | build/bin/cautery --url ws${url#http} run d1-layers -
		END_OF_TEXT
	fi
	if [ "$detach" = yes ]; then
		echo "  stop      kill $daemon"
	else
		echo "  stop      Ctrl-C (sessions are kept and go on at the next start)"
		echo
	fi
}

refuse_second_daemon
install_packages build libraries viewer
heading "build (logs in build/log; about a minute the first time on two cores)"
build_programs
build_viewer
mkdir -p "$state"
chmod 700 "$state"

heading "start"
told=0
address=
start
await_ready
tell_running
if [ "$detach" = yes ]; then
	exit 0
fi
status=0
wait "$daemon" || status=$?
if kill -0 "$daemon" 2>/dev/null; then # the signal ended the first wait
	status=0
	wait "$daemon" || status=$?
fi
exit "$status"
