// SPDX-License-Identifier: GPL-3.0-or-later
// What the builder does beside the session's slices: reads, and waiting for the store before a
// fork.
#include <stdlib.h>

#include "hosted_session/internal.h"

typedef struct reading {
	cau_job job; // first
	cau_read_job read;
	cau_read_work *work;
	void (*finish)(void *copy);
} reading;

static void end(reading *r)
{
	cau_hosted *h = r->read.hosted;
	if (r->finish)
		r->finish(r->read.copy);
	if (cau_reads_make_file(r->read.order))
		atomic_fetch_sub(&h->files, 1);
	free(r->read.order);
	cau_worker_pool_wake(h->around->pool, &h->task); // others may have waited for this
	cau_hosted_release(h);
	free(r);
}

static void run(cau_job *job)
{
	reading *r = (reading *)job;
	r->work(&r->read);
	end(r);
}

static void drop(cau_job *job)
{
	reading *r = (reading *)job;
	cau_error error = {0};
	cau_fail(&error, CAU_BAD_STATE, "", "the daemon is ending");
	cau_reply_fail(&r->read.order->reply, &error, CAU_RPC_DRAINING);
	end(r);
}

void cau_reads_hand_over(cau_hosted *h, cau_order *order, cau_read_work *work, void *copy,
                         void (*finish)(void *copy), double expected_s)
{
	reading *r = malloc(sizeof *r);
	if (!r) {
		cau_error error = {0};
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the answer");
		if (finish)
			finish(copy);
		cau_answer_fail(order, &error, 0);
		return;
	}
	*r = (reading){.job = {.run = run, .drop = drop, .expected_s = expected_s},
	               .read = {.hosted = cau_hosted_share(h),
	                        .order = order,
	                        .tick = h->tick,
	                        .branch = h->branch,
	                        .copy = copy},
	               .work = work,
	               .finish = finish};
	if (cau_reads_make_file(order))
		atomic_fetch_add(&h->files, 1);
	cau_record_commit(h); // what the builder reads from the store is on its way there
	cau_builder_submit(h->around->builder, &r->job);
}
