// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics of every tick as comma-separated values.
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "cautery/session.h"

void sim_csv_begin(FILE *file);
void sim_csv_tick(FILE *file, const cau_frame *frame);
