// SPDX-License-Identifier: Apache-2.0
// The newest record, from one thread to another; neither waits. Three slots: the writer's, the
// reader's, and the one between, which they exchange.
#pragma once

#include <stdatomic.h>
#include <stddef.h>

#include "cautery/channels.h"

enum { MAILBOX_FRESH = 4 }; // added to the number of the slot between while it was not read

typedef struct mailbox {
	cau_tool_contact slot[3];
	_Atomic unsigned between; // number of its slot, and MAILBOX_FRESH
	unsigned writing;         // of the writer alone
	unsigned reading;         // of the reader alone
} mailbox;

static inline void mailbox_begin(mailbox *mail)
{
	atomic_init(&mail->between, 0);
	mail->writing = 1;
	mail->reading = 2;
}

// Copies a record in; an older one that was not read is gone.
static inline void mailbox_put(mailbox *mail, const cau_tool_contact *record)
{
	mail->slot[mail->writing] = *record;
	mail->writing = atomic_exchange_explicit(&mail->between, mail->writing | MAILBOX_FRESH,
	                                         memory_order_acq_rel) &
	                ~(unsigned)MAILBOX_FRESH;
}

// The newest record if it was not read before, else NULL. Its slot is the reader's until the next
// call.
static inline cau_tool_contact *mailbox_get(mailbox *mail)
{
	if (!(atomic_load_explicit(&mail->between, memory_order_relaxed) & MAILBOX_FRESH))
		return NULL;
	mail->reading = atomic_exchange_explicit(&mail->between, mail->reading, memory_order_acq_rel) &
	                ~(unsigned)MAILBOX_FRESH;
	return &mail->slot[mail->reading];
}
