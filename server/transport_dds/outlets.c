// SPDX-License-Identifier: GPL-3.0-or-later
// Writers of this daemon that count their readers, so that nothing is written without a reader.
#include "transport_dds/internal.h"

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
