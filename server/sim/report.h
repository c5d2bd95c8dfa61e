// SPDX-License-Identifier: GPL-3.0-or-later
// What a run says at its end.
#pragma once

#include <stdio.h>

#include "cautery/scene.h"
#include "cautery/status.h"
#include "sim/run.h"

void sim_report_text(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result);

// One line of JSON. `error` is the failure that ended the run, or NULL.
void sim_report_json(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result, const cau_error *error);

// The same for a run that never began.
void sim_report_json_error(FILE *out, const cau_error *error);

// "file: path: reason", with what is known.
void sim_report_error(FILE *out, const cau_error *error);
