// SPDX-License-Identifier: GPL-3.0-or-later
// The regions of a layer's elements.
#pragma once

#include "base/memory.h"
#include "tissue/tissue.h"

// Lists the regions of `count` elements. The list is in the arena's memory.
cau_status cau_region_list_make(cau_region_list *list, const int32_t *region, int32_t count,
                                cau_arena *arena, cau_error *error);
// Returns CAU_NOT_FOUND at `path`, with the existing regions, if the list lacks `region`.
cau_status cau_region_list_check(const cau_region_list *list, const char *layer, int32_t region,
                                 const char *path, cau_error *error);
