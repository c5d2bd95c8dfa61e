// SPDX-License-Identifier: Apache-2.0
// The labels of a fleet's daemons. The proxy in front of them answers /api/fleet with them:
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
	CAU_FLEET_LABELS_MAX = 1024,        // largest number of daemons in a fleet
	CAU_FLEET_JSON_MAX_BYTES = 1 << 16, // largest size of the answer
};

// The labels behind an address.
typedef struct cau_fleet {
	int32_t count; // number of labels; 0 means a single daemon, which has no label
	char labels[CAU_FLEET_LABELS_MAX][CAU_NAME_BYTES]; // `count` labels
} cau_fleet;

// Reads the answer. Each label is a name without "-", and no label occurs twice. The answer of a
// single daemon has no labels. Unknown members are skipped. After an error *fleet has no labels.
// Errors: CAU_BAD_SYNTAX, CAU_LIMIT, CAU_NO_MEMORY, CAU_BAD_VALUE with the path of the member.
cau_status cau_fleet_from_json(const char *text, size_t bytes, cau_fleet *fleet, cau_error *error);

#ifdef __cplusplus
}
#endif
