// SPDX-License-Identifier: GPL-3.0-or-later
// store.backup, a method for administrators.
#include "rpc/internal.h"

void cau_call_store_backup(cau_call *call)
{
	cau_error error = {0};
	cau_wire_store_backup params = {0};
	cau_reply reply = cau_call_reply(call);
	// the store contains all sessions, so the token must be for all
	if (*call->peer->bounds.sessions) {
		cau_call_may_use(call, "");
		return;
	}
	if (cau_rpc_params(call->message, &params, &error) ||
	    cau_backups_make(&call->peer->service->backups, params.has_name ? params.name : "", &reply,
	                     &error))
		cau_call_fail(call, &error, 0);
}
