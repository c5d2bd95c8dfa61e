// SPDX-License-Identifier: GPL-3.0-or-later
// Reports of a run at its end.
#pragma once

#include <stdio.h>

#include "cautery/scene.h"
#include "cautery/status.h"
#include "sim/run.h"

void sim_report_text(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result);

// Writes the result as one line of JSON. `error` is the failure that ended the run, or NULL.
void sim_report_json(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result, const cau_error *error);

// Writes one line of JSON for a run that never began.
void sim_report_json_error(FILE *out, const cau_error *error);

// Writes "file: path: reason", as far as they are known.
void sim_report_error(FILE *out, const cau_error *error);
