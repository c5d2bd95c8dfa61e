#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# One stage of the viewer's tests: run_viewer_tests.sh types|lint|unit|build|manual|browser|smoke|firefox; or `pictures`, which
# makes clients/web/pictures anew from those of the browser tests that take them; or `wound`, which makes
# clients/web/pictures/wound anew.
# Exit code 77: skipped, with the reason. ctest sets the environment (tests/browser/CMakeLists.txt).
set -euo pipefail

web=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../clients/web" && pwd)
cd "$web"

skip() {
	echo "skipped: $*"
	exit 77
}

command -v npm >/dev/null || skip "npm is not installed"
[ -d node_modules/vite ] || skip "no packages in clients/web/node_modules (npm ci there installs them)"
./with_node.sh true || skip "no Node that is new enough"

case ${1:-} in
types) exec npm run --silent types ;;
lint) exec npm run --silent lint ;;
build) exec npm run --silent build ;;
manual)
	[ -d node_modules/temml ] || skip "clients/web/node_modules is of an earlier lock file (npm ci there)"
	npm run --silent manual
	# Comments of public headers are checked where there is clang, and there are pages of them.
	command -v clang >/dev/null || skip "no clang, so the C interfaces were left out"
	[ -e dist-manual/api/session.html ]
	;;
unit)
	mkdir -p "$CAUTERY_FRAMES"
	"$CAUTERY_WRITE_FRAMES" "$CAUTERY_FRAMES"
	exec npm run --silent unit
	;;
browser | smoke | pictures | wound)
	[ -x /usr/bin/chromium-headless-shell ] || skip "no /usr/bin/chromium-headless-shell"
	[ -x "${CAUTERYD:-}" ] || skip "the daemon is not built here"
	mkdir -p "$CAUTERY_SCREENSHOTS"
	if [ "$1" = browser ]; then
		exec nice npm run --silent browser -- --exclude '**/holds_firefox.test.ts'
	fi
	if [ "$1" = smoke ]; then
		exec nice npm run --silent browser -- cut.test.ts
	fi
	npm run --silent build
	if [ "$1" = wound ]; then
		CAUTERY_WOUND="$web/pictures/wound" exec npm run --silent browser -- wound
	fi
	npm run --silent browser -- layers first_view asked
	for picture in pictures/*.png; do
		cp "$CAUTERY_SCREENSHOTS/$(basename "$picture")" pictures/
	done
	;;
firefox)
	[ -x /usr/bin/firefox-esr ] || skip "no /usr/bin/firefox-esr"
	[ -x "${CAUTERYD:-}" ] || skip "the daemon is not built here"
	exec npm run --silent browser -- holds_firefox
	;;
*)
	echo "usage: run_viewer_tests.sh types|lint|unit|build|manual|browser|smoke|firefox|pictures|wound" >&2
	exit 2
	;;
esac
