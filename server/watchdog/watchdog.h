// SPDX-License-Identifier: GPL-3.0-or-later
// The energy watchdog: a thread of its own, on the monotonic clock. It sleeps until the earliest
// deadline of a driver whose tool has energy on.
#pragma once

#include <stdbool.h>

#include "cautery/status.h"

typedef struct cau_watchdog cau_watchdog;

// Makes a watchdog. `look` cuts off the energy whose deadline has passed at `now_s`, and returns
// when to look again. INFINITY: only after cau_watchdog_wake.
cau_status cau_watchdog_create(cau_watchdog **watchdog, double (*look)(void *user, double now_s),
                               void *user, cau_error *error);
void cau_watchdog_destroy(cau_watchdog *watchdog); // `watchdog` may be NULL
// Makes the watchdog look at once, because energy was turned on. Any thread may call it.
void cau_watchdog_wake(cau_watchdog *watchdog);
// Returns whether the watchdog has looked since the last call, and asks it to look again. Any
// thread may call it.
bool cau_watchdog_moves(cau_watchdog *watchdog);
