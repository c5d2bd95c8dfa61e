// SPDX-License-Identifier: GPL-3.0-or-later
// Deliveries from other threads to the DDS thread: the request to look again, the sessions to look
// at, and the answers of workers and of the store thread.
#include <stdlib.h>
#include <string.h>

#include "cautery/rpc.h"
#include "transport_dds/internal.h"

// ---- waking the DDS thread; from any thread
void cau_dds_wake(cau_dds_wakeup *wakeup, atomic_bool *why)
{
	if (!atomic_exchange(why, true) && wakeup->guard > 0)
		dds_set_guardcondition(wakeup->guard, true);
}

void cau_dds_mark(cau_dds_wakeup *wakeup, uint32_t session)
{
	cau_dds_set_bit(&wakeup->marked, session);
	cau_dds_wake(wakeup, &wakeup->sliced);
}

// ---- sets of sessions, marked without a lock
void cau_dds_set_bit(cau_dds_bits *bits, uint32_t session)
{
	uint32_t bit = session % BITS_MOST;
	atomic_fetch_or(&bits->words[bit / 64], 1ull << bit % 64);
}

bool cau_dds_has_bit(const cau_dds_bits *bits, uint32_t session)
{
	uint32_t bit = session % BITS_MOST;
	return atomic_load(&bits->words[bit / 64]) >> bit % 64 & 1;
}

void cau_dds_take_bits(cau_dds_bits *bits, cau_dds_bits *taken)
{
	for (int i = 0; i < BITS_WORDS; i++)
		atomic_store(&taken->words[i], atomic_exchange(&bits->words[i], 0));
}

// ---- answers
static void put(cau_dds_mailbox *mailbox, cau_dds_post *post)
{
	pthread_mutex_lock(&mailbox->mutex);
	if (mailbox->last)
		mailbox->last->next = post;
	else
		mailbox->first = post;
	mailbox->last = post;
	pthread_mutex_unlock(&mailbox->mutex);
}

static void on_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	cau_dds *dds = user;
	size_t bytes = outcome->error ? 0 : outcome->text_bytes;
	cau_dds_post *post = calloc(1, sizeof *post + bytes);
	if (!post) {
		cau_log(CAU_LOG_ERROR, NULL, "dds_answer_lost", "reason=\"no memory\"");
		if (outcome->joined)
			cau_hosted_leave(outcome->joined, &(cau_subscriber){.stream = outcome->stream});
		return;
	}
	post->ticket = reply->connection;
	post->method = reply->method;
	post->failed = outcome->error != NULL;
	if (outcome->error) {
		post->error = *outcome->error;
		post->code = outcome->code;
	} else {
		memcpy(post->text, outcome->text, bytes);
		post->text_bytes = bytes;
		post->stream = outcome->stream;
		if (outcome->joined)
			post->joined = cau_hosted_share(outcome->joined);
	}
	put(&dds->mailbox, post);
	cau_dds_wake(&dds->wakeup, &dds->wakeup.answered);
}

cau_reply cau_dds_reply(cau_dds *dds, cau_method method)
{
	return (cau_reply){.answer = on_answer,
	                   .user = dds,
	                   .connection = ++dds->last_ticket,
	                   .id = {.kind = CAU_RPC_ID_NUMBER},
	                   .method = method};
}

cau_dds_post *cau_dds_next_post(cau_dds_mailbox *mailbox)
{
	pthread_mutex_lock(&mailbox->mutex);
	cau_dds_post *post = mailbox->first;
	if (post)
		mailbox->first = post->next;
	if (!mailbox->first)
		mailbox->last = NULL;
	pthread_mutex_unlock(&mailbox->mutex);
	return post;
}

void cau_dds_post_free(cau_dds_post *post)
{
	if (post->joined) { // no stream took the joined session
		cau_hosted_leave(post->joined, &(cau_subscriber){.stream = post->stream});
		cau_hosted_release(post->joined);
	}
	free(post);
}

cau_status cau_dds_post_result(const cau_dds_post *post, void *result, cau_error *error)
{
	cau_rpc_message message = {0};
	cau_rpc_fault fault = {0};
	cau_status status =
		cau_rpc_read(post->text, post->text_bytes, post->text_bytes, &message, &fault);
	if (status)
		return cau_fail(error, status, fault.path, "%s", fault.reason);
	status = cau_rpc_result(&message, post->method, result, error);
	cau_rpc_finish(&message);
	return status;
}
