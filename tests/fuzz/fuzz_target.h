// SPDX-License-Identifier: GPL-3.0-or-later
// The one function of a fuzz target: feeds `bytes` bytes at `data` to a parser. Returns 0, or -1 to
// keep the input out of the corpus. A finding is a crash or a sanitizer report, never a return
// value.
#pragma once

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
