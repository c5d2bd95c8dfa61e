// SPDX-License-Identifier: Apache-2.0
// Asks which daemons are behind an address, with one GET of /api/fleet. The proxy in front of
// several daemons answers with their labels. A single daemon answers that it is alone; an older
// daemon answers 404. The request has no token.
#include <stdlib.h>
#include <string.h>

#include "library/internal.h"

typedef struct question {
	bool done;
	unsigned status;     // HTTP status, or 0 without an answer
	const char *trouble; // reason in words why there is no answer
	size_t bytes;
	char trouble_text[128];
	char text[CAU_FLEET_JSON_MAX_BYTES];
} question;

static int take(question *q, const char *in, size_t bytes)
{
	if (bytes > sizeof q->text - q->bytes) {
		snprintf(q->trouble_text, sizeof q->trouble_text,
		         "the list of daemons is longer than %zu bytes", sizeof q->text);
		q->trouble = q->trouble_text;
		return -1;
	}
	memcpy(q->text + q->bytes, in, bytes);
	q->bytes += bytes;
	return 0;
}

// Reads the body. libwebsockets reports that data are available, and calls back from
// lws_http_client_read with the data.
static int read_some(struct lws *wsi)
{
	char buffer[LWS_PRE + 2048], *at = buffer + LWS_PRE;
	int room = (int)sizeof buffer - LWS_PRE;
	return lws_http_client_read(wsi, &at, &room) < 0 ? -1 : 0;
}

static void note_failure(question *q, const char *in, size_t bytes)
{
	snprintf(q->trouble_text, sizeof q->trouble_text, "%.*s", (int)(bytes < 120 ? bytes : 120),
	         in ? in : "nothing answered");
	q->trouble = q->trouble_text;
	q->done = true;
}

int cau_fleet_on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t bytes)
{
	question *q = user;
	if (!q)
		return 0;
	switch (reason) {
	case LWS_CALLBACK_ESTABLISHED_CLIENT_HTTP:
		q->status = lws_http_client_http_response(wsi);
		return 0;
	case LWS_CALLBACK_RECEIVE_CLIENT_HTTP:
		return read_some(wsi);
	case LWS_CALLBACK_RECEIVE_CLIENT_HTTP_READ:
		return take(q, in, bytes);
	case LWS_CALLBACK_COMPLETED_CLIENT_HTTP:
		q->done = true;
		return -1; // closes the connection after the one request
	case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
		note_failure(q, in, in ? strlen(in) : 16);
		return 0;
	case LWS_CALLBACK_CLOSED_CLIENT_HTTP:
		if (!q->done && !q->trouble)
			q->trouble = "the connection was lost";
		q->done = true;
		return 0;
	default:
		return 0;
	}
}

static struct lws *ask(cau_loop *loop, const cau_url *url, question *q)
{
	char host[280];
	bool bare = strchr(url->host, ':') == NULL; // false for an IPv6 address
	snprintf(host, sizeof host, bare ? "%s:%d" : "[%s]:%d", url->host, url->port);
	struct lws_client_connect_info info = {
		.context = loop->context,
		.address = url->host,
		.port = url->port,
		.ssl_connection = url->tls ? LCCSCF_USE_SSL : 0,
		.path = "/api/fleet",
		.host = host,
		.method = "GET",
		.protocol = CAU_FLEET_PROTOCOL,
		.local_protocol_name = CAU_FLEET_PROTOCOL,
		.alpn = "http/1.1",
		.userdata = q,
		.opaque_user_data = q,
	};
	return lws_client_connect_via_info(&info);
}

// Waits for the answer. After a timeout it closes the connection, because libwebsockets still
// refers to *q.
static void await_answer(cau_loop *loop, struct lws *wsi, question *q, double timeout_s)
{
	double until_s = cau_client_now() + timeout_s;
	while (wsi && !q->done && cau_client_now() < until_s)
		cau_loop_wait(loop, until_s - cau_client_now());
	if (q->done || !wsi)
		return;
	q->trouble = "no answer in time";
	lws_set_timeout(wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_SYNC);
}

cau_status cau_client_find_fleet(cau_loop *loop, const char *url, double timeout_s,
                                 cau_fleet *fleet, cau_error *error)
{
	cau_url at;
	fleet->count = 0;
	cau_status status = cau_url_read(url, &at, error);
	if (status)
		return status;
	question *q = calloc(1, sizeof *q);
	if (!q)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to ask for the fleet");
	struct lws *wsi = ask(loop, &at, q);
	await_answer(loop, wsi, q, timeout_s);
	if (q->trouble || q->status == 0)
		status = cau_fail(error, CAU_IO, NULL, "no answer from %.160s port %d: %s", at.host,
		                  at.port, q->trouble ? q->trouble : "nothing answered");
	else if (q->status == 200)
		status = cau_fleet_from_json(q->text, q->bytes, fleet, error);
	free(q);
	return status;
}
