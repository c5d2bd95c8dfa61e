// SPDX-License-Identifier: Apache-2.0
// Writes and reads the section of the channel `tool_contact` in frames.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/channels.h"

enum { CONTACTS_BYTES_MAX = 3 << 10 };

// Returns why a decoder would refuse this record, or NULL.
const char *cau_tool_contact_check(const cau_tool_contact *contact);

// Writes the payload and returns its length, CONTACTS_BYTES_MAX at most.
size_t cau_contacts_write(uint8_t *out, const cau_tool_contact *contacts, int32_t count);
// Reads a payload except time_s, which the frame's header has. Returns NULL, or why it is refused.
const char *cau_contacts_read(const uint8_t *payload, size_t bytes, cau_tool_contact *contacts,
                              int32_t *count);
