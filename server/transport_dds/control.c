// SPDX-License-Identifier: GPL-3.0-or-later
// cautery/session_request: turns samples into the same orders and creations as JSON-RPC.
#include <stdlib.h>
#include <string.h>

#include "cautery/rpc.h"
#include "transport_dds/internal.h"

enum { CHECK_BYTES = 2048 };

typedef struct asked {
	cau_dds *dds;
	cau_dds_request *request; // the request that waits for the answer
	cau_dds_writer *writer;   // the writer that sent the request
	const cautery_SessionRequest *sample;
	const cau_method_info *method;
	cau_asker asker;
} asked;

static const cau_method methods[] = {
	[cautery_LIST] = CAU_METHOD_SESSION_LIST,        [cautery_CREATE] = CAU_METHOD_SESSION_CREATE,
	[cautery_JOIN] = CAU_METHOD_SESSION_JOIN,        [cautery_DESTROY] = CAU_METHOD_SESSION_DESTROY,
	[cautery_PAUSE] = CAU_METHOD_SESSION_PAUSE,      [cautery_RESUME] = CAU_METHOD_SESSION_RESUME,
	[cautery_FORK] = CAU_METHOD_SESSION_FORK,        [cautery_REWIND] = CAU_METHOD_SESSION_REWIND,
	[cautery_TAKE_OVER] = CAU_METHOD_TOOL_TAKE_OVER,
};

// Checks params by the tables of JSON-RPC. Writing refuses the same values as reading.
static cau_status check_params(cau_method method, const void *params, cau_error *error)
{
	char text[CHECK_BYTES];
	return cau_rpc_write_request(&(cau_rpc_buffer){text, sizeof text, 0}, 1, method, params, error);
}

// ---- orders
static cau_status read_change(asked *a, cau_order *order, cau_error *error)
{
	cau_wire_session_change params = {.client_sequence = order->client_sequence,
	                                  .has_client_sequence = true};
	(void)a;
	return check_params(order->reply.method, &params, error);
}

static cau_status read_fork(asked *a, cau_order *order, cau_error *error)
{
	cau_wire_session_fork params = {.client_sequence = order->client_sequence,
	                                .has_client_sequence = true,
	                                .has_name = *a->sample->name != 0,
	                                .has_tick = a->sample->has_tick,
	                                .tick = (int64_t)a->sample->tick,
	                                .paused = a->sample->paused};
	memcpy(params.name, a->sample->name, sizeof params.name);
	memcpy(order->as.fork.name, a->sample->name, sizeof order->as.fork.name);
	order->as.fork.has_tick = a->sample->has_tick;
	order->as.fork.tick = a->sample->tick;
	order->as.fork.paused = a->sample->paused;
	return check_params(order->reply.method, &params, error);
}

static cau_status read_rewind(asked *a, cau_order *order, cau_error *error)
{
	cau_wire_session_rewind params = {.client_sequence = order->client_sequence,
	                                  .has_client_sequence = true,
	                                  .tick = (int64_t)a->sample->tick};
	order->as.tick = a->sample->tick;
	if (!a->sample->has_tick)
		return cau_fail(error, CAU_BAD_VALUE, "has_tick",
		                "must be true for REWIND: `tick` is the tick to rewind to");
	return check_params(order->reply.method, &params, error);
}

// Finds the client that drives, in the requester's participant. If the request names a writer of
// cautery/tool_command, the client must drive by that writer. Otherwise the client must drive by
// the tool's ROS 2 topics.
static const cau_dds_client *find_driver(const asked *a, cau_error *error)
{
	static const uint8_t nobody[16];
	bool native = memcmp(a->sample->driver, nobody, sizeof nobody) != 0;
	cau_dds_session *session = a->dds->sessions;
	while (session && strcmp(cau_hosted_id(session->hosted), a->sample->session) != 0)
		session = session->next;
	const cau_dds_tool *tool = session ? cau_dds_find_tool(session, a->sample->tool) : NULL;
	const cau_door *door = native ? (session ? &session->native : NULL)
	                       : tool ? &tool->servo_cp
	                              : NULL;
	cau_dds_writer *writer =
		door && door->reader > 0
			? cau_dds_find_writer(a->dds, door, a->writer->participant, a->sample->driver)
			: NULL;
	if (!writer) {
		cau_fail(error, CAU_NOT_FOUND, "driver",
		         "the participant has no such writer in this session");
		return NULL;
	}
	return cau_dds_admit(a->dds, writer, true, error);
}

static cau_status read_take_over(asked *a, cau_order *order, cau_error *error)
{
	cau_wire_tool_ref params = {.client_sequence = order->client_sequence,
	                            .has_client_sequence = true};
	memcpy(params.tool, a->sample->tool, sizeof params.tool);
	memcpy(order->as.tool.tool, a->sample->tool, sizeof order->as.tool.tool);
	cau_status status = check_params(order->reply.method, &params, error);
	if (status)
		return status;
	const cau_dds_client *driver = find_driver(a, error);
	if (!driver)
		return error->status;
	order->asker.client = driver->asker.client;
	order->asker.deadline_s = driver->asker.deadline_s;
	memcpy(order->asker.name, driver->asker.name, sizeof order->asker.name);
	return CAU_OK;
}

static const struct {
	cau_order_kind kind;
	// NULL if the method is not an order
	cau_status (*read)(asked *a, cau_order *order, cau_error *error);
} orders[] = {
	[cautery_LIST] = {0},
	[cautery_CREATE] = {0},
	[cautery_JOIN] = {0},
	[cautery_DESTROY] = {CAU_ORDER_DESTROY, read_change},
	[cautery_PAUSE] = {CAU_ORDER_PAUSE, read_change},
	[cautery_RESUME] = {CAU_ORDER_RESUME, read_change},
	[cautery_FORK] = {CAU_ORDER_FORK, read_fork},
	[cautery_REWIND] = {CAU_ORDER_REWIND, read_rewind},
	[cautery_TAKE_OVER] = {CAU_ORDER_TAKE_OVER, read_take_over},
};

// Fails because the session is not on this daemon. If the session has moved, the reply's `session`
// is its present id.
static cau_status fail_missing(const asked *a, int32_t *code, cau_error *error)
{
	cau_moved_to to;
	if (cau_hub_moved(a->dds->hub, a->sample->session, &to)) {
		*code = CAU_RPC_MOVED;
		memcpy(a->request->session, to.session, sizeof to.session);
		return cau_fail(error, CAU_NOT_FOUND, "session", "the session is now `%s`", to.session);
	}
	*code = CAU_RPC_NOT_HERE;
	return cau_fail(error, CAU_NOT_FOUND, "session", "no session `%.48s` on this daemon",
	                a->sample->session);
}

// Handles a request for a session that does not exist. The request may have been answered before
// the session was destroyed, or may destroy a session that only the store has.
static cau_status look_up(const asked *a, cau_reply reply, int32_t *code, cau_error *error)
{
	if (a->method->changes && cau_hub_submit_missing(a->dds->hub, a->sample->session, &a->asker,
	                                                 (int64_t)a->sample->number, &reply))
		return CAU_OK;
	return fail_missing(a, code, error);
}

static cau_status submit(asked *a, cau_hosted *hosted, cau_reply reply, int32_t *code,
                         cau_error *error)
{
	cau_order *order = calloc(1, sizeof *order);
	if (!order)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the request");
	order->kind = orders[a->sample->operation].kind;
	order->asker = a->asker;
	order->client_sequence = (int64_t)a->sample->number;
	order->reply = reply;
	cau_status status = orders[a->sample->operation].read(a, order, error);
	if (!status && (status = cau_hosted_submit(hosted, order, error)) == CAU_IO)
		*code = CAU_RPC_STORE_FULL;
	if (status)
		free(order);
	return status;
}

static cau_status order_session(asked *a, cau_reply reply, int32_t *code, cau_error *error)
{
	cau_hosted *hosted = cau_hub_find(a->dds->hub, a->sample->session);
	if (!hosted)
		return look_up(a, reply, code, error);
	cau_status status = submit(a, hosted, reply, code, error);
	cau_hosted_release(hosted);
	return status;
}

// ---- requests that need no order
static cau_status create(asked *a, cau_reply reply, cau_error *error)
{
	cau_wire_session_create params = {.has_client_sequence = true,
	                                  .client_sequence = (int64_t)a->sample->number,
	                                  .has_name = *a->sample->name != 0,
	                                  .has_scene = true};
	memcpy(params.name, a->sample->name, sizeof params.name);
	memcpy(params.scene, a->sample->scene, sizeof params.scene);
	cau_status status = check_params(CAU_METHOD_SESSION_CREATE, &params, error);
	if (status)
		return status;
	cau_creation *creation = calloc(1, sizeof *creation);
	if (!creation || !(creation->scene = malloc(sizeof *creation->scene))) {
		free(creation);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a scene");
	}
	if (!cau_scenes_copy(cau_hub_scenes(a->dds->hub), a->sample->scene, creation->scene)) {
		cau_creation_free(creation);
		return cau_fail(error, CAU_NOT_FOUND, "scene", "there is no scene `%.48s`",
		                a->sample->scene);
	}
	memcpy(creation->name, a->sample->name, sizeof creation->name);
	creation->paused = a->sample->paused;
	creation->asker = a->asker;
	creation->client_sequence = params.client_sequence;
	creation->reply = reply;
	status = cau_meshes_pack(creation->scene, &creation->meshes, &creation->mesh_bytes, error);
	if (!status) {
		cau_hub_submit_creation(a->dds->hub, creation);
		return CAU_OK;
	}
	free(creation->scene);
	free(creation);
	return status;
}

// Answers join. Every reader can already read the frames, so a join only asks for a key frame.
static cau_status join(const asked *a, int32_t *code, cau_error *error)
{
	cau_wire_session_summary summary;
	for (cau_dds_session *s = a->dds->sessions; s; s = s->next)
		if (strcmp(cau_hosted_id(s->hosted), a->sample->session) == 0) {
			s->stream.key_wanted = s->stream.key_forced = true;
			s->look_s = 0;
			cau_hosted_summary(s->hosted, &summary);
			cau_dds_reply_join(&a->dds->control, a->request, &summary);
			return CAU_OK;
		}
	return fail_missing(a, code, error);
}

// ---- taking a request
static cau_status serve(asked *a, int32_t *code, cau_error *error)
{
	cautery_SessionOperation operation = a->sample->operation;
	if (a->asker.role < a->method->role) {
		*code = CAU_RPC_FORBIDDEN;
		return cau_fail(error, CAU_BAD_STATE, "",
		                "the role does not allow this (setting dds_role or dds_roles)");
	}
	if (operation == cautery_LIST) {
		cau_dds_reply_list(a->dds, a->request);
		return CAU_OK;
	}
	if (operation == cautery_JOIN)
		return join(a, code, error);
	cau_reply reply = cau_dds_reply(a->dds, methods[operation]);
	a->request->ticket = reply.connection;
	return operation == cautery_CREATE ? create(a, reply, error)
	                                   : order_session(a, reply, code, error);
}

bool cau_dds_is_too_fast(const cau_config *config, cau_dds_writer *writer)
{
	double now_s = cau_monotonic_s();
	if (now_s - writer->requests_s >= 1) {
		writer->requests_s = now_s;
		writer->requests = 0;
	}
	return ++writer->requests > config->max_requests_per_s;
}

// Returns the prefix of a participant's client_ids. If WebSocket clients need tokens, a participant
// without a proved name must not get the client_id of one of them.
static const char *owner_of(const cau_config *config, const cau_dds_writer *writer)
{
	return *writer->subject ? writer->subject : *config->tokens ? "dds:" : "";
}

// True if the request is for this daemon. Several daemons may receive a request. It is for the
// daemon whose label begins the session's id.
static bool is_ours(const cau_dds *dds, const cautery_SessionRequest *sample)
{
	const char *label = dds->config->label;
	size_t length = strlen(label);
	if (sample->operation == cautery_LIST || sample->operation == cautery_CREATE)
		return !*sample->session || strcmp(sample->session, label) == 0;
	return strncmp(sample->session, label, length) == 0 && sample->session[length] == '-';
}

void cau_dds_take_request(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *taken)
{
	const cautery_SessionRequest *sample = taken;
	cau_error error = {0};
	int32_t code = 0;
	(void)door;
	bool known = (size_t)sample->operation < sizeof methods / sizeof methods[0];
	if (!known || !is_ours(dds, sample))
		return;
	cau_dds_request unkept, *request = cau_dds_keep_request(&dds->control, writer, sample);
	asked a = {.dds = dds,
	           .request = request ? request : &unkept,
	           .writer = writer,
	           .sample = sample,
	           .method = cau_method_describe(methods[sample->operation]),
	           .asker = writer->asker};
	if (*sample->client_id)
		memcpy(a.asker.client_id, sample->client_id, sizeof a.asker.client_id);
	cau_hub_bind_client_id(a.asker.client_id, owner_of(dds->config, writer));
	cau_status status = CAU_OK;
	if (!request) {
		unkept = cau_dds_describe_request(writer, sample);
		status =
			cau_fail(&error, CAU_LIMIT, "",
		             "too many requests wait for an answer (limits: %d of one participant, %d of "
		             "all): wait for replies before the next request",
		             REQUESTS_OF_ONE_MOST, REQUESTS_MOST);
	} else if (cau_dds_is_too_fast(dds->config, writer)) {
		code = CAU_RPC_RATE;
		status = cau_fail(&error, CAU_LIMIT, "",
		                  "this writer sends more than %lld requests a second (setting "
		                  "max_requests_per_s)",
		                  (long long)dds->config->max_requests_per_s);
	} else {
		status = serve(&a, &code, &error);
	}
	if (status)
		cau_dds_reply_fail(&dds->control, a.request, &error, code);
}
