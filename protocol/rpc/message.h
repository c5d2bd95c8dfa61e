// SPDX-License-Identifier: Apache-2.0
// Reads objects of messages.def from parsed JSON and writes them as JSON.
#pragma once

#include "rpc/message_table.h"

// Fills `to`, the C type of `object`, from the JSON object `value` at the reader's path. `strict`
// refuses members that are not in the table.
void cau_read_message(cau_reader *reader, const cJSON *value, cau_wire_object object, void *to,
                      bool strict);

// Refuses members that are not in the table of `object`.
void cau_refuse_unknown(cau_reader *reader, const cJSON *value, cau_wire_object object);

// Writes `from`, the C type of `object`. A value out of its range makes `place` fail, with the path
// of the value.
void cau_write_message(cau_json_writer *writer, const char *key, cau_wire_object object,
                       const void *from, cau_reader *place);
