// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cautery/options.h"

// Reads an option's value into *member, which has the type of its kind; NULL for one without. False
// after a line on `complaints`.
bool cau_option_read_value(const cau_command_line *line, const cau_option *option,
                           const char *value, void *member, FILE *complaints);
