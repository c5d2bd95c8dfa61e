// SPDX-License-Identifier: GPL-3.0-or-later
// Refusals of samples: reported to the session, counted, and logged once a second.
#include "transport_dds/internal.h"

#define REFUSALS_TOLD_S 1 // time between log lines

static void tell_refused(cau_dds_session *session, const char *tool, const char *client,
                         const cau_error *error)
{
	double now_s = cau_monotonic_s();
	if (now_s - session->refused_told_s < REFUSALS_TOLD_S)
		return;
	cau_log(CAU_LOG_INFO, cau_hosted_id(session->hosted), "dds_refused",
	        "count=%lld tool=%s client=\"%s\" path=%s reason=\"%s\"", (long long)session->refused,
	        tool, client, error->path, error->reason);
	session->refused = 0;
	session->refused_told_s = now_s;
}

void cau_dds_refuse(cau_dds_session *session, const char *tool, const cau_dds_writer *writer,
                    uint64_t sequence, const cau_error *error)
{
	const cau_asker *asker = cau_dds_asker_of(writer);
	cau_hosted_refuse(session->hosted, tool, asker, sequence, error);
	session->refused++;
	tell_refused(session, tool, asker->name, error);
}

void cau_dds_count_dropped(cau_dds_session *session)
{
	cau_error error = {0};
	uint64_t dropped = cau_dds_keys_take_dropped(&session->keys);
	if (dropped) {
		cau_hosted_count_refused(session->hosted, dropped);
		session->refused += (int64_t)dropped;
		session->drops_untold = true;
	}
	// dropped samples are logged together with other refusals
	if (!session->drops_untold || session->refused == 0) {
		session->drops_untold = false;
		return;
	}
	cau_fail(&error, CAU_LIMIT, "tool",
	         "samples were dropped because their session or tool does not exist (only the first %d "
	         "such names get a refusal each)",
	         CAU_DDS_STRANGERS_MOST);
	tell_refused(session, "", "", &error);
	session->drops_untold = session->refused > 0;
}
