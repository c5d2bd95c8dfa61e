// SPDX-License-Identifier: Apache-2.0
// Reads and writes scenes and commands as members of larger documents, such as requests.
#pragma once

#include "cautery/command.h"
#include "cautery/json_writer.h"
#include "cautery/scene.h"
#include "json/value.h"

// Each function reads the object `value`, which is at the reader's path.
void cau_read_scene(cau_reader *reader, const cJSON *value, cau_scene_def *scene);
void cau_read_command(cau_reader *reader, const cJSON *value, cau_command *command);
void cau_read_selection(cau_reader *reader, const cJSON *value, cau_selection *selection);

// Each function writes an object. See cau_json_open for `key`.
void cau_write_scene(cau_json_writer *writer, const char *key, const cau_scene_def *scene);
void cau_write_selection(cau_json_writer *writer, const char *key, const cau_selection *selection);
void cau_write_command(cau_json_writer *writer, const char *key, const cau_command *command);
