// SPDX-License-Identifier: GPL-3.0-or-later
#include "agent/load.h"

#include <math.h>
#include <stdio.h>

static double free_share(double used, double most)
{
	return most > 0 ? 1 - used / most : 0;
}

int cau_load_free_percent(const cau_load *load)
{
	double sessions = free_share(load->session_count, load->session_count_most);
	double memory = free_share((double)load->session_bytes, (double)load->session_bytes_most);
	double least = fmin(fmin(sessions, memory), 1 - load->busy_share);
	double percent = 100 * least * fmin(1, load->pace_share_min);
	return (int)lround(fmin(100, fmax(1, percent)));
}

size_t cau_load_write(const cau_load *load, char line[CAU_LOAD_LINE_BYTES])
{
	int bytes = load->takes ? snprintf(line, CAU_LOAD_LINE_BYTES, "ready %d%%\n",
	                                   cau_load_free_percent(load))
	                        : snprintf(line, CAU_LOAD_LINE_BYTES, "drain\n");
	return (size_t)bytes;
}
