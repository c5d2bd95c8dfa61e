// SPDX-License-Identifier: GPL-3.0-or-later
// Requests that only read, served at the end of a slice.
#include "hosted_session/internal.h"

#define SLICE_S 0.002 // served in one slice; the last one begun may go beyond it

#define CHANGE(...)
#define READ(kind, apply) [CAU_ORDER_##kind] = (apply),
static cau_served *const handlers[CAU_ORDER_COUNT] = {CAU_ORDER_TABLE(CHANGE, READ)};
#undef CHANGE
#undef READ

void cau_reads_serve(cau_hosted *h, int32_t noted)
{
	double end_s = cau_monotonic_s() + SLICE_S;
	for (cau_order *order; (order = cau_reads_take(h, &noted));) {
		handlers[order->kind](h, order);
		if (cau_monotonic_s() >= end_s)
			return;
	}
}
