// SPDX-License-Identifier: GPL-3.0-or-later
// What handshakes have proved: a table of remote participants, by GUID, with the handles that the
// plugin names them by. Any thread.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "dds_identity/identity.h"

// A participant wants to be let in. What was proved of another under its GUID is forgotten.
void cau_dds_proofs_meet(const uint8_t guid[16], int64_t identity);
// A handshake with it has begun.
void cau_dds_proofs_begin(int64_t identity, int64_t handshake);
// The handshake has proved that it has the certificate `pem`.
void cau_dds_proofs_prove(int64_t handshake, const char *pem);
// It is gone.
void cau_dds_proofs_forget(int64_t identity);
bool cau_dds_proofs_find(const uint8_t guid[16], char subject[CAU_DDS_SUBJECT_BYTES]);
