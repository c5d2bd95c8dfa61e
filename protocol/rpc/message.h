// SPDX-License-Identifier: Apache-2.0
// Objects of messages.def, read from parsed JSON and written as JSON.
#pragma once

#include "rpc/message_table.h"

// Fills `to`, the C type of `object`, from the JSON object `value` at the reader's place. `strict`
// refuses members that the table has not.
void cau_read_message(cau_reader *reader, const cJSON *value, cau_wire_object object, void *to,
                      bool strict);

// Refuses members that the table of `object` has not.
void cau_refuse_unknown(cau_reader *reader, const cJSON *value, cau_wire_object object);

// Writes `from`, the C type of `object`. Values out of their ranges fail in `place`, which says
// where.
void cau_write_message(cau_json_writer *writer, const char *key, cau_wire_object object,
                       const void *from, cau_reader *place);
