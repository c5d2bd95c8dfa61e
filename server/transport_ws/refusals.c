// SPDX-License-Identifier: GPL-3.0-or-later
// A request that is refused: a line in the log, a count, and the answer through libwebsockets.
#include "log/log.h"
#include "transport_ws/internal.h"

void cau_note_refusal(cau_network *network, const cau_http_refusal *refusal)
{
	network->counts.refused_handshakes++;
	cau_log(CAU_LOG_INFO, NULL, "handshake_refused", "status=%u error=%s reason=\"%s\"",
	        refusal->status, refusal->name, refusal->reason);
}

void cau_refuse_request(struct lws *wsi, const cau_http_refusal *refusal)
{
	cau_http_body body = {0};
	cau_note_refusal(cau_network_of(wsi), refusal);
	if (!cau_http_answer_refusal(wsi, &body, refusal, true))
		cau_http_answer_continue(wsi, &body);
	cau_http_body_finish(&body);
}
