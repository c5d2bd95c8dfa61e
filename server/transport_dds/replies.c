// SPDX-License-Identifier: GPL-3.0-or-later
// cautery/session_reply: the results of requests, published once they are on the disk.
#include <stdlib.h>
#include <string.h>

#include "cautery/rpc.h"
#include "transport_dds/internal.h"

cau_dds_request cau_dds_describe_request(const cau_dds_writer *writer,
                                         const cautery_SessionRequest *sample)
{
	cau_dds_request request = {.used = true,
	                           .writer = writer->guid,
	                           .participant = writer->participant,
	                           .number = sample->number,
	                           .operation = sample->operation};
	memcpy(request.session, sample->session, sizeof request.session);
	return request;
}

cau_dds_request *cau_dds_keep_request(cau_dds_control *control, const cau_dds_writer *writer,
                                      const cautery_SessionRequest *sample)
{
	cau_dds_request *unused = NULL;
	int own = 0;
	for (int i = 0; i < REQUESTS_MOST; i++) {
		cau_dds_request *request = &control->requests[i];
		if (!request->used)
			unused = request;
		else if (request->participant == writer->participant)
			own++;
	}
	if (!unused || own >= REQUESTS_OF_ONE_MOST)
		return NULL;
	*unused = cau_dds_describe_request(writer, sample);
	return unused;
}

static cautery_SessionReply begin(const cau_dds_request *request)
{
	cautery_SessionReply reply = {.number = request->number, .operation = request->operation};
	memcpy(reply.writer, request->writer.v, sizeof reply.writer);
	memcpy(reply.session, request->session, sizeof reply.session);
	return reply;
}

// Writes the reply and forgets the request.
static void finish(const cau_dds_control *control, cau_dds_request *request,
                   const cautery_SessionReply *reply)
{
	dds_return_t code = dds_write(control->reply_writer, reply);
	if (code)
		cau_log(
			CAU_LOG_WARNING, NULL, "dds_reply_lost",
			"number=%llu reason=\"cannot write cautery/session_reply (%s): the requester gets no "
			"answer\"",
			(unsigned long long)request->number, dds_strretcode(code));
	*request = (cau_dds_request){0};
}

void cau_dds_reply_fail(const cau_dds_control *control, cau_dds_request *request,
                        const cau_error *error, int32_t code)
{
	static const char prefix[] = "params.";
	cau_rpc_fault fault;
	cautery_SessionReply reply = begin(request);
	cau_rpc_fault_of_error(&fault, error);
	if (code)
		cau_rpc_fault_of_code(&fault, (cau_rpc_error_code)code, error->reason);
	// The reply's path has no "params.", because the sample itself has the members of JSON-RPC's
	// params.
	const char *path = error->path;
	if (strncmp(path, prefix, sizeof prefix - 1) == 0)
		path += sizeof prefix - 1;
	reply.code = fault.code;
	snprintf(reply.status, sizeof reply.status, "%.32s", fault.status);
	snprintf(reply.path, sizeof reply.path, "%.159s",
	         strcmp(path, "client_sequence") == 0 ? "number" : path);
	snprintf(reply.reason, sizeof reply.reason, "%.319s", fault.reason);
	finish(control, request, &reply);
}

void cau_dds_reply_join(const cau_dds_control *control, cau_dds_request *request,
                        const cau_wire_session_summary *summary)
{
	cautery_SessionReply reply = begin(request);
	reply.tick = (uint64_t)summary->tick;
	reply.epoch = summary->epoch;
	finish(control, request, &reply);
}

static int by_id(const void *a, const void *b)
{
	return strcmp(((const cautery_SessionStatus *)a)->session,
	              ((const cautery_SessionStatus *)b)->session);
}

void cau_dds_reply_list(cau_dds *dds, cau_dds_request *request)
{
	cau_dds_control *control = &dds->control;
	cautery_SessionReply reply = begin(request);
	uint32_t count = 0, capacity = 0;
	for (const cau_dds_session *s = dds->sessions; s; s = s->next)
		capacity++;
	cautery_SessionStatus *statuses = calloc(capacity + 1, sizeof *statuses);
	if (!statuses) {
		cau_error error = {.status = CAU_NO_MEMORY};
		cau_dds_reply_fail(control, request, &error, 0);
		return;
	}
	for (const cau_dds_session *s = dds->sessions; s; s = s->next) {
		cau_wire_session_summary summary;
		cau_hosted_counts counts;
		cau_hosted_summary(s->hosted, &summary);
		cau_hosted_count(s->hosted, &counts);
		if (*summary.session)
			cau_dds_fill_status(&statuses[count++], &summary, cau_hosted_number(s->hosted),
			                    &counts);
	}
	qsort(statuses, count, sizeof *statuses, by_id);
	snprintf(reply.session, sizeof reply.session, "%.48s", dds->config->label);
	reply.sessions._buffer = statuses;
	reply.sessions._length = reply.sessions._maximum = count;
	finish(control, request, &reply);
	free(statuses);
}

// ---- replies from posts
// Returns the number by which frames name a session; 0 if the session is gone.
static uint32_t number_of(cau_hub *hub, const char *id)
{
	cau_hosted *hosted = cau_hub_find(hub, id);
	uint32_t number = hosted ? cau_hosted_number(hosted) : 0;
	cau_hosted_release(hosted);
	return number;
}

static cau_status fill_made(cau_hub *hub, const cau_dds_post *post, cautery_SessionReply *reply,
                            cautery_SessionStatus *made, cau_error *error)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_description result = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                       .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	cau_status status = cau_dds_post_result(post, &result, error);
	if (status)
		return status;
	cau_dds_fill_status(made, &result.summary, number_of(hub, result.summary.session),
	                    &(cau_hosted_counts){0});
	memcpy(reply->session, result.summary.session, sizeof reply->session);
	reply->tick = (uint64_t)result.summary.tick;
	reply->epoch = result.summary.epoch;
	reply->sessions._buffer = made;
	reply->sessions._length = reply->sessions._maximum = 1;
	return CAU_OK;
}

static cau_status fill(cau_hub *hub, const cau_dds_post *post, cautery_SessionReply *reply,
                       cautery_SessionStatus *made, cau_error *error)
{
	cau_wire_session_summary summary = {0};
	cau_wire_restored restored = {0};
	cau_wire_driver driver = {0};
	cau_status status = CAU_OK;
	switch (post->method) {
	case CAU_METHOD_SESSION_CREATE:
	case CAU_METHOD_SESSION_FORK:
		return fill_made(hub, post, reply, made, error);
	case CAU_METHOD_SESSION_PAUSE:
	case CAU_METHOD_SESSION_RESUME:
		status = cau_dds_post_result(post, &summary, error);
		reply->tick = (uint64_t)summary.tick;
		reply->epoch = summary.epoch;
		return status;
	case CAU_METHOD_SESSION_REWIND:
		status = cau_dds_post_result(post, &restored, error);
		reply->tick = (uint64_t)restored.tick;
		reply->epoch = restored.epoch;
		return status;
	case CAU_METHOD_TOOL_TAKE_OVER:
		status = cau_dds_post_result(post, &driver, error);
		reply->driver = (uint32_t)driver.client;
		return status;
	default:
		return CAU_OK; // the reply has no result
	}
}

void cau_dds_reply_post(cau_dds *dds, const cau_dds_post *post)
{
	cau_error error = {0};
	cautery_SessionStatus made;
	cau_dds_control *control = &dds->control;
	int i = 0;
	while (i < REQUESTS_MOST &&
	       (!control->requests[i].used || control->requests[i].ticket != post->ticket))
		i++;
	if (i == REQUESTS_MOST)
		return;
	cau_dds_request *request = &control->requests[i];
	cautery_SessionReply reply = begin(request);
	if (post->failed)
		cau_dds_reply_fail(control, request, &post->error, post->code);
	else if (fill(dds->hub, post, &reply, &made, &error))
		cau_dds_reply_fail(control, request, &error, CAU_RPC_INTERNAL);
	else
		finish(control, request, &reply);
}

void cau_dds_forget_replies(const cau_dds_control *control, const dds_guid_t *writer)
{
	cautery_SessionReply key = {0};
	memcpy(key.writer, writer->v, sizeof key.writer);
	dds_unregister_instance(control->reply_writer, &key);
}
