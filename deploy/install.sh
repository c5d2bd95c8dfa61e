# SPDX-License-Identifier: GPL-3.0-or-later
# How deploy/test.sh and deploy/run.sh install packages; to be sourced with bash from the source
# folder, after progress.sh. Expects: $script, the caller's name for messages; $install, yes or no.
# shellcheck shell=bash disable=SC2154

# listed_packages SECTION...: names under these headings of deploy/packages.txt, or under all.
listed_packages() {
	awk -v sections=" $* " '
		/^# [a-z]+$/ { wanted = sections == "  " || index(sections, " " $2 " ") }
		{ sub(/#.*/, "") }
		wanted && NF { print $1 }' deploy/packages.txt | sort -u
}

# missing_packages SECTION...: those that no installed package has or provides.
missing_packages() {
	comm -23 \
		<(listed_packages "$@") \
		<(dpkg-query -W -f '${db:Status-Abbrev}|${Package}, ${Provides}\n' |
			sed -n 's/^.i *|//p' | tr -s ', ' '\n' | sort -u)
}

# install_packages SECTION...: installs what is missing, or says so and ends if $install is no. Those
# under `optional` are installed likewise, and nobody has to have them.
install_packages() {
	if ! command -v dpkg-query >/dev/null; then
		echo "$script: no dpkg here: install what deploy/packages.txt lists by hand" >&2
		return
	fi
	local missing as_root=()
	if [ "$install" = no ]; then
		mapfile -t missing < <(missing_packages "$@" | grep -vxFf <(listed_packages optional))
	else
		mapfile -t missing < <(missing_packages ${1:+"$@" optional})
	fi
	if [ ${#missing[@]} -eq 0 ]; then
		return
	fi
	if [ "$install" = no ]; then
		echo "$script: missing packages: ${missing[*]}" >&2
		exit 1
	fi
	if [ "$(id -u)" -ne 0 ]; then
		if ! command -v sudo >/dev/null; then
			echo "$script: not root and no sudo. As root: apt-get install ${missing[*]}" >&2
			exit 1
		fi
		as_root=(sudo)
	fi
	heading "installing ${missing[*]}"
	local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
		apt-get -q -y -o DPkg::Lock::Timeout=600 --no-install-recommends)
	watched apt-update "${apt[@]}" update
	watched apt-install "${apt[@]}" install "${missing[@]}"
}

# install_npm_packages FOLDER...: what each folder's lock file names, where it is not there yet; from
# npm's own cache where that has it, without asking the registry again.
install_npm_packages() {
	local folder
	for folder in "$@"; do
		if [ "$folder/node_modules/.package-lock.json" -nt "$folder/package-lock.json" ]; then
			continue
		fi
		if ! command -v npm >/dev/null; then
			echo "$script: npm is missing: $folder is left out" >&2
			continue
		fi
		heading "npm packages of $folder"
		watched "npm-$(basename "$folder")" npm ci --prefer-offline --prefix "$folder"
		touch "$folder/node_modules/.package-lock.json"
	done
}
