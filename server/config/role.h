// SPDX-License-Identifier: GPL-3.0-or-later
// The words for roles in settings and files: view, operate, admin.
#pragma once

#include <stdbool.h>

#include "cautery/message_choices.h"

const char *cau_role_word(cau_role role);
// Returns false if the word names no role; *role then stays unchanged.
bool cau_role_read(const char *word, cau_role *role);
