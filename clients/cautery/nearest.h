// SPDX-License-Identifier: GPL-3.0-or-later
// What somebody meant who mistyped a word.
#pragma once

#include <stddef.h>

// The word of the list that is fewest slips away (a letter left out, added, replaced, or two turned
// round: Damerau 1964; its whole end left out is one), the first of several; NULL if none is near
// enough to have been meant. Words of at most 63 bytes count.
const char *cli_nearest(const char *word, const char *const *words, size_t count);
