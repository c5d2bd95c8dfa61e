// SPDX-License-Identifier: GPL-3.0-or-later
// A daemon for tests with its own function at fault points: the process kills itself at the point
// that CAUTERYD_DIES_AT names, as by kill -9.
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "move/courier.h"

void cau_fault_point(const char *name)
{
	const char *wanted = getenv("CAUTERYD_DIES_AT");
	if (wanted && strcmp(wanted, name) == 0)
		raise(SIGKILL);
}
