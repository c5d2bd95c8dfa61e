// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon's certificate and key. A new pair is read, checked as a whole, and then replaces the
// old one in one step. Later handshakes use the new pair; existing connections keep theirs.
#pragma once

#include <openssl/ssl.h>

#include "cautery/status.h"
#include "config/config.h"

typedef struct cau_tls cau_tls;

// Reads the pair that the settings name; *tls is NULL if the settings name no pair. Errors (path
// tls_certificate or tls_key, and the file in `file`): CAU_IO: the file cannot be read;
// CAU_BAD_SYNTAX: the file contains no certificate or key, or a key with a passphrase;
// CAU_BAD_VALUE: the key does not belong to the certificate, or other users may read the key, or
// the certificate has expired.
cau_status cau_tls_create(cau_tls **tls, const cau_config *config, cau_error *error);
void cau_tls_destroy(cau_tls *tls); // `tls` may be NULL

// Reads the pair again. On failure the pair stays as it was. Any thread may call it.
cau_status cau_tls_reload(cau_tls *tls, const cau_config *config, cau_error *error);

// Sets up a context for TLS 1.2 and 1.3 as in Mozilla's intermediate profile. Each handshake uses
// the pair of that moment.
void cau_tls_configure(cau_tls *tls, SSL_CTX *context);
// The ciphers of TLS 1.2, for libwebsockets.
extern const char cau_tls_ciphers[];
