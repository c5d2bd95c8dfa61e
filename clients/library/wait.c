// SPDX-License-Identifier: Apache-2.0
// The calls that wait for an answer, and the measurement of the server's clock.
#include <math.h>

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

// Removes the callback of the requests of `user`, because `user` is about to go out of scope.
static void abandon(cau_client *client, const void *user)
{
	for (cau_client_pending *p = client->first_pending; p; p = p->next)
		if (p->user == user)
			p->answer = NULL;
}

static bool wait_once(cau_client *client, const bool *done)
{
	return cau_client_wait_for(client, done, cau_client_now() + client->def.timeout_s);
}

// Sends a heartbeat. Returns true if the server answers it in time.
static bool is_heard(cau_client *client)
{
	waiting w = {.method = CAU_METHOD_HEARTBEAT};
	bool sent = !cau_client_send(client, CAU_METHOD_HEARTBEAT,
	                             &(cau_wire_heartbeat){.visible = true}, take_answer, &w, NULL);
	bool answered = sent && wait_once(client, &w.done);
	abandon(client, &w);
	return answered && !w.error.status;
}

// True if the answer may take long. A join is answered when its session is built, which can take a
// minute on a busy machine.
static bool takes_long(cau_method method)
{
	return cau_method_describe(method)->cost != CAU_COST_CHEAP || method == CAU_METHOD_SESSION_JOIN;
}

cau_status cau_client_await(cau_client *client, cau_method method, const bool *done,
                            const void *user, cau_error *error)
{
	bool answered = wait_once(client, done);
	while (!answered && takes_long(method) && is_heard(client))
		answered = *done || wait_once(client, done);
	if (answered || *done)
		return CAU_OK;
	abandon(client, user);
	return cau_fail(error, CAU_IO, NULL, "no answer to %s within %g s",
	                cau_method_describe(method)->name, client->def.timeout_s);
}

static cau_status wait(cau_client *client, waiting *w, cau_error *error)
{
	cau_status status = cau_client_await(client, w->method, &w->done, w, error);
	if (status)
		return status;
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
	// All commands share one type of result, so the method of any command reads it.
	waiting w = {.method = CAU_METHOD_TOOL_MOVE, .result = result};
	client->fault.code = 0;
	cau_status status = cau_client_send_command(client, session, command, take_answer, &w, error);
	return status ? status : wait(client, &w, error);
}

// ---- clock -------------------------------------------------------------------------------------
cau_status cau_client_measure_clock(cau_client *client, int32_t count, cau_client_clock *clock,
                                    cau_error *error)
{
	double shortest_s = INFINITY;
	for (int32_t i = 0; i < count; i++) {
		cau_wire_heartbeat_result result = {0};
		double sent_s = cau_client_now();
		cau_status status = cau_client_call(client, CAU_METHOD_HEARTBEAT,
		                                    &(cau_wire_heartbeat){.visible = true}, &result, error);
		double back_s = cau_client_now();
		if (status)
			return status;
		if (back_s - sent_s >= shortest_s)
			continue;
		shortest_s = back_s - sent_s;
		clock->offset_s = 1e-6 * (double)result.server_time_us - 0.5 * (sent_s + back_s);
		clock->error_s = 0.5 * shortest_s;
	}
	return CAU_OK;
}
