// SPDX-License-Identifier: GPL-3.0-or-later
// A slice of a session on a worker: its steps and its end.
#pragma once

#include "cautery/session.h"
#include "hosted_session/order.h"
#include "session/logic.h"
#include "worker/pool.h"

cau_due cau_hosted_run(cau_task *task);

// ---- slice.c
// Commits and publishes. Only the session's owning thread (internal.h) calls this.
void cau_hosted_end_slice(cau_hosted *h);
// Refuses an order and takes ownership of it.
void cau_hosted_refuse_order(cau_hosted *h, cau_order *order, const cau_error *error, int32_t code);
// Refuses all waiting orders of an ended session. Called by its worker, by the builder, or after
// both have ended.
void cau_hosted_refuse_rest(cau_hosted *h);

// ---- apply.c: what each order does
// Takes ownership of the order if it is done or answered.
cau_outcome_kind cau_hosted_apply(cau_hosted *h, cau_order *order, const cau_action *action);
// Serves some of the `noted` oldest requests that only read.
void cau_reads_serve(cau_hosted *h, int32_t noted);

// The functions that CAU_ORDER_TABLE (order.h) names. Each takes ownership of its order.
// cau_apply_pause may get NULL for a pause that was already answered on arrival.
typedef cau_outcome_kind cau_applied(cau_hosted *h, cau_order *order, const cau_action *action);
typedef void cau_served(cau_hosted *h, cau_order *order);
#define CHANGE(kind, ask, apply) cau_applied apply;
#define READ(kind, apply) cau_served apply;
CAU_ORDER_TABLE(CHANGE, READ)
#undef CHANGE
#undef READ

// ---- time.c
// Answers session.step after its ticks, or after a fault within them.
void cau_time_stepped(cau_hosted *h, cau_order *order, bool failed);
// Destroys the session. If it is stored, this slice's batch also deletes its rows. Answers the
// order and takes ownership of it. Returns false if memory runs out.
bool cau_hosted_destroy(cau_hosted *h, cau_order *order, bool stored);

// ---- advance.c
// Answers session.advance after its ticks, or after the end of lock-step. Takes ownership of the
// order.
void cau_advance_answer(cau_hosted *h, cau_order *order);

// ---- observe.c
// Checks whether the advance can be answered. Errors: CAU_BAD_VALUE, CAU_LIMIT.
cau_status cau_advance_check(const cau_session_info *info, const cau_advance *advance,
                             cau_error *error);
// Returns the answer for the present state; malloc'ed, NULL on failure.
char *cau_advance_text(cau_hosted *h, const cau_order *order, size_t *bytes, cau_error *error);
