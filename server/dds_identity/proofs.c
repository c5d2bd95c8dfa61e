// SPDX-License-Identifier: GPL-3.0-or-later
#include "dds_identity/identity.h"

#include <openssl/pem.h>
#include <openssl/x509.h>
#include <pthread.h>
#include <string.h>

enum { PROOFS_MOST = 512, GUID_BYTES = 16 };

typedef struct proof {
	bool used;
	// the value of `meetings` when the proof was added; the oldest proof is replaced first
	uint64_t since;
	uint8_t guid[GUID_BYTES];
	int64_t identity, handshake;         // handles of the plugin; 0: no handle
	char subject[CAU_DDS_SUBJECT_BYTES]; // "" if not proved
} proof;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static proof proofs[PROOFS_MOST];
static uint64_t meetings;

// Returns the proof with this GUID, else a free entry, else the oldest proof. The participant of a
// replaced proof then counts as not proved.
static proof *place_for(const uint8_t guid[GUID_BYTES])
{
	proof *place = &proofs[0];
	for (int i = 0; i < PROOFS_MOST; i++) {
		if (proofs[i].used && memcmp(proofs[i].guid, guid, GUID_BYTES) == 0)
			return &proofs[i];
		if (place->used && (!proofs[i].used || proofs[i].since < place->since))
			place = &proofs[i];
	}
	return place;
}

void cau_dds_proofs_meet(const uint8_t guid[GUID_BYTES], int64_t identity)
{
	pthread_mutex_lock(&mutex);
	proof *met = place_for(guid);
	*met = (proof){.used = true, .since = ++meetings, .identity = identity};
	memcpy(met->guid, guid, GUID_BYTES);
	pthread_mutex_unlock(&mutex);
}

void cau_dds_proofs_begin(int64_t identity, int64_t handshake)
{
	pthread_mutex_lock(&mutex);
	for (int i = 0; i < PROOFS_MOST; i++)
		if (proofs[i].used && proofs[i].identity == identity)
			proofs[i].handshake = handshake;
	pthread_mutex_unlock(&mutex);
}

// Reads the certificate's subject name. Returns false if there is no certificate, or if the name is
// too long: a cut name must not pass for a shorter one.
static bool read_subject(const char *pem, char subject[CAU_DDS_SUBJECT_BYTES])
{
	BIO *from = BIO_new_mem_buf(pem, -1), *to = BIO_new(BIO_s_mem());
	X509 *certificate = from ? PEM_read_bio_X509(from, NULL, NULL, NULL) : NULL;
	char *text = NULL;
	long bytes = 0;
	if (certificate && to &&
	    X509_NAME_print_ex(to, X509_get_subject_name(certificate), 0, XN_FLAG_RFC2253) >= 0)
		bytes = BIO_get_mem_data(to, &text);
	bool fits = bytes > 0 && bytes < CAU_DDS_SUBJECT_BYTES;
	if (fits) {
		memcpy(subject, text, (size_t)bytes);
		subject[bytes] = 0;
	}
	X509_free(certificate);
	BIO_free(from);
	BIO_free(to);
	return fits;
}

void cau_dds_proofs_prove(int64_t handshake, const char *pem)
{
	char subject[CAU_DDS_SUBJECT_BYTES];
	if (!read_subject(pem, subject))
		return;
	pthread_mutex_lock(&mutex);
	for (int i = 0; i < PROOFS_MOST; i++)
		if (proofs[i].used && proofs[i].handshake == handshake)
			memcpy(proofs[i].subject, subject, sizeof subject);
	pthread_mutex_unlock(&mutex);
}

void cau_dds_proofs_forget(int64_t identity)
{
	pthread_mutex_lock(&mutex);
	for (int i = 0; i < PROOFS_MOST; i++)
		if (proofs[i].used && proofs[i].identity == identity)
			proofs[i] = (proof){0};
	pthread_mutex_unlock(&mutex);
}

bool cau_dds_proofs_find(const uint8_t guid[GUID_BYTES], char subject[CAU_DDS_SUBJECT_BYTES])
{
	bool found = false;
	pthread_mutex_lock(&mutex);
	for (int i = 0; i < PROOFS_MOST; i++)
		if (proofs[i].used && *proofs[i].subject && memcmp(proofs[i].guid, guid, GUID_BYTES) == 0) {
			memcpy(subject, proofs[i].subject, CAU_DDS_SUBJECT_BYTES);
			found = true;
		}
	pthread_mutex_unlock(&mutex);
	return found;
}
