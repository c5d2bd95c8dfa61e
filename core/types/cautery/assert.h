// SPDX-License-Identifier: Apache-2.0
// Conditions that a function relies on, written so that a build checks them: assertions in debug
// builds, safety rules in every build.
//
// An assertion is about this program's own mistakes: an index beyond its array, a call out of
// order, a count below zero, a table without an entry for a kind. Errors of a scene, a client, a
// file or a machine are checked and answered with a status instead, in every build.
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

#include <setjmp.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Writes "FILE:LINE: FUNCTION: CONDITION does not hold: " and the message to stderr, in one write,
// and aborts. Any thread may call it.
__attribute__((noreturn, cold, format(printf, 5, 6))) void
cau_assert_failed(const char *condition, const char *file, int line, const char *function,
                  const char *format, ...);

// CAU_ASSERT(condition, format, ...): the message states the actual values.
#ifdef CAU_ASSERTIONS
#define CAU_ASSERT(condition, ...)                                                                 \
	((condition) ? (void)0                                                                         \
	             : cau_assert_failed(#condition, __FILE__, __LINE__, __func__, __VA_ARGS__))
#else
#define CAU_ASSERT(condition, ...) ((void)(0 && (condition)))
#endif

// Returns 1 if 0 <= index < count, otherwise 0.
static inline int cau_is_index(int64_t index, int64_t count)
{
	return index >= 0 && index < count;
}

// Asserts that 0 <= index < count, for integers of any type.
#define CAU_ASSERT_INDEX(index, count)                                                             \
	CAU_ASSERT(cau_is_index((int64_t)(index), (int64_t)(count)), "number %lld of %lld",            \
	           (long long)(index), (long long)(count))

// ---- safety rules -------------------------------------------------------------------------------

// Rules about energy, tools and the bounds of frames are checked in every build. A broken rule is a
// mistake of this program too, but a daemon with other sessions must not end because of it. So a
// broken rule abandons the thread's present work and returns to the guard around it. The guard's
// owner makes its state safe and reports. The functions in between must own no lock, memory or
// file.
//
//     static int take(const int *order, int count)
//     {
//         CAU_RULE(count > 0, "%d orders", count);
//         return order[count - 1];
//     }
//
//     int take_safely(const int *order, int count, cau_rule_guard *guard)
//     {
//         int taken = 0;
//         cau_rule_enter(guard);
//         if (setjmp(guard->place) == 0)
//             taken = take(order, count);
//         cau_rule_leave(guard); // guard->reason is "" unless a rule was broken
//         return taken;
//     }

enum { CAU_RULE_REASON_BYTES = 320 }; // size of the reason, with its terminating zero

// The point to which a broken rule returns. The owner provides the storage from cau_rule_enter to
// cau_rule_leave.
typedef struct cau_rule_guard {
	jmp_buf place;                // the owner calls setjmp(guard.place) right after cau_rule_enter
	struct cau_rule_guard *outer; // the guard around it; private
	char reason[CAU_RULE_REASON_BYTES]; // the broken rule, its file and line, and the message
} cau_rule_guard;

// Makes `guard` the innermost guard of the calling thread. cau_rule_leave must follow in the same
// function.
void cau_rule_enter(cau_rule_guard *guard);
// Makes the guard around `guard` the innermost one again. `guard` must be the innermost guard.
void cau_rule_leave(cau_rule_guard *guard);

// Fills the reason of the thread's innermost guard and returns to its setjmp, which returns 1. A
// thread without a guard ends the program, as cau_assert_failed does.
__attribute__((noreturn, cold, format(printf, 5, 6))) void
cau_rule_broken(const char *condition, const char *file, int line, const char *function,
                const char *format, ...);

// CAU_RULE(condition, format, ...): the message states the actual values.
#define CAU_RULE(condition, ...)                                                                   \
	((condition) ? (void)0 : cau_rule_broken(#condition, __FILE__, __LINE__, __func__, __VA_ARGS__))

// Checks the rule 0 <= index < count, for integers of any type.
#define CAU_RULE_INDEX(index, count)                                                               \
	CAU_RULE(cau_is_index((int64_t)(index), (int64_t)(count)), "number %lld of %lld",              \
	         (long long)(index), (long long)(count))

#ifdef __cplusplus
}
#endif
