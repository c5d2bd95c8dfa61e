// SPDX-License-Identifier: GPL-3.0-or-later
// A slice of a session on a worker: its steps, its orders and their answers, and its end.
#pragma once

#include "cautery/session.h"
#include "hosted_session/life.h"
#include "hosted_session/order.h"
#include "hosted_session/record.h"
#include "session/logic.h"
#include "worker/pool.h"

// ---- answers ------------------------------------------------------------------------------------
// Answers orders and sends notifications.

// the error for jobs that the builder drops because the daemon ends
extern const cau_error cau_daemon_ends;
void cau_answer_now(const cau_reply *reply, const void *result);
void cau_answer_fail(cau_order *order, const cau_error *error, int32_t code);
// Fails the order with this status, path and reason. Returns CAU_NOT_DONE.
cau_outcome_kind cau_answer_refuse(cau_order *order, cau_status status, const char *path,
                                   const char *reason);
// Sends a notification.
void cau_answer_notify(const cau_hosted_identity *identity, cau_audience audience,
                       cau_method method, const void *params);

// Answers at once, or after the commit if the method changes something. Takes ownership of the
// order.
void cau_answer_order(cau_hosted_record *record, cau_order *order, const void *result);
// Notifies clients of a change of the session. `client` may be NULL or "".
void cau_answer_changed(cau_hosted *h, int change, const char *client);
char *cau_answer_description(cau_hosted *h, cau_method method, size_t *bytes, cau_error *error);
void cau_answer_driver(const cau_drive *drive, cau_wire_driver *driver); // fills *driver

// ---- slices and orders --------------------------------------------------------------------------

cau_due cau_hosted_run(cau_task *task);

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

// ---- slice.c
// Commits and publishes. Only the session's owning thread (internal.h) calls this.
void cau_hosted_end_slice(cau_hosted *h);
// Refuses an order and takes ownership of it.
void cau_hosted_refuse_order(cau_hosted *h, cau_order *order, const cau_error *error, int32_t code);
// Refuses all waiting orders of an ended session. Called by its worker, by the builder, or after
// both have ended.
void cau_hosted_refuse_rest(cau_hosted *h);

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

// ---- energy -------------------------------------------------------------------------------------
// Passes changes of drivers and energy on to the core and the log. server/session/drive.c decides
// who drives and which energy is on.

// Applies an energy-off or a hold, which cannot fail. Returns false if the command is of another
// kind.
bool cau_energy_off_or_hold(const cau_hosted_identity *identity, cau_present_core *core,
                            const cau_command *command);
// Turns the tool's energy off by the daemon itself. The log entry names no client.
void cau_energy_turn_off(cau_hosted *h, const char *tool);
// Carries out an energy cut-off of the decisions. Stops the tool where it is if its drive says
// `freeze`.
void cau_energy_cut(cau_hosted *h, const cau_action *action);
