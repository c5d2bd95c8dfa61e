# SPDX-License-Identifier: GPL-3.0-or-later
# What deploy/test.sh and deploy/run.sh say while they work; to be sourced with bash.
# Expects: $script, the caller's name for messages; $logs, a folder.
# shellcheck shell=bash disable=SC2154

# A command that takes longer than this gets a line that says how far it is: on a terminal one line
# that changes every second, elsewhere a new one every so often, so that a log stays readable.
silent_s=5
line_every_s=15

heading() {
	printf '== [%d:%02d] %s\n' $((SECONDS / 60)) $((SECONDS % 60)) "$*"
}

# how_far LOG: the last line of a log, with a share of the whole where ninja counts its steps.
how_far() {
	tail -c 2000 "$1" 2>/dev/null | tr '\r' '\n' | awk '
		NF { line = $0 }
		END {
			if (match(line, /^\[[0-9]+\/[0-9]+\] /)) {
				split(substr(line, 2, RLENGTH - 3), steps, "/")
				line = sprintf("%3d %% %s", 100 * steps[1] / steps[2], substr(line, RLENGTH + 1))
			}
			print substr(line, 1, 90)
		}'
}

# tell_progress LOG: until it is killed or the script is gone.
tell_progress() {
	local every=$line_every_s second
	[ ! -t 1 ] || every=1
	for ((second = 1; ; second++)); do
		sleep 1
		kill -0 $$ 2>/dev/null || return
		if [ $second -ne $silent_s ] && { [ $second -lt $silent_s ] || [ $((second % every)) -ne 0 ]; }; then
			continue
		fi
		if [ -t 1 ]; then
			printf '\r\033[K   %4d s  %s' $second "$(how_far "$1")"
		else
			printf '   %4d s  %s\n' $second "$(how_far "$1")"
		fi
	done
}

# watched LOG COMMAND...: the output goes to a log, how far it is to the terminal, and the log's end
# too if the command fails.
watched() {
	local log=$logs/$1.log status=0 teller
	shift
	: >"$log"
	tell_progress "$log" &
	teller=$!
	"$@" >"$log" 2>&1 || status=$?
	kill "$teller" 2>/dev/null || true
	wait "$teller" 2>/dev/null || true
	[ ! -t 1 ] || printf '\r\033[K'
	if [ $status -ne 0 ]; then
		tail -n 60 "$log" >&2
		echo "$script: failed (status $status): $* (all of it: $log)" >&2
		exit 1
	fi
}
