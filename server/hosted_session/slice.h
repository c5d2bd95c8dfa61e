// SPDX-License-Identifier: GPL-3.0-or-later
// A slice of a session on a worker: its steps, and its end.
#pragma once

#include "cautery/session.h"
#include "hosted_session/order.h"
#include "session/logic.h"
#include "worker/pool.h"

cau_due cau_hosted_run(cau_task *task);

// ---- slice.c
// Commits, and publishes. By the thread that has the session.
void cau_hosted_end_slice(cau_hosted *h);
// Refuses an order, which it takes.
void cau_hosted_refuse_order(cau_hosted *h, cau_order *order, const cau_error *error, int32_t code);
// It has ended: what waits is refused. By its worker, the builder, or after both.
void cau_hosted_refuse_rest(cau_hosted *h);

// ---- apply.c: what each order does
// Takes the order if it is done or answered.
cau_outcome_kind cau_hosted_apply(cau_hosted *h, cau_order *order, const cau_action *action);
// Serves some of the `noted` oldest requests that only read.
void cau_reads_serve(cau_hosted *h, int32_t noted);

// What CAU_ORDER_TABLE names (order.h), in the file that each belongs to. Each takes the order.
// cau_apply_pause may get none: it was answered when it came.
typedef cau_outcome_kind cau_applied(cau_hosted *h, cau_order *order, const cau_action *action);
typedef void cau_served(cau_hosted *h, cau_order *order);
#define CHANGE(kind, ask, apply) cau_applied apply;
#define READ(kind, apply) cau_served apply;
CAU_ORDER_TABLE(CHANGE, READ)
#undef CHANGE
#undef READ

// ---- time.c
// session.step has made its ticks, or the session faulted within them.
void cau_time_stepped(cau_hosted *h, cau_order *order, bool failed);
// The session goes, and with it what the store has of it if it is stored, in the batch of this
// slice. False: there is no memory for it. Answers the order, which it takes.
bool cau_hosted_destroy(cau_hosted *h, cau_order *order, bool stored);

// ---- advance.c
// session.advance has made its ticks, or lock-step has ended. Takes the order.
void cau_advance_answer(cau_hosted *h, cau_order *order);

// ---- observe.c
// Whether it can be answered. Errors: CAU_BAD_VALUE, CAU_LIMIT.
cau_status cau_advance_check(const cau_session_info *info, const cau_advance *advance,
                             cau_error *error);
// The answer of now; malloc'ed, NULL on failure.
char *cau_advance_text(cau_hosted *h, const cau_order *order, size_t *bytes, cau_error *error);
