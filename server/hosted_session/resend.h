// SPDX-License-Identifier: GPL-3.0-or-later
// Answers out of the store, for requests that were sent again.
#pragma once

#include "hosted_session/sink.h"

// Hands the stored answer `text` to who asks again. A client's sequence belongs to one method: if
// the answer is another's the asker gets CAU_RPC_SEQUENCE_CONFLICT.
void cau_resend_answer(const cau_reply *reply, const char *text, size_t text_bytes);
