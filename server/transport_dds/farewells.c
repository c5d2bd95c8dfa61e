// SPDX-License-Identifier: GPL-3.0-or-later
// Sends the last sample of sessions that have ended. A deleted writer resends nothing, so a reader
// that was busy then would never learn that the session is gone. So the writer stays until every
// reader has acknowledged, or for two seconds. No thread waits for this.
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "transport_dds/internal.h"

#define FAREWELL_S 2 // longest time that a hanging reader keeps a writer open
#define LOOK_EVERY_S 0.01

void cau_dds_bid_farewell(cau_dds_farewell **farewells, dds_entity_t publisher, dds_entity_t writer)
{
	cau_dds_farewell *farewell = malloc(sizeof *farewell);
	if (!farewell) {
		dds_delete(publisher);
		return;
	}
	*farewell = (cau_dds_farewell){*farewells, publisher, writer, cau_monotonic_s() + FAREWELL_S};
	*farewells = farewell;
}

double cau_dds_end_farewells(cau_dds_farewell **farewells, double now_s)
{
	for (cau_dds_farewell **link = farewells; *link;) {
		cau_dds_farewell *farewell = *link;
		if (now_s < farewell->until_s &&
		    dds_wait_for_acks(farewell->writer, 0) == DDS_RETCODE_TIMEOUT) {
			link = &farewell->next;
			continue;
		}
		*link = farewell->next;
		dds_delete(farewell->publisher);
		free(farewell);
	}
	return *farewells ? now_s + LOOK_EVERY_S : INFINITY;
}

void cau_dds_await_farewells(cau_dds_farewell **farewells)
{
	const struct timespec pause = {.tv_nsec = (long)(1e9 * LOOK_EVERY_S)};
	while (cau_dds_end_farewells(farewells, cau_monotonic_s()) < INFINITY)
		nanosleep(&pause, NULL);
}
