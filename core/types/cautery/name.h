// SPDX-License-Identifier: Apache-2.0
// The rule for names of scenes, meshes, layers, sessions and tools: they become ROS names,
// partitions and URLs.
//
//     #include "cautery/name.h"
//     #include "cautery/status.h"
//
//     static cau_status check(const char *name, cau_error *error)
//     {
//         if (cau_name_is_valid(name)) // "left-hook", not "Left hook"
//             return CAU_OK;
//         return cau_fail(error, CAU_BAD_VALUE, "name", "not a name: " CAU_NAME_RULE);
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/scene.h"

#define CAU_NAME_RULE "[a-z][a-z0-9]*([_-][a-z0-9]+)*, at most 48 bytes"

// True if the text is a name by CAU_NAME_RULE.
static inline bool cau_name_is_valid(const char *name)
{
	bool word = false; // the previous byte is a letter or a digit
	for (size_t i = 0; name[i]; i++) {
		bool letter = name[i] >= 'a' && name[i] <= 'z';
		bool digit = name[i] >= '0' && name[i] <= '9';
		bool joint = name[i] == '_' || name[i] == '-';
		if (i + 1 >= CAU_NAME_BYTES || (i == 0 && !letter) || !(letter || digit || joint) ||
		    (joint && !word))
			return false;
		word = !joint;
	}
	return word;
}
