// SPDX-License-Identifier: GPL-3.0-or-later
#include "console.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

double clock_s(clockid_t clock)
{
	struct timespec now;
	clock_gettime(clock, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Takes whole lines from standard input. Returns false at the end of the input.
static bool take_lines(console *c, void (*obey)(void *user, const char *line), void *user)
{
	ssize_t got = read(STDIN_FILENO, c->kept + c->kept_bytes, LINE_BYTES - 1 - c->kept_bytes);
	if (got <= 0)
		return false;
	c->kept_bytes += (size_t)got;
	c->kept[c->kept_bytes] = 0;
	for (char *end; (end = strchr(c->kept, '\n'));) {
		*end = 0;
		obey(user, c->kept);
		c->kept_bytes -= (size_t)(end + 1 - c->kept);
		memmove(c->kept, end + 1, c->kept_bytes + 1);
	}
	return c->kept_bytes < LINE_BYTES - 1;
}

bool console_listen(console *c, double seconds, void (*obey)(void *user, const char *line),
                    void *user)
{
	struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
	struct timespec patience = {0, (long)(1e9 * fmin(fmax(seconds, 0), 0.5))};
	return ppoll(&input, 1, &patience, NULL) <= 0 || take_lines(c, obey, user);
}
