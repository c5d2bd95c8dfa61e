// SPDX-License-Identifier: GPL-3.0-or-later
// Calls that wait for their answer.
#include "library/internal.h"

bool cau_client_wait_for(cau_client *client, const bool *done, double until_s)
{
	for (double now_s; !*done && (now_s = cau_client_now()) < until_s;)
		cau_loop_wait(client->loop, until_s - now_s);
	return *done;
}

typedef struct waiting {
	cau_method method;
	void *result;
	bool done;
	cau_error error;
} waiting;

static void take_answer(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	waiting *w = user;
	w->done = true;
	if (!answer)
		w->error = *error;
	else if (w->result)
		cau_rpc_result(answer, w->method, w->result, &w->error);
}

// Whoever stops waiting must not be answered any more: what he waits with is gone.
static void abandon(cau_client *client, const waiting *w)
{
	for (cau_client_pending *p = client->first_pending; p; p = p->next)
		if (p->user == w)
			p->answer = NULL;
}

static cau_status wait(cau_client *client, waiting *w, cau_error *error)
{
	if (!cau_client_wait_for(client, &w->done, cau_client_now() + client->def.timeout_s)) {
		abandon(client, w);
		return cau_fail(error, CAU_IO, NULL, "no answer to %s within %g s",
		                cau_method_describe(w->method)->name, client->def.timeout_s);
	}
	if (w->error.status && error)
		*error = w->error;
	return w->error.status;
}

cau_status cau_client_call(cau_client *client, cau_method method, const void *params, void *result,
                           cau_error *error)
{
	waiting w = {.method = method, .result = result};
	client->fault.code = 0;
	cau_status status = cau_client_send(client, method, params, take_answer, &w, error);
	return status ? status : wait(client, &w, error);
}

cau_status cau_client_command(cau_client *client, const char *session, const cau_command *command,
                              cau_wire_command_result *result, cau_error *error)
{
	// Commands share one result; any command's method reads it.
	waiting w = {.method = CAU_METHOD_TOOL_MOVE, .result = result};
	client->fault.code = 0;
	cau_status status = cau_client_send_command(client, session, command, take_answer, &w, error);
	return status ? status : wait(client, &w, error);
}
