// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cautery/options.h"

// Reads an option's value into *member, which has the type of the option's kind. `value` is NULL
// for an option without a value. Prints a mistake on `complaints` and returns false.
bool cau_option_read_value(const cau_command_line *line, const cau_option *option,
                           const char *value, void *member, FILE *complaints);
