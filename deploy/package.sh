#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the Debian packages of Cautery (deploy/README.md lists them).
#
# Usage: deploy/package.sh [TREE]     TREE: the build tree (default build-package); its packages/ has them
#
# What deploy/packages.txt names must be installed, and viewer and manual built (npm ci, npm run build
# and npm run manual in clients/web). CAUTERY_PACKAGE_REVISION in the environment is the packages' revision (default 1).
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tree=${1:-$source_folder/build-package}
if [ ! -e "$source_folder/clients/web/dist/index.html" ]; then
	echo "deploy/package.sh: the viewer is not built: (cd clients/web && npm ci && npm run build)" >&2
	exit 1
fi
# With the C interfaces, which are made where there is clang.
if [ ! -e "$source_folder/clients/web/dist-manual/api/index.html" ]; then
	echo "deploy/package.sh: the manual is not built, or without clang: (cd clients/web && npm ci && npm run manual)" >&2
	exit 1
fi
# Debian's own flags, prefix and folders.
eval "$(dpkg-buildflags --export=sh)"
export CFLAGS="${CFLAGS//-ffile-prefix-map=$PWD=./} -ffile-prefix-map=$source_folder=."
cmake -S "$source_folder" -B "$tree" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
	-DCMAKE_INSTALL_SYSCONFDIR=/etc -DCAUTERY_ZSH_COMPLETIONS=share/zsh/vendor-completions \
	-DCAUTERY_TESTS=OFF -DCAUTERY_PACKAGE_REVISION="${CAUTERY_PACKAGE_REVISION:-1}"
cmake --build "$tree" --parallel "${CAUTERY_JOBS:-$(nproc)}"
rm -rf "$tree/packages"
(umask 022 && cd "$tree" && cpack -G DEB)
rm -rf "$tree/packages/_CPack_Packages"
ls "$tree"/packages/*.deb
