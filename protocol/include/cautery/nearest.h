// SPDX-License-Identifier: Apache-2.0
// What somebody meant who wrote a word that is none: members of an object, options, commands.
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

// The first of `words` with the fewest slips away from `word` (letters added, left out, taken for
// others or turned round; case ignored), a slip for each three of its letters and one more at most.
// Where the word is the beginning of another that counts as one. NULL if none is near, or the word
// is longer than 63 bytes.
const char *cau_nearest(const char *word, const char *const *words, size_t count);
