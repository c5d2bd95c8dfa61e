// SPDX-License-Identifier: GPL-3.0-or-later
// Histograms of the store's metrics.
#pragma once

#include "store_state.h"

// Returns the bucket of a duration, 0 to CAU_STORE_TIME_BUCKETS - 1. The last bucket has all longer
// durations.
int cau_store_time_bucket(double seconds);

// Counts one commit of a group of `batches`.
void cau_store_count_commit(struct cau_store_queue *queue, int batches, double seconds);
