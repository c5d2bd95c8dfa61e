// SPDX-License-Identifier: GPL-3.0-or-later
// The settings as an array, made from the one table in config.h.
#pragma once

#include <stddef.h>

#include "config/config.h"

typedef enum setting_kind {
	SETTING_TEXT,
	SETTING_INTEGER,
	SETTING_REAL,
	SETTING_SWITCH
} setting_kind;

typedef struct setting {
	const char *name;
	setting_kind kind;
	size_t offset; // offset in cau_config
	const char *default_text;
	double least, most; // for SETTING_INTEGER and SETTING_REAL
	const char *meaning;
} setting;

extern const setting cau_settings[];
extern const size_t cau_setting_count;

// Finds a setting; NULL if no setting has the name. Both spellings are accepted, `max_sessions` and
// `max-sessions`.
const setting *cau_setting_find(const char *name);

// True if both configurations have the same value of the setting.
bool cau_setting_same(const setting *setting, const cau_config *a, const cau_config *b);

// Checks and stores one value.
cau_status cau_setting_store(const setting *setting, cau_config *config, const char *text,
                             cau_error *error);
