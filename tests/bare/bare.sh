#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs deploy/test.sh in a fresh clone on a bare Debian 12, made by debootstrap in a chroot: shows
# that deploy/packages.txt is complete and that nothing of this machine is needed.
#
# Usage: bare.sh FOLDER [OPTION OF deploy/test.sh...]     (default option: --release)
# Needs root, debootstrap and a Debian mirror (CAUTERY_MIRROR, default http://deb.debian.org/debian).
# FOLDER is kept, and used again by the next run. Exit code 77: cannot be done here.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:?usage: bare.sh FOLDER [OPTION OF deploy/test.sh...]}
shift
[ $# -gt 0 ] || set -- --release
mirror=${CAUTERY_MIRROR:-http://deb.debian.org/debian}

skip() {
	echo "skipped: $*"
	exit 77
}

[ "$(id -u)" -eq 0 ] || skip "a chroot needs root"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
unshare --mount true 2>/dev/null || skip "no mount namespaces here"
git -C "$source_folder" rev-parse --git-dir >/dev/null || skip "not a git checkout, so nothing to clone"

if [ ! -e "$folder/etc/debian_version" ]; then
	debootstrap --variant=minbase bookworm "$folder" "$mirror"
	cat >"$folder/etc/apt/sources.list" <<END
deb $mirror bookworm main
deb $mirror bookworm-updates main
deb ${mirror}-security bookworm-security main
END
	cp /etc/resolv.conf /etc/hosts "$folder/etc/"
fi
rm -rf "$folder/src/cautery"
git clone --quiet --no-local "$source_folder" "$folder/src/cautery"

# The mounts live and die with this namespace.
export folder
# shellcheck disable=SC2016 # expanded inside, not here
exec unshare --mount --propagation private bash -euc '
	mount --bind /dev "$folder/dev"
	mount -t proc proc "$folder/proc"
	mount -t tmpfs tmpfs "$folder/dev/shm"
	exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin chroot "$folder" /src/cautery/deploy/test.sh "$@"
' bare.sh "$@"
