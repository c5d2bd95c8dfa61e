// SPDX-License-Identifier: GPL-3.0-or-later
// Requests that only read a session. They wait in a queue apart from the orders of drivers.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "buffer/buffer.h"
#include "cautery/session.h"
#include "hosted_session/order.h"

typedef struct cau_hosted_reads {
	pthread_mutex_t lock;
	cau_order *first;  // under the lock: the waiting requests
	int32_t count;     // under the lock: number of waiting requests
	atomic_int files;  // files of this session that the builder makes now
	cau_shelf *copies; // memory for the copies from which files are made
} cau_hosted_reads;

bool cau_reads_are(const cau_order *order);
bool cau_reads_make_file(const cau_order *order);
// Queues a request that only reads; otherwise like cau_hosted_submit.
cau_status cau_reads_submit(cau_hosted *h, cau_order *order, cau_error *error);
// Returns the number of waiting requests. A slice notes this number before it takes orders of
// drivers. So each noted request is served after all commands that came before it.
int32_t cau_reads_note(cau_hosted_reads *reads);
// Removes the first of the `*noted` oldest requests that can be served now, or returns NULL.
// Reduces *noted by the requests that it has passed.
cau_order *cau_reads_take(cau_hosted_reads *reads, int32_t *noted);
bool cau_reads_wait(cau_hosted_reads *reads); // true if a request can be served now
void cau_reads_refuse(cau_hosted *h);         // refuses all requests of a session that has ended

// ---- requests that the builder answers

// The builder's input for an answer. Its thread must not read anything of the session that steps
// change.
typedef struct cau_read_job {
	cau_hosted *hosted;
	cau_order *order;
	uint64_t tick; // tick of the slice that handed the request over
	int64_t branch;
	void *copy;
} cau_read_job;
typedef void cau_read_work(cau_read_job *job); // answers the order, but does not free it
// Hands an order to the builder, whose thread calls `work` and then `finish` (may be NULL) with the
// copy. If the job is dropped, only `finish` is called. Takes ownership of the order and the copy.
void cau_reads_hand_over(cau_hosted *h, cau_order *order, cau_read_work *work, void *copy,
                         void (*finish)(void *copy), double expected_s);

// ---- export.c
// bytes of a copy of all that a file shows
size_t cau_export_copy_bytes(const cau_session_info *info);
uint32_t cau_export_number(void); // returns a new number for a file's transfer
