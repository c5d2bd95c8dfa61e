# SPDX-License-Identifier: GPL-3.0-or-later
# Build trees, as deploy/test.sh and deploy/run.sh find and leave them; to be sourced with bash.
# Both work in build/, in any order, and in what somebody has configured there by hand.
# Expects: $source_folder. shellcheck shell=bash disable=SC2154

# New trees are Ninja's, and compile through ccache where it is installed. A tree that exists keeps
# its generator and its launcher.
export CMAKE_GENERATOR=${CMAKE_GENERATOR:-Ninja}
if command -v ccache >/dev/null; then
	export CMAKE_C_COMPILER_LAUNCHER=${CMAKE_C_COMPILER_LAUNCHER-ccache}
	export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache}
	# so that two clones share what they compile
	export CCACHE_BASEDIR=${CCACHE_BASEDIR-$source_folder}
	# It reads what a source includes from the compiler's list, and runs no preprocessor of its own: a compilation that is
	# not in the cache takes 0.35 s of a processor, not 0.47.
	export CCACHE_DEPEND=${CCACHE_DEPEND-1}
fi

# cached TREE NAME: a value of the tree's cache.
cached() {
	sed -n "s/^$2:[^=]*=//p" "$1/CMakeCache.txt"
}

# is_configured TREE: it was, to the end.
is_configured() {
	[ -f "$1/CMakeCache.txt" ] && { [ -f "$1/build.ninja" ] || [ -f "$1/Makefile" ]; }
}

# is_usable TREE: cmake would go on with it. Not so if the folder has been moved or copied from
# elsewhere, or if a program that the tree compiles with is gone.
is_usable() {
	[ "$(cached "$1" CMAKE_HOME_DIRECTORY)" -ef "$source_folder" ] || return 1
	[ "$(cached "$1" CMAKE_CACHEFILE_DIR)" -ef "$1" ] || return 1
	local variable program
	for variable in CMAKE_MAKE_PROGRAM CMAKE_C_COMPILER CMAKE_C_COMPILER_LAUNCHER; do
		program=$(cached "$1" $variable)
		[ -z "$program" ] || command -v "$program" >/dev/null || return 1
	done
}

# fresh_where_needed TREE: sets the array `fresh` to the option of cmake that forgets an old cache.
fresh_where_needed() {
	fresh=()
	if [ -f "$1/CMakeCache.txt" ] && ! is_usable "$1"; then
		echo "   $1 was made in another folder or with programs that are gone: configured anew"
		fresh=(--fresh)
	fi
}
