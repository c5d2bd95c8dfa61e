// SPDX-License-Identifier: Apache-2.0
// The labels of a fleet's daemons, as the proxy in front of them answers at /api/fleet:
// {"labels": ["d1", "d2"]}.
//
//     #include "cautery/fleet_json.h"
//
//     static bool is_one_of(const cau_fleet *fleet, const char *label)
//     {
//         for (int32_t i = 0; i < fleet->count; i++)
//             if (strcmp(fleet->labels[i], label) == 0)
//                 return true;
//         return false;
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "cautery/name.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
	CAU_FLEET_LABELS_MAX = 1024,        // daemons of a fleet
	CAU_FLEET_JSON_MAX_BYTES = 1 << 16, // of the answer
};

// The labels behind an address.
typedef struct cau_fleet {
	int32_t count;                                     // 0: no fleet, one daemon alone
	char labels[CAU_FLEET_LABELS_MAX][CAU_NAME_BYTES]; // (count)
} cau_fleet;

// Reads the answer: labels, each a name without "-", none twice; a daemon alone has none. Members
// that it does not know are skipped. On an error *fleet has no labels. Errors: CAU_BAD_SYNTAX,
// CAU_LIMIT, CAU_NO_MEMORY, CAU_BAD_VALUE with the path of the member.
cau_status cau_fleet_from_json(const char *text, size_t bytes, cau_fleet *fleet, cau_error *error);

#ifdef __cplusplus
}
#endif
