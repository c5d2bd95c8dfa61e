// SPDX-License-Identifier: GPL-3.0-or-later
// The log of connections that end without hello. Anyone can open such a connection. So each address
// has at most one line a minute, which counts the connections since the last line.
#include <stdio.h>
#include <string.h>

#include "clock/clock.h"
#include "log/log.h"
#include "transport_ws/internal.h"

static const double line_every_s = 60;

static void write_line(cau_outsider *o, double now_s)
{
	cau_log(CAU_LOG_INFO, NULL, "ended_without_hello", "address=%s count=%llu last=\"%s\"",
	        o->owner, (unsigned long long)o->count, o->reason);
	o->count = 0;
	o->told_s = now_s;
}

// Returns the owner's entry, or a free entry. If all entries are in use, returns the first entry,
// which all owners without an entry share.
static cau_outsider *find_row(cau_network *network, const char *owner)
{
	cau_outsider *free_row = NULL;
	for (int i = CAU_OUTSIDERS_MOST - 1; i > 0; i--) {
		cau_outsider *o = &network->outsiders[i];
		if (strcmp(o->owner, owner) == 0)
			return o;
		if (!o->owner[0])
			free_row = o;
	}
	cau_outsider *row = free_row ? free_row : &network->outsiders[0];
	if (!row->owner[0])
		snprintf(row->owner, sizeof row->owner, "%s", free_row ? owner : "others");
	return row;
}

void cau_outsiders_note(cau_network *network, const char *owner, const char *reason)
{
	double now_s = cau_monotonic_s();
	cau_outsider *o = find_row(network, owner);
	bool is_due = o->told_s == 0 || now_s - o->told_s >= line_every_s;
	o->count++;
	snprintf(o->reason, sizeof o->reason, "%s", reason);
	if (is_due)
		write_line(o, now_s);
}

void cau_outsiders_tick(cau_network *network, double now_s)
{
	for (int i = 0; i < CAU_OUTSIDERS_MOST; i++) {
		cau_outsider *o = &network->outsiders[i];
		if (!o->owner[0] || now_s - o->told_s < line_every_s)
			continue;
		if (o->count)
			write_line(o, now_s);
		else
			// Nothing came within a minute, so the entry becomes free.
			*o = (cau_outsider){0};
	}
}
