#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What packages_boot.sh has a booted Debian 12 do, whose service manager has started cauteryd: reload it,
# find it when it hangs, stop it. Writes what it says to /packages/said, and powers off.
set -euo pipefail
exec >/packages/said 2>&1
trap poweroff EXIT
export CAUTERYD_URL=ws://127.0.0.1:8740

fail() {
	echo "FAILED: $*"
	journalctl -u cauteryd --no-pager | tail -n 20
	exit 1
}

main_pid() {
	systemctl show cauteryd -p MainPID --value
}

[ "$(systemctl is-active cauteryd)" = active ] || fail "it has not been started at boot"
[ "$(stat -c %U "/proc/$(main_pid)")" = cautery ] || fail "it is not its user's process"
session=$(env -u HOME -u XDG_CONFIG_HOME cautery create fascia)
systemctl reload cauteryd
for ((waited = 0; waited < 100; waited++)); do
	[ "$(journalctl -u cauteryd --no-pager | grep -c 'event=reloaded')" = 0 ] || break
	sleep 0.1 # a look at a time
done
[ "$waited" -lt 100 ] || fail "it was not told to reload"
echo "reloaded"

# It hangs: the watchdog ends it, and it comes back with its session.
first=$(main_pid)
kill -STOP "$first"
for ((waited = 0; waited < 60; waited++)); do
	[ "$(main_pid)" = "$first" ] || break
	sleep 1
done
[ "$(main_pid)" != "$first" ] || fail "it hung for a minute, and nobody minded"
for ((i = 0; i < 30; i++)); do
	cautery info "$session" >/packages/info 2>&1 && break
	sleep 1
done
grep -q "scene fascia" /packages/info || fail "its session is gone: $(cat /packages/info)"
echo "found by the watchdog after $waited s"
systemctl stop cauteryd
[ "$(systemctl show cauteryd -p Result --value)" = success ] || fail "it did not stop well"
[ -z "$(systemctl --failed --no-legend)" ] || fail "failed: $(systemctl --failed --no-legend)"
echo "all is well"
