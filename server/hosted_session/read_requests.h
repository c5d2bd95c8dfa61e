// SPDX-License-Identifier: GPL-3.0-or-later
// Requests that only read a session wait apart from its drivers' orders.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "buffer/shelf.h"
#include "cautery/session.h"
#include "hosted_session/order.h"

typedef struct cau_hosted_reads {
	pthread_mutex_t lock;
	cau_order *first;  // lock: those that wait
	int32_t count;     // lock
	atomic_int files;  // of this session that the builder makes
	cau_shelf *copies; // memory for what files show
} cau_hosted_reads;

bool cau_reads_are(const cau_order *order);
bool cau_reads_make_file(const cau_order *order);
// Like cau_hosted_submit, for those.
cau_status cau_reads_submit(cau_hosted *h, cau_order *order, cau_error *error);
// How many wait. Noted before a slice takes the drivers' queue, so that each is served after all
// commands that came before it.
int32_t cau_reads_note(cau_hosted_reads *reads);
// The first of the `*noted` oldest that can be served now, NULL: none; counts down those it looked
// at.
cau_order *cau_reads_take(cau_hosted_reads *reads, int32_t *noted);
bool cau_reads_wait(cau_hosted_reads *reads); // some can be served now
void cau_reads_refuse(cau_hosted *h);         // all, of a session that has ended

// ---- with the builder

// What the builder needs for an answer; its thread must look at nothing of the session that steps
// change.
typedef struct cau_read_job {
	cau_hosted *hosted;
	cau_order *order;
	uint64_t tick; // of the slice that handed it over
	int64_t branch;
	void *copy;
} cau_read_job;
typedef void cau_read_work(cau_read_job *job); // answers the order, which is not its to free
// Leaves an order to the builder, whose thread does `work` and then, also without having done it,
// `finish` (may be NULL) with the copy. Takes order and copy.
void cau_reads_hand_over(cau_hosted *h, cau_order *order, cau_read_work *work, void *copy,
                         void (*finish)(void *copy), double expected_s);

// ---- export.c
size_t cau_export_copy_bytes(const cau_session_info *info); // of what a file shows of a tick
uint32_t cau_export_number(void);                           // of the next file
