#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The packages that packages.sh has made, on a bare Debian 12 that is booted (systemd-nspawn), whose
# service manager has the daemon.
#
# Usage: packages_boot.sh FOLDER      FOLDER: that of packages.sh, after it
# Exit code 77: cannot be done here, and why is printed.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:?usage: packages_boot.sh FOLDER}
base=$folder/base root=$folder/booted

skip() {
	echo "skipped: $*"
	exit 77
}

command -v systemd-nspawn >/dev/null || skip "systemd-nspawn is not installed"
ls "$folder"/tree/packages/cauteryd*.deb >/dev/null || skip "there are no packages: packages.sh has not run"
boot=(systemd-nspawn --quiet --register=no --keep-unit --directory "$root")
rm -rf "$root"
cp -a "$base" "$root"
"${boot[@]}" true 2>/dev/null || skip "systemd-nspawn runs no container here"
cp /etc/resolv.conf /etc/hosts "$root/etc/"
install -D -t "$root/packages" "$folder"/tree/packages/*.deb
install -D -t "$root/packages" "$source_folder/tests/deploy/packages_booted.sh"
env DEBIAN_FRONTEND=noninteractive chroot "$root" bash -euc '
	apt-get update -q >/dev/null
	apt-get install -q -y --no-install-recommends systemd-sysv dbus /packages/cauteryd*.deb /packages/cautery-clients*.deb' \
	>"$folder/boot-install.log" 2>&1 || {
	tail -n 20 "$folder/boot-install.log"
	exit 1
}
cat >"$root/etc/systemd/system/booted.service" <<'END'
[Unit]
After=multi-user.target cauteryd.service
[Service]
Type=oneshot
ExecStart=/bin/bash /packages/packages_booted.sh
END
mkdir -p "$root/etc/systemd/system/multi-user.target.wants"
ln -s ../booted.service "$root/etc/systemd/system/multi-user.target.wants/"
timeout 300 "${boot[@]}" --boot >"$folder/boot.log" 2>&1 || true
cat "$root/packages/said" || {
	tail -n 20 "$folder/boot.log"
	exit 1
}
tail -n 1 "$root/packages/said" | grep -qx "all is well"
