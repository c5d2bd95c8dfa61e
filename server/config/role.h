// SPDX-License-Identifier: GPL-3.0-or-later
// The words that settings and files have for roles: view, operate, admin.
#pragma once

#include <stdbool.h>

#include "cautery/message_choices.h"

const char *cau_role_word(cau_role role);
bool cau_role_read(const char *word, cau_role *role); // false: it is none, *role stays
