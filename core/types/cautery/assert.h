// SPDX-License-Identifier: Apache-2.0
// What a function takes for granted, said so that a debug build checks it.
//
// An assertion is about this program's own mistakes: an index beyond its array, a call out of
// order, a count below zero, a table without a row for a kind. What a scene, a client, a file or a
// machine can get wrong is checked and answered with a status instead, in every build.
//
// CAU_ASSERTIONS is defined in Debug builds and wherever a sanitizer is on. Elsewhere the condition
// is compiled and never evaluated, so an assertion costs nothing and must change nothing.
//
//     #include "cautery/assert.h"
//
//     // The mean of `count` numbers, at least one.
//     static double mean_of(const double *value, int count)
//     {
//         CAU_ASSERT(count > 0, "the mean of %d numbers", count);
//         double sum = 0;
//         for (int i = 0; i < count; i++)
//             sum += value[i];
//         return sum / count;
//     }
#pragma once

#include <stdint.h>

// Writes "FILE:LINE: FUNCTION: CONDITION does not hold: " and the words to stderr, in one write,
// and aborts. Any thread may call it.
__attribute__((noreturn, cold, format(printf, 5, 6))) void
cau_assert_failed(const char *condition, const char *file, int line, const char *function,
                  const char *format, ...);

// CAU_ASSERT(condition, format, ...): the words say what was the case, with the numbers.
#ifdef CAU_ASSERTIONS
#define CAU_ASSERT(condition, ...)                                                                 \
	((condition) ? (void)0                                                                         \
	             : cau_assert_failed(#condition, __FILE__, __LINE__, __func__, __VA_ARGS__))
#else
#define CAU_ASSERT(condition, ...) ((void)(0 && (condition)))
#endif

static inline int cau_is_index(int64_t index, int64_t count)
{
	return index >= 0 && index < count;
}

// 0 <= index < count, for integers of any kind.
#define CAU_ASSERT_INDEX(index, count)                                                             \
	CAU_ASSERT(cau_is_index((int64_t)(index), (int64_t)(count)), "number %lld of %lld",            \
	           (long long)(index), (long long)(count))
