// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The one of `names` that `word` was most likely meant to be (edit distance with transpositions,
// case ignored), or NULL if none is near.
const char *cau_nearest_name(const char *word, const char *const *names, int count);
