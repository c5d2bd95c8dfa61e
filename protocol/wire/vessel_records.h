// SPDX-License-Identifier: Apache-2.0
// Writes and reads the section of the channel `vessels` in frames.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/channels.h"

enum { VESSELS_BYTES_MAX = 9 << 10 };

// Returns why a decoder would refuse this vessel, or NULL.
const char *cau_vessel_state_check(const cau_vessel_state *vessel);

// Writes the payload and returns its length, VESSELS_BYTES_MAX at most.
size_t cau_vessels_write(uint8_t *out, const cau_vessel_state *vessels, int32_t count);
// Reads a payload. Returns NULL, or why it is refused.
const char *cau_vessels_read(const uint8_t *payload, size_t bytes, cau_vessel_state *vessels,
                             int32_t *count);
