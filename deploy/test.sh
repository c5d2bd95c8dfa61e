#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds, and runs the tests. Ends with ctest's closing lines, and without a level also says
# how to run the other tests. The exit code is 0 only if everything was built and every test passed. See --help.
set -euo pipefail
exec </dev/null

usage() {
	cat <<'END'
Usage: deploy/test.sh [--release | --full | --long | --campaign] [--no-install]
       deploy/test.sh --only REGEX [--preset NAME] [--no-install]
       deploy/test.sh --fleet [--no-install]

  (nothing)     the first run: a Release build and its unit, reference, determinism and e2e tests, without the
                slow ones (tests/later.txt), and one test of the viewer in a browser
  --release     the whole Release suite, browser tests included
  --full        what CI runs: adds address and undefined-behaviour sanitizers over the unit and e2e tests,
                the thread sanitizer over the unit, determinism and e2e tests, 10 s of fuzzing for each
                parser, clang-tidy with clang's warnings on every source, and tests labelled full
  --long        as --full, with tests labelled long, clang's analyzer on tests, and 600 s of fuzzing
  --only REGEX  the tests whose names match, in one tree: builds what these run and nothing else
  --preset NAME with --only: the tree of this preset instead of release's (asan-ubsan, tsan, dev)
  --fleet       three daemons, etcd and HAProxy in network namespaces, 60 sessions, and what goes
                wrong with them; ends in a table. As root; a minute. Exit code 77, and a word on why,
                where the system allows no namespaces
  --campaign    300 kills, 10,000 moves with faults, 20,000 energy sequences and 300 rounds of sessions
                that come and go, at once; prints their figures (half an hour; tests/README.md)
  --no-install  fail if a package of deploy/packages.txt is missing, instead of installing it
  --help        this text

On two cores, with the packages installed and nothing built before, the first run takes some minutes
and --full about an hour. Tests of one tree run while the next is built. One source changed:
--only, in seconds.

Build trees: build, build-asan, build-fuzz, build-tsan. Logs of the stages: build/log.
Environment: CAUTERY_MESHES, a folder with further test meshes (default: ../shared/meshes beside
the source folder, if there is one); CAUTERY_JOBS, parallel compilers (default: one per core).
END
}

level=first
install=yes
only=
fleet=
campaign=
only_preset=release
while [ $# -gt 0 ]; do
	case $1 in
	--release | --full | --long) level=${1#--} ;;
	--fleet) fleet=yes ;;
	--campaign) campaign=yes ;;
	--no-install) install=no ;;
	--only | --preset)
		if [ -z "${2:-}" ]; then
			echo "deploy/test.sh: $1 wants a value" >&2
			exit 2
		fi
		[ "$1" = --only ] && only=$2 || only_preset=$2
		shift
		;;
	--help | -h)
		usage
		exit 0
		;;
	*)
		echo "deploy/test.sh: unknown option '$1'" >&2
		usage >&2
		exit 2
		;;
	esac
	shift
done

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$source_folder"
logs=$source_folder/build/log
suite=$source_folder/build/suite
jobs=${CAUTERY_JOBS:-$(nproc)}
mkdir -p "$logs"

export LC_ALL=C.UTF-8
if [ ! -w "${HOME:-}" ]; then # npm and git want one
	export HOME=$source_folder/build/home
	mkdir -p "$HOME"
fi
if [ -z "${CAUTERY_MESHES:-}" ] && [ -d ../shared/meshes ]; then
	CAUTERY_MESHES=$(cd ../shared/meshes && pwd)
	export CAUTERY_MESHES
fi
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_stack_use_after_return=1:strict_string_checks=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
export TSAN_OPTIONS=${TSAN_OPTIONS:-second_deadlock_stack=1}

script=deploy/test.sh
. deploy/progress.sh
. deploy/install.sh
. deploy/trees.sh

# tree_of PRESET: its folder, as CMakePresets.json has it.
tree_of() {
	case $1 in
	release) echo build ;;
	asan-ubsan) echo build-asan ;;
	*) echo "build-$1" ;;
	esac
}

# configure PRESET CONFIGURE_ARGUMENTS...
configure() {
	local preset=$1
	shift
	fresh_where_needed "$(tree_of "$preset")"
	watched "configure-$preset" cmake --preset "$preset" "${fresh[@]}" "$@"
}

# collect NAME PRESET LABELS WITHOUT TIMEOUT_FACTOR [TARGET]: adds a tree's tests to the suite; with a target,
# a first test builds it, and the others wait for it. TARGET "programs": the programs that these tests run.
# The array `leaving` has further options of collect_tests.py.
leaving=()
collect() {
	local name=$1 preset=$2 tree build=()
	tree=$(tree_of "$preset")
	if [ -n "${6:-}" ]; then
		build=("$source_folder/deploy/build_tree.sh" "$logs/build-$name.log"
			cmake --build "$source_folder/$tree" --parallel "$jobs" --target "$6")
	fi
	python3 -B deploy/collect_tests.py "${leaving[@]}" "$suite" "$name" "$tree" "${@:3:3}" "${build[@]}"
}

# follow CTEST_ARGUMENTS...: runs tests, and says what is running where ctest is silent.
follow() {
	heading "tests"
	ctest "$@" --output-on-failure --no-label-summary --no-tests=error |
		python3 -u deploy/follow_tests.py "$logs"
}

# build_for PRESET REGEX CONFIGURE_ARGUMENTS...: builds only the programs that the tests with these names run.
build_for() {
	local preset=$1 regex=$2 tree programs
	tree=$(tree_of "$preset")
	heading "build in $tree what the tests '$regex' run"
	configure "$preset" "${@:3}"
	mapfile -t programs < <(python3 deploy/programs_of_tests.py "$tree" "$regex")
	if [ ${#programs[@]} -gt 0 ]; then
		watched "build-$preset" cmake --build "$tree" --target "${programs[@]}" --parallel "$jobs"
	fi
}

# test_only: what --only says.
test_only() {
	build_for "$only_preset" "$only"
	follow --test-dir "$(tree_of "$only_preset")" -R "$only" --parallel "$jobs"
	exit
}

# test_campaign: serves --campaign. Each test waits for disks and connections half of its time, so twice as many run.
test_campaign() {
	local regex='^e2e_(kills|couriers_long|sequences_long|churn_long)$'
	build_for release "$regex" -DCAUTERY_LONG=ON
	# The figures are in a file of their own: any other ctest in this tree, -N too, empties the usual log.
	local figures=$PWD/build/Testing/campaign.xml
	follow --test-dir build -R "$regex" --parallel "$((2 * jobs))" --output-junit "$figures" --test-output-size-passed 1000000
	heading "figures"
	grep -o 'ℹ .*' "$figures" | sed 's/&lt;/</g; s/&gt;/>/g; s/&amp;/\&/g' |
		grep -vE '^ℹ (tests|suites|pass|fail|cancelled|skipped|todo|duration_ms) '
	exit
}

# test_fleet: what --fleet says.
test_fleet() {
	heading "build in build what the fleet runs"
	configure release
	watched build-release cmake --build build --target cauteryd cautery --parallel "$jobs"
	heading "fleet"
	PROGRAMS=$source_folder/build/bin SCENES=$source_folder/deploy/scenes \
		exec python3 -B tests/deploy/fleet_network_test.py "$source_folder"
}

# first_run: builds what the tests run that find most in the least time, and runs them.
first_run() {
	heading "configure (logs in build/log)"
	configure release
	rm -rf "$suite"
	leaving=(--without-names tests/later.txt)
	collect release release '' 'full|long|browser|bench' 1 programs
	local status=0
	follow --test-dir "$suite" --parallel 12 || status=$?
	cat <<'END'

These were the tests that find most in the least time. Further levels (deploy/test.sh --help):
  deploy/test.sh --release   all tests of this build, those in browsers too
  deploy/test.sh --full      all that CI runs: sanitizers, fuzzing and clang-tidy besides
END
	exit $status
}

# configure_all: every tree that the level needs.
configure_all() {
	configure release -DCAUTERY_LONG=$long
	if [ "$level" != release ]; then
		configure asan-ubsan
		configure fuzz -DCAUTERY_FUZZ_SECONDS=$fuzz_seconds -DCAUTERY_TIDY=$tidy -DCAUTERY_LONG=$long
		configure tsan
	fi
}

# collect_all: the suite, after the release tree is built and the others are configured.
collect_all() {
	rm -rf "$suite"
	collect release release '' "smoke${without:+|$without}" 1
	if [ "$level" != release ]; then
		collect asan asan-ubsan 'unit|e2e' "$sanitizers_without" 4 programs
		collect clang fuzz 'fuzz|tidy' '' 1 fuzz_targets
		collect tsan tsan 'unit|determinism|e2e' "unthreaded|$sanitizers_without" 10 programs
	fi
}

without='full|long'
fuzz_seconds=10
tidy=OFF
long=OFF
case $level in
full) without=long tidy=ON ;;
long) without='' fuzz_seconds=600 tidy=ON long=ON ;;
esac

# tests that only look at the sources need no second tree
sanitizers_without=static${without:+|$without}

install_packages
if [ "$install" = yes ]; then
	install_npm_packages clients/web
fi
if [ -n "$only" ]; then
	test_only
fi
if [ -n "$fleet" ]; then
	test_fleet
fi
if [ -n "$campaign" ]; then
	test_campaign
fi

if [ "$level" = first ]; then
	first_run
fi

heading "configure (logs in build/log)"
configure_all
heading "build: release"
watched build-release cmake --build build --target all --parallel "$jobs"
collect_all
# twelve slots for two cores: collect_tests.py says how tests share them
follow --test-dir "$suite" --parallel 12
