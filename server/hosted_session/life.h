// SPDX-License-Identifier: GPL-3.0-or-later
// How a session ends. Any thread reads it.
#pragma once

#include <stdatomic.h>

#include "hosted_session/order.h"
#include "hosted_session/sink.h"

typedef struct cau_hosted_life {
	atomic_bool ended, drain_wanted, drained;
	cau_moved_to moved; // once it has ended: where it went; written before `ended`
} cau_hosted_life;

// There is no session for the order any more.
void cau_hosted_refuse_gone(const cau_hosted_life *life, cau_order *order);
// It could not be brought up or kept: nothing is taken any more. Any thread.
void cau_hosted_end(cau_hosted *h);
