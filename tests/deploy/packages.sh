#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian packages on a bare Debian 12 (a chroot): installed, run under their own user, upgraded
# over with sessions in the store, purged.
#
# Usage: packages.sh FOLDER      Exit code 77: cannot be done here, and why is printed.
# Needs root, debootstrap and a Debian mirror (CAUTERY_MIRROR, default http://deb.debian.org/debian).
# FOLDER is kept: the bare system and the build tree are used again by the next run.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:?usage: packages.sh FOLDER}
mirror=${CAUTERY_MIRROR:-http://deb.debian.org/debian}
base=$folder/base root=$folder/root

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
[ -e "$source_folder/clients/web/dist/index.html" ] || skip "the viewer is not built (npm run build in clients/web)"

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

# The second revision is the same sources: what is upgraded is the package.
step "packages, in two revisions"
mkdir -p "$root/packages"
for revision in 1 2; do
	CAUTERY_PACKAGE_REVISION=$revision "$source_folder/deploy/package.sh" "$folder/tree" >"$folder/package.log" 2>&1 || {
		tail -n 30 "$folder/package.log"
		exit 1
	}
	if [ "$revision" = 1 ] && command -v lintian >/dev/null; then
		lintian --allow-root --fail-on error "$folder"/tree/packages/*.deb
	fi
	cp "$folder"/tree/packages/*.deb "$root/packages/"
done

cp "$source_folder/tests/deploy/packages_inside.sh" "$root/packages/"
# The mounts live and die with this namespace.
export root
# shellcheck disable=SC2016 # expanded inside, not here
exec unshare --mount --pid --fork --kill-child --propagation private bash -euc '
	mount --bind /dev "$root/dev"
	mount -t proc proc "$root/proc"
	mount -t tmpfs tmpfs "$root/dev/shm"
	exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
		chroot "$root" bash /packages/packages_inside.sh
'
