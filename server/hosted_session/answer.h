// SPDX-License-Identifier: GPL-3.0-or-later
// Answers orders and sends notifications.
#pragma once

#include "hosted_session/record.h"

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
