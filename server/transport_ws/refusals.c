// SPDX-License-Identifier: GPL-3.0-or-later
// Refuses a request: counts it, notes it for the log, and answers through libwebsockets.
#include <stdio.h>

#include "transport_ws/internal.h"

void cau_note_refusal(cau_network *network, struct lws *wsi, const cau_http_refusal *refusal)
{
	char address[CAU_ADDRESS_BYTES] = "", owner[CAU_ADDRESS_BYTES], forwarded[HEADER_BYTES];
	char reason[CAU_CLOSE_REASON_BYTES];
	network->counts.refused_handshakes++;
	lws_get_peer_simple(wsi, address, sizeof address);
	bool told = cau_request_header(wsi, WSI_TOKEN_X_FORWARDED_FOR, forwarded, sizeof forwarded);
	cau_auth_find_address(network->def.config, told ? forwarded : NULL, address, sizeof address);
	cau_address_owner(address, owner);
	snprintf(reason, sizeof reason, "%u %s: %s", refusal->status, refusal->name, refusal->reason);
	cau_outsiders_note(network, owner, reason);
}

void cau_refuse_request(struct lws *wsi, const cau_http_refusal *refusal)
{
	cau_http_body body = {0};
	cau_note_refusal(cau_network_of(wsi), wsi, refusal);
	if (!cau_http_answer_refusal(wsi, &body, refusal, true))
		cau_http_answer_continue(wsi, &body);
	cau_http_body_finish(&body);
}
