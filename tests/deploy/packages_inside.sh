#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What packages.sh does inside its bare Debian 12; /packages has the packages in two revisions, the
# first of an earlier commit.
set -euo pipefail

step() {
	echo "== $*"
}

fail() {
	echo "FAILED: $*" >&2
	[ ! -e /tmp/daemon.log ] || tail -n 20 /tmp/daemon.log >&2
	exit 1
}

# run_daemon OPTION...: as the unit says, by its user, in its state folder; sets $daemon, $CAUTERYD_URL.
run_daemon() {
	local command address
	command=$(sed -n 's/^ExecStart=//p' /usr/lib/systemd/system/cauteryd.service)
	install -d -o cautery -g cautery -m 700 /var/lib/cautery # systemd's StateDirectory
	rm -f /tmp/address
	(cd /var/lib/cautery && exec setpriv --reuid=cautery --regid=cautery --clear-groups --bounding-set=-all \
		--inh-caps=-all --no-new-privs $command --port 0 --json "$@") >/tmp/address 2>/tmp/daemon.log &
	daemon=$!
	for ((i = 0; i < 300; i++)); do
		[ ! -s /tmp/address ] || break
		kill -0 $daemon || fail "the daemon ended"
		sleep 0.1
	done
	address=$(sed -n 's/.*"url": "http\([^"]*\)".*/ws\1/p' /tmp/address)
	[ -n "$address" ] || fail "the daemon told no address"
	export CAUTERYD_URL=$address
}

end_daemon() {
	kill -TERM $daemon
	wait $daemon || fail "the daemon ended with $?"
}

step "install"
apt-get update -q >/dev/null
apt-get install -q -y --no-install-recommends /packages/*-1_amd64.deb >/tmp/apt.log 2>&1 || {
	tail -n 20 /tmp/apt.log
	fail "the packages do not install"
}
getent passwd cautery || fail "no user cautery"
cauteryd --version


# vertices: those of the session as it is, exported.
vertices() {
	cautery export "$session" /tmp/tissue.obj >/dev/null
	grep '^v ' /tmp/tissue.obj
}

tick() {
	cautery info "$session" | sed -n 's/^ *tick \([0-9]*\),.*/\1/p'
}

step "run as its user, and cut"
run_daemon
session=$(cautery create fascia)
cautery ls | grep -q "$session" || fail "the session is not listed"
cautery speed "$session" 10 >/dev/null
cautery-sim --scene fascia --print-cut | cautery run "$session" - 2>/dev/null | tee /tmp/run
grep -q ' [1-9][0-9]* faces gone' /tmp/run || fail "nothing was cut"
cautery pause "$session"
vertices >/tmp/before
before=$(tick)
[ "$(stat -c %U /var/lib/cautery/cautery.db)" = cautery ] || fail "the store is not its user's"
end_daemon

step "upgrade, with a session in the store and settings of the administrator's"
echo '{"max_sessions": 7}' >/etc/cautery/cauteryd.json
dpkg -i /packages/*-2_amd64.deb >/tmp/dpkg.log 2>&1 || fail "the upgrade: $(tail -n 3 /tmp/dpkg.log)"
dpkg-query -W -f '${Package} ${Version}\n' cauteryd | grep -q -- '-2$' || fail "not upgraded"
grep -q max_sessions /etc/cautery/cauteryd.json || fail "the administrator's settings are lost"
cauteryd --version
run_daemon
cautery info "$session" >/tmp/info || fail "the session did not outlive the upgrade"
[ "$(tick)" = "$before" ] || fail "it is at tick $(tick), and was at $before"
vertices | cmp - /tmp/before || fail "its tissue is not where it was"
cautery resume "$session"
cautery speed "$session" 1
for ((waited = 0; waited < 100; waited++)); do
	[ "$(tick)" -le "$before" ] || break
	sleep 0.1 # a look at a time
done
[ "$(tick)" -gt "$before" ] || fail "it does not go on"
cautery rewind "$session" 60 | grep -q "is at tick 60," || fail "it did not go back"
cautery reset "$session" | grep -q "is at tick 0," || fail "it did not start over"
end_daemon

step "TLS"
apt-get install -q -y --no-install-recommends openssl curl >/dev/null 2>&1
install -d -o cautery -g cautery -m 700 /tmp/tls
openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -addext subjectAltName=DNS:localhost \
	-keyout /tmp/tls/key.pem -out /tmp/tls/certificate.pem 2>/dev/null
chown cautery: /tmp/tls/*
run_daemon --tls-certificate /tmp/tls/certificate.pem --tls-key /tmp/tls/key.pem
port=$(sed -n 's/.*"port": \([0-9]*\).*/\1/p' /tmp/address)
curl -sS --cacert /tmp/tls/certificate.pem "https://localhost:$port/api/sessions" | grep -q "$session" || fail "no sessions over TLS"
for page in manual/ manual/api/session.html; do
	curl -sS --cacert /tmp/tls/certificate.pem "https://localhost:$port/$page" | grep -q "Cautery manual" || fail "no page $page"
done
end_daemon

step "a client is built against libcautery-dev"
apt-get install -q -y --no-install-recommends gcc libc6-dev pkg-config >/dev/null 2>&1
cc -o /tmp/example /usr/share/doc/cautery/examples/teaching.c -D_GNU_SOURCE \
	$(pkg-config --cflags --libs cautery-client)

step "a program is built against libcautery-core-dev"
sed -n '/^```c$/,/^```$/p' /usr/share/doc/cautery/core/README.md | sed '1d;$d' >/tmp/core.c
cc -o /tmp/core /tmp/core.c $(pkg-config --cflags --libs cautery-core)
/tmp/core /usr/share/cautery/scenes/fascia.json | grep -q '^3111 vertices' || fail "the core's example"

step "Python, with the core in process"
apt-get install -q -y --no-install-recommends /packages/*-2_all.deb >/tmp/apt.log 2>&1 || fail "Python: $(tail -n 3 /tmp/apt.log)"
python3 -c 'import cautery_core; print(cautery_core.Session("/usr/share/cautery/scenes/fascia.json").step(3))' | grep -qx 3 ||
	fail "the core in Python"

step "remove, then purge"
dpkg -r cauteryd >/dev/null
[ -e /var/lib/cautery/cautery.db ] || fail "the store went with the package: that is what purge is for"
dpkg -P python3-cautery-core python3-cautery cauteryd cautery-clients libcautery-core-dev libcautery-core0.1 libcautery-dev >/dev/null
for left in /var/lib/cautery /etc/cautery /usr/share/cautery /usr/lib/systemd/system/cauteryd.service; do
	[ ! -e $left ] || fail "$left is left: $(find $left | head -n 3)"
done
[ -z "$(dpkg-query -W -f '${Package}\n' 'cauter*' 'libcautery*' 2>/dev/null)" ] || fail "a package is left"
echo "all is well"
