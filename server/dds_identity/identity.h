// SPDX-License-Identifier: GPL-3.0-or-later
// Who is behind a participant, as DDS Security has proved it: the subject name of its certificate.
//
// Cyclone tells an application no more of a remote participant than its GUID. So this is an
// authentication plugin around Cyclone's own, which does all the work: it only notes whose
// certificate the handshake with which participant has proved. A shared library, since Cyclone
// loads plugins from one; the daemon links it and asks.
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct ddsi_domaingv;

enum { CAU_DDS_SUBJECT_BYTES = 256 };

// Where this library is: to be given as dds.sec.auth.library.path. Static; NULL: not to be found.
const char *cau_dds_identity_library(void);

// The subject name (RFC 2253, as permissions name it: CN=knee-robot,O=Cautery) that the participant
// with this GUID has proved to have. False: it has proved none, or has one that does not fit. Any
// thread.
bool cau_dds_identity_find(const uint8_t guid[16], char subject[CAU_DDS_SUBJECT_BYTES]);

// For Cyclone: dds.sec.auth.library.init and .finalize. `argument` is not used. 0: done.
int cau_dds_identity_init(const char *argument, void **context, struct ddsi_domaingv *domain);
int cau_dds_identity_finalize(void *context);
