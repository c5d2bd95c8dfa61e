// SPDX-License-Identifier: Apache-2.0
// Passes the newest record from one thread to another without waiting. There are three slots. One
// is the writer's, one is the reader's, and the third is between them: each of them exchanges its
// own slot for it.
#pragma once

#include <stdatomic.h>
#include <stddef.h>

#include "cautery/channels.h"

enum { MAILBOX_FRESH = 4 }; // flag in `between`: the record in the third slot is unread

typedef struct mailbox {
	cau_tool_contact slot[3];
	// number of the third slot, plus MAILBOX_FRESH if its record is unread
	_Atomic unsigned between;
	unsigned writing; // the writer's slot; only the writer uses it
	unsigned reading; // the reader's slot; only the reader uses it
} mailbox;

static inline void mailbox_begin(mailbox *mail)
{
	atomic_init(&mail->between, 0);
	mail->writing = 1;
	mail->reading = 2;
}

// Copies a record into the mailbox. An unread older record is lost.
static inline void mailbox_put(mailbox *mail, const cau_tool_contact *record)
{
	mail->slot[mail->writing] = *record;
	mail->writing = atomic_exchange_explicit(&mail->between, mail->writing | MAILBOX_FRESH,
	                                         memory_order_acq_rel) &
	                ~(unsigned)MAILBOX_FRESH;
}

// Returns the newest record if it is unread, else NULL. The record belongs to the reader until the
// next call.
static inline cau_tool_contact *mailbox_get(mailbox *mail)
{
	if (!(atomic_load_explicit(&mail->between, memory_order_relaxed) & MAILBOX_FRESH))
		return NULL;
	mail->reading = atomic_exchange_explicit(&mail->between, mail->reading, memory_order_acq_rel) &
	                ~(unsigned)MAILBOX_FRESH;
	return &mail->slot[mail->reading];
}
