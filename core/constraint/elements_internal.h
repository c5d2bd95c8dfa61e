// SPDX-License-Identifier: GPL-3.0-or-later
// Between the files that lay elements out.
#pragma once

#include "constraint/elements_make.h"

enum { CAU_SHARE = 16 * CAU_BATCH }; // slots in a share of the local step, at most

// elements_records.c, in this order, once the sets are made
cau_status cau_elements_make_work(cau_elements *elements, cau_element_slots *slots,
                                  cau_arena *arena, cau_error *error);
cau_status cau_elements_make_records(const cau_tissue *tissue, cau_elements *elements,
                                     cau_element_slots *slots, cau_arena *arena, cau_error *error);
