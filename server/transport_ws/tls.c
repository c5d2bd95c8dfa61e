// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_ws/internal.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "config/config.h"

enum { CHAIN_MOST = 16 };

typedef struct pair {
	X509 *certificate;
	STACK_OF(X509) * chain; // the chain of certificates up to an authority
	EVP_PKEY *key;
} pair;

struct cau_tls {
	pthread_mutex_t mutex; // guards `pair`
	pair pair;
};

// The ciphers of Mozilla's intermediate profile for TLS 1.2, without those that need DH parameters.
// The ciphers of TLS 1.3 are OpenSSL's.
const char cau_tls_ciphers[] =
	"ECDHE-ECDSA-AES128-GCM-SHA256:ECDHE-RSA-AES128-GCM-SHA256:ECDHE-ECDSA-AES256-GCM-SHA384:"
	"ECDHE-RSA-AES256-GCM-SHA384:ECDHE-ECDSA-CHACHA20-POLY1305:ECDHE-RSA-CHACHA20-POLY1305";
static const char groups[] = "X25519:P-256:P-384";

// ---- reading
static cau_status fail_file(cau_error *error, cau_status status, const char *setting,
                            const char *file, const char *reason)
{
	ERR_clear_error();
	if (error)
		snprintf(error->file, sizeof error->file, "%.255s", file);
	return cau_fail(error, status, setting, "%s", reason);
}

static void forget(pair *p)
{
	X509_free(p->certificate);
	sk_X509_pop_free(p->chain, X509_free);
	EVP_PKEY_free(p->key);
	*p = (pair){0};
}

static cau_status read_certificate(pair *p, const char *file, cau_error *error)
{
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *stream = cau_named_file_open(file, CAU_NAMED_FILE_BYTES, NULL, reason);
	if (!stream)
		return fail_file(error, CAU_IO, "tls_certificate", file, reason);
	p->certificate = PEM_read_X509_AUX(stream, NULL, NULL, NULL);
	p->chain = sk_X509_new_null();
	X509 *next = NULL;
	while (p->certificate && p->chain && sk_X509_num(p->chain) < CHAIN_MOST &&
	       (next = PEM_read_X509(stream, NULL, NULL, NULL)) && sk_X509_push(p->chain, next))
		next = NULL;
	X509_free(next); // frees a certificate that could not be added
	fclose(stream);
	ERR_clear_error(); // OpenSSL reports the end of the file as an error
	if (!p->certificate || !p->chain || next)
		return fail_file(error, CAU_BAD_SYNTAX, "tls_certificate", file,
		                 "the file has no certificate in PEM");
	return CAU_OK;
}

// Refuses to give a passphrase: the daemon has no user to ask.
static int no_passphrase(char *buffer, int size, int writing, void *user)
{
	(void)buffer, (void)size, (void)writing, (void)user;
	return -1;
}

static cau_status read_key(pair *p, const char *file, cau_error *error)
{
	struct stat info;
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *stream = cau_named_file_open(file, CAU_NAMED_FILE_BYTES, &info, reason);
	if (!stream)
		return fail_file(error, CAU_IO, "tls_key", file, reason);
	bool open_to_all = (info.st_mode & S_IRWXO) != 0;
	if (!open_to_all)
		p->key = PEM_read_PrivateKey(stream, NULL, no_passphrase, NULL);
	fclose(stream);
	if (open_to_all)
		return fail_file(error, CAU_BAD_VALUE, "tls_key", file,
		                 "other users can read the file: chmod 600 or 640");
	if (!p->key)
		return fail_file(error, CAU_BAD_SYNTAX, "tls_key", file,
		                 "the file has no private key in PEM, or the key has a passphrase");
	return CAU_OK;
}

static cau_status check_pair(const pair *p, const cau_config *config, cau_error *error)
{
	if (X509_check_private_key(p->certificate, p->key) != 1)
		return fail_file(error, CAU_BAD_VALUE, "tls_key", config->tls_key,
		                 "the key does not belong to the certificate");
	if (X509_cmp_current_time(X509_get0_notAfter(p->certificate)) < 0)
		return fail_file(error, CAU_BAD_VALUE, "tls_certificate", config->tls_certificate,
		                 "the certificate has expired");
	return CAU_OK;
}

static cau_status read_pair(pair *p, const cau_config *config, cau_error *error)
{
	*p = (pair){0};
	cau_status status = read_certificate(p, config->tls_certificate, error);
	if (!status)
		status = read_key(p, config->tls_key, error);
	if (!status)
		status = check_pair(p, config, error);
	if (status)
		forget(p);
	return status;
}

// ---- the pair in use
cau_status cau_tls_create(cau_tls **made, const cau_config *config, cau_error *error)
{
	*made = NULL;
	if (!*config->tls_certificate)
		return CAU_OK;
	cau_tls *tls = calloc(1, sizeof *tls);
	if (!tls)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for TLS");
	pthread_mutex_init(&tls->mutex, NULL);
	cau_status status = read_pair(&tls->pair, config, error);
	if (status)
		cau_tls_destroy(tls);
	else
		*made = tls;
	return status;
}

void cau_tls_destroy(cau_tls *tls)
{
	if (!tls)
		return;
	forget(&tls->pair);
	pthread_mutex_destroy(&tls->mutex);
	free(tls);
}

cau_status cau_tls_reload(cau_tls *tls, const cau_config *config, cau_error *error)
{
	pair now, before;
	cau_status status = read_pair(&now, config, error);
	if (status)
		return status;
	pthread_mutex_lock(&tls->mutex);
	before = tls->pair;
	tls->pair = now;
	pthread_mutex_unlock(&tls->mutex);
	forget(&before); // handshakes that use the old pair hold references to it
	return CAU_OK;
}

static int give_pair(SSL *ssl, void *user)
{
	cau_tls *tls = user;
	pthread_mutex_lock(&tls->mutex);
	const pair *p = &tls->pair;
	int given = SSL_use_cert_and_key(ssl, p->certificate, p->key, p->chain, 1);
	pthread_mutex_unlock(&tls->mutex);
	return given;
}

void cau_tls_configure(cau_tls *tls, SSL_CTX *context)
{
	SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
	SSL_CTX_set1_groups_list(context, groups);
	// The client's order of ciphers is used, because clients know best which cipher is fast on
	// their processor. Tickets are off, because they would outlive a key.
	SSL_CTX_clear_options(context, SSL_OP_CIPHER_SERVER_PREFERENCE);
	SSL_CTX_set_options(context,
	                    SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION | SSL_OP_NO_TICKET);
	SSL_CTX_set_cert_cb(context, give_pair, tls);
}
