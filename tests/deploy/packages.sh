#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian packages on a bare Debian 12 (a chroot): those of an earlier commit installed, run under
# their own user, upgraded to today's with a cut session in the store, today's run with TLS, purged.
#
# Usage: packages.sh FOLDER      Exit code 77: cannot be done here, and why is printed.
# Needs root, debootstrap, the repository's history and a Debian mirror (CAUTERY_MIRROR, default http://deb.debian.org/debian).
# FOLDER is kept: the bare system and the build tree are used again by the next run.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:?usage: packages.sh FOLDER}
mirror=${CAUTERY_MIRROR:-http://deb.debian.org/debian}
base=$folder/base root=$folder/root
# The first that had packages: snapshots of version 4, a store without what came since, no TLS.
pinned=3637652

skip() {
	echo "skipped: $*"
	exit 77
}

step() {
	echo "== $*"
}

[ "$(id -u)" -eq 0 ] || skip "a chroot needs root"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
unshare --mount true 2>/dev/null || skip "no mount namespaces here"
git -C "$source_folder" cat-file -e "$pinned^{commit}" 2>/dev/null || skip "the clone is shallow: it has no commit $pinned"
[ -e "$source_folder/clients/web/dist/index.html" ] || skip "the viewer is not built (npm run build in clients/web)"
[ -e "$source_folder/clients/web/dist-manual/api/index.html" ] || skip "the manual is not built (npm run manual in clients/web)"

mkdir -p "$folder"
step "a bare Debian 12"
if [ ! -e "$base/etc/apt/sources.list" ]; then
	rm -rf "$base"
	debootstrap --variant=minbase bookworm "$base" "$mirror" >"$folder/debootstrap.log" ||
		skip "debootstrap failed: $(tail -n 1 "$folder/debootstrap.log")"
	echo "deb $mirror bookworm main" >"$base/etc/apt/sources.list"
fi
rm -rf "$root"
cp -a "$base" "$root"
cp /etc/resolv.conf /etc/hosts "$root/etc/"

# make_packages SOURCES TREE REVISION: for the bare system.
make_packages() {
	CAUTERY_PACKAGE_REVISION=$3 "$1/deploy/package.sh" "$2" >"$folder/package.log" 2>&1 || {
		tail -n 30 "$folder/package.log"
		exit 1
	}
	cp "$2"/packages/*.deb "$root/packages/"
}

mkdir -p "$root/packages"
step "packages of commit $pinned, revision 1"
rm -rf "$folder/pinned"
mkdir "$folder/pinned"
git -C "$source_folder" archive "$pinned" | tar -x -C "$folder/pinned"
cp -a "$source_folder/clients/web/dist" "$folder/pinned/clients/web/" # the viewer's files have no part in an upgrade
make_packages "$folder/pinned" "$folder/pinned-tree" 1
step "packages of today, revision 2"
make_packages "$source_folder" "$folder/tree" 2
if command -v lintian >/dev/null; then
	lintian --allow-root --fail-on error "$folder"/tree/packages/*.deb
fi

cp "$source_folder/tests/deploy/packages_inside.sh" "$root/packages/"
# The mounts live and die with this namespace.
export root
# shellcheck disable=SC2016 # expanded inside, not here
unshare --mount --pid --fork --kill-child --propagation private bash -euc '
	mount --bind /dev "$root/dev"
	mount -t proc proc "$root/proc"
	mount -t tmpfs tmpfs "$root/dev/shm"
	exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
		chroot "$root" bash /packages/packages_inside.sh
'
