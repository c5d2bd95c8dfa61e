// SPDX-License-Identifier: GPL-3.0-or-later
// Answers from the store to requests that were sent again.
#pragma once

#include "hosted_session/sink.h"

// Sends the stored answer `text` to the client that asks again. A client's sequence number belongs
// to one method. If the stored answer is of another method, the client receives
// CAU_RPC_SEQUENCE_CONFLICT.
void cau_resend_answer(const cau_reply *reply, const char *text, size_t text_bytes);
