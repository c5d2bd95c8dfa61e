// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the identity of a DDS participant: the subject name of its certificate, as DDS Security has
// proved it.
//
// Cyclone gives an application only the GUID of a remote participant. So this library is an
// authentication plugin around Cyclone's own, which does all the work. The plugin only notes which
// certificate each handshake has proved. It is a shared library, because Cyclone loads plugins from
// shared libraries; the daemon links it and reads the notes.
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct ddsi_domaingv;

enum { CAU_DDS_SUBJECT_BYTES = 256 };

// Returns the path of this library, for dds.sec.auth.library.path. The text is static; NULL if the
// path cannot be found.
const char *cau_dds_identity_library(void);

// Finds the subject name that the participant with this GUID has proved (in the form of RFC 2253,
// as in permissions: CN=knee-robot,O=Cautery). Returns false if the participant has proved no name,
// or a name that does not fit. Any thread may call it.
bool cau_dds_identity_find(const uint8_t guid[16], char subject[CAU_DDS_SUBJECT_BYTES]);

// The functions dds.sec.auth.library.init and .finalize, which Cyclone calls. `argument` is not
// used. They return 0.
int cau_dds_identity_init(const char *argument, void **context, struct ddsi_domaingv *domain);
int cau_dds_identity_finalize(void *context);

// ---- proofs
// A table of what handshakes have proved about remote participants: by GUID, with the plugin's
// handles. Any thread may use it.

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
