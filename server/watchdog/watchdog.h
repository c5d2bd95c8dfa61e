// SPDX-License-Identifier: GPL-3.0-or-later
// The energy watchdog: a thread of its own, on the monotonic clock, that sleeps until the earliest
// driver of an energized tool would have been silent for too long.
#pragma once

#include <stdbool.h>

#include "cautery/status.h"

typedef struct cau_watchdog cau_watchdog;

// `look` cuts what is due at `now_s` and returns when to look again, INFINITY for not before
// cau_watchdog_wake.
cau_status cau_watchdog_create(cau_watchdog **watchdog, double (*look)(void *user, double now_s),
                               void *user, cau_error *error);
void cau_watchdog_destroy(cau_watchdog *watchdog); // takes NULL
// Something was energized: look at once. From any thread.
void cau_watchdog_wake(cau_watchdog *watchdog);
// Whether it has looked since this was asked last, and asks it to. From any thread.
bool cau_watchdog_moves(cau_watchdog *watchdog);
