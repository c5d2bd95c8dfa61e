// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>

// Whether `text` is one of the names, separated by commas, in `list`; in any case.
bool cau_list_has(const char *list, const char *text);
