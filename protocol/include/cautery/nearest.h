// SPDX-License-Identifier: Apache-2.0
// Finds the known word that is nearest to a misspelt member, option or command.
//
//     #include <stdio.h>
//
//     #include "cautery/nearest.h"
//
//     static void complain(const char *word)
//     {
//         static const char *const known[] = {"create", "record"};
//         const char *meant = cau_nearest(word, known, 2);
//         fprintf(stderr, "no \"%s\"; near it: %s\n", word, meant ? meant : "nothing");
//     }
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

// Returns the first of `words` with the fewest slips from `word`. A slip is a letter added, left
// out, replaced, or swapped with the next; case is ignored. A word may have one slip for each three
// letters or part of three letters, but fewer slips than letters. If `word` is the beginning of
// another word, that counts as one slip. Returns NULL if no word is near, or if `word` is longer
// than 63 bytes.
const char *cau_nearest(const char *word, const char *const *words, size_t count);

#ifdef __cplusplus
}
#endif
