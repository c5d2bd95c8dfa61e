// SPDX-License-Identifier: Apache-2.0
#include <math.h>

#include "library/internal.h"

cau_status cau_client_measure_clock(cau_client *client, int32_t count, cau_client_clock *clock,
                                    cau_error *error)
{
	double shortest_s = INFINITY;
	for (int32_t i = 0; i < count; i++) {
		cau_wire_heartbeat_result result = {0};
		double sent_s = cau_client_now();
		cau_status status = cau_client_call(client, CAU_METHOD_HEARTBEAT,
		                                    &(cau_wire_heartbeat){.visible = true}, &result, error);
		double back_s = cau_client_now();
		if (status)
			return status;
		if (back_s - sent_s >= shortest_s)
			continue;
		shortest_s = back_s - sent_s;
		clock->offset_s = 1e-6 * (double)result.server_time_us - 0.5 * (sent_s + back_s);
		clock->error_s = 0.5 * shortest_s;
	}
	return CAU_OK;
}
