// SPDX-License-Identifier: GPL-3.0-or-later
// A table of what handshakes have proved about remote participants: by GUID, with the plugin's
// handles. Any thread may use it.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "dds_identity/identity.h"

// Notes that a participant wants to join. Forgets the proofs of an earlier participant with
// its GUID.
void cau_dds_proofs_meet(const uint8_t guid[16], int64_t identity);
// Notes that a handshake with the participant `identity` has begun.
void cau_dds_proofs_begin(int64_t identity, int64_t handshake);
// Notes that the handshake has proved that its participant owns the certificate `pem`.
void cau_dds_proofs_prove(int64_t handshake, const char *pem);
// Forgets the participant `identity`, which is gone.
void cau_dds_proofs_forget(int64_t identity);
bool cau_dds_proofs_find(const uint8_t guid[16], char subject[CAU_DDS_SUBJECT_BYTES]);
