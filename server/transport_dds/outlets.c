// SPDX-License-Identifier: GPL-3.0-or-later
// Writers of this daemon: those that count their readers, so that nothing is written without a
// reader, and those that send the last sample of ended sessions.
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "transport_dds/internal.h"

// ---- writers that count their readers
// Counts the readers. Called on Cyclone's threads.
static void on_matched(dds_entity_t writer, const dds_publication_matched_status_t status,
                       void *user)
{
	cau_dds_outlet *outlet = user;
	(void)writer;
	atomic_store(&outlet->readers, status.current_count);
	if (status.total_count_change > 0)
		atomic_store(&outlet->newcomers, true);
	cau_dds_mark(outlet->wakeup, outlet->session);
}

bool cau_dds_open_outlet(cau_dds_wakeup *wakeup, cau_dds_outlet *outlet, uint32_t session,
                         dds_entity_t publisher, dds_entity_t topic, const dds_qos_t *qos)
{
	dds_listener_t *listener = dds_create_listener(outlet);
	dds_lset_publication_matched(listener, on_matched);
	outlet->wakeup = wakeup;
	outlet->session = session;
	outlet->writer = dds_create_writer(publisher, topic, qos, listener);
	dds_delete_listener(listener);
	return outlet->writer > 0;
}

void cau_dds_close_outlet(cau_dds_outlet *outlet)
{
	if (outlet->writer > 0)
		dds_delete(outlet->writer); // dds_delete waits for a running on_matched
	outlet->writer = 0;
	outlet->readers = 0;
}

bool cau_dds_is_read(const cau_dds_outlet *outlet)
{
	return atomic_load(&outlet->readers) > 0;
}

bool cau_dds_take_newcomers(cau_dds_outlet *outlet)
{
	return atomic_exchange(&outlet->newcomers, false);
}

// ---- farewells
// A deleted writer resends nothing, so a reader that was busy then would never learn that the
// session is gone. So the writer stays until every reader has acknowledged, or for two seconds. No
// thread waits for this.

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
