// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for a proxy's list of labels. An accepted list is valid; a refused one has a reason.
#include <stdlib.h>
#include <string.h>

#include "cautery/fleet_json.h"
#include "fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static cau_fleet fleet;
	cau_error error = {0};
	cau_status status = cau_fleet_from_json((const char *)data, bytes, &fleet, &error);
	if (status ? fleet.count != 0 || error.reason[0] == 0
	           : fleet.count < 0 || fleet.count > CAU_FLEET_LABELS_MAX)
		abort();
	for (int32_t i = 0; i < fleet.count; i++)
		if (!cau_name_is_valid(fleet.labels[i]) || strchr(fleet.labels[i], '-'))
			abort();
	return 0;
}
