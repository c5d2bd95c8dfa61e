// SPDX-License-Identifier: GPL-3.0-or-later
// Between the files that lay elements out.
#pragma once

#include "constraint/elements_make.h"

// elements_records.c, in this order, once the sets are made
cau_status cau_elements_make_records(cau_elements *elements, cau_arena *arena, cau_error *error);
cau_status cau_elements_make_work(const cau_elements *elements, cau_element_slots *slots,
                                  cau_arena *arena, cau_error *error);
cau_status cau_elements_make_incidence(const cau_tissue *tissue, const cau_elements *elements,
                                       cau_element_slots *slots, cau_arena *arena,
                                       cau_error *error);
