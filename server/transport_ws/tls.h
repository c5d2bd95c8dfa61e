// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon's certificate and key. A pair is read, checked as a whole, and put in the place of the
// one before in one go: handshakes from then on use it, connections that are there keep theirs.
#pragma once

#include <openssl/ssl.h>

#include "cautery/status.h"
#include "config/config.h"

typedef struct cau_tls cau_tls;

// Reads the pair that the settings name; *tls is NULL if they name none. Errors (path
// tls_certificate or tls_key, the file in `file`): CAU_IO, it cannot be read; CAU_BAD_SYNTAX, it
// holds none, or a key behind a passphrase; CAU_BAD_VALUE, the key is another certificate's or
// others may read it, or the certificate has expired.
cau_status cau_tls_create(cau_tls **tls, const cau_config *config, cau_error *error);
void cau_tls_destroy(cau_tls *tls); // takes NULL

// Reads the pair anew. On failure the pair stays as it was. Any thread.
cau_status cau_tls_reload(cau_tls *tls, const cau_config *config, cau_error *error);

// TLS 1.2 and 1.3 as in Mozilla's intermediate profile, and for each handshake the pair of then.
void cau_tls_configure(cau_tls *tls, SSL_CTX *context);
// The ciphers of TLS 1.2, for libwebsockets.
extern const char cau_tls_ciphers[];
