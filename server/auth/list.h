// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>

// True if `text` is one of the comma-separated names in `list`, ignoring case.
bool cau_list_has(const char *list, const char *text);
