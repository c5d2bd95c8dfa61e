# SPDX-License-Identifier: GPL-3.0-or-later
# What deploy/test.sh and deploy/run.sh share; to be sourced with bash from the source folder.
# Expects: $script, the caller's name for messages; $logs, a folder; $install, yes or no.
# shellcheck shell=bash disable=SC2154

heading() {
	printf '== [%d:%02d] %s\n' $((SECONDS / 60)) $((SECONDS % 60)) "$*"
}

# quietly LOG COMMAND...: the output goes to a log, and its end to the terminal on failure.
quietly() {
	local log=$logs/$1.log
	shift
	if ! "$@" >"$log" 2>&1; then
		tail -n 60 "$log" >&2
		echo "$script: failed: $* (all of it: $log)" >&2
		exit 1
	fi
}

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

# install_packages SECTION...: installs what is missing, or says so and ends if $install is no.
install_packages() {
	if ! command -v dpkg-query >/dev/null; then
		echo "$script: no dpkg here: install what deploy/packages.txt lists by hand" >&2
		return
	fi
	local missing as_root=()
	mapfile -t missing < <(missing_packages "$@")
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
	quietly apt-update "${apt[@]}" update
	quietly apt-install "${apt[@]}" install "${missing[@]}"
}

# install_npm_packages FOLDER...: what each folder's lock file names, where it is not there yet. Not by
# `npm ci`: newer ones refuse a lock file without other platforms' optional packages, which npm itself
# leaves out of it. `install --no-save` takes the lock file's versions and leaves it as it is.
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
		quietly "npm-$(basename "$folder")" npm install --no-save --prefix "$folder"
		touch "$folder/node_modules/.package-lock.json"
	done
}
