// SPDX-License-Identifier: GPL-3.0-or-later
// Which regions a layer's elements have.
#pragma once

#include "base/memory.h"
#include "tissue/tissue.h"

// Lists the regions of `count` elements. The list lives in the arena.
cau_status cau_region_list_make(cau_region_list *list, const int32_t *region, int32_t count,
                                cau_arena *arena, cau_error *error);
// CAU_NOT_FOUND at `path`, with the regions that exist, where the list lacks `region`.
cau_status cau_region_list_check(const cau_region_list *list, const char *layer, int32_t region,
                                 const char *path, cau_error *error);
