// SPDX-License-Identifier: GPL-3.0-or-later
#include "dds_identity/identity.h"

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { PEM_BYTES = 4096, MORE_THAN_FIT = 600, LONG_PARTS = 5, PART_BYTES = 60 };

typedef struct participant {
	uint8_t guid[16];
} participant;

static participant numbered(int number)
{
	participant made = {{0x80, 1, 2, 3}};
	memcpy(made.guid + 8, &number, sizeof number);
	return made;
}

// Makes a certificate of this organisation, with this common name, and with the unit repeated
// `parts` times.
static const char *certificate(char pem[PEM_BYTES], const char *name, const char *unit, int parts)
{
	X509 *made = X509_new();
	EVP_PKEY *key = EVP_PKEY_Q_keygen(NULL, NULL, "EC", "P-256");
	X509_NAME *subject = X509_get_subject_name(made);
	BIO *to = BIO_new(BIO_s_mem());
	X509_NAME_add_entry_by_txt(subject, "O", MBSTRING_UTF8, (const unsigned char *)"Cautery", -1,
	                           -1, 0);
	for (int i = 0; i < parts; i++)
		assert_true(X509_NAME_add_entry_by_txt(subject, "OU", MBSTRING_UTF8,
		                                       (const unsigned char *)unit, -1, -1, 0));
	X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8, (const unsigned char *)name, -1, -1,
	                           0);
	X509_gmtime_adj(X509_getm_notBefore(made), 0);
	X509_gmtime_adj(X509_getm_notAfter(made), 60);
	X509_set_pubkey(made, key);
	assert_true(X509_sign(made, key, EVP_sha256()) > 0);
	assert_true(PEM_write_bio_X509(to, made));
	int bytes = BIO_read(to, pem, PEM_BYTES - 1);
	assert_true(bytes > 0);
	pem[bytes] = 0;
	X509_free(made);
	EVP_PKEY_free(key);
	BIO_free(to);
	return pem;
}

static void is(const participant *who, const char *subject)
{
	char found[CAU_DDS_SUBJECT_BYTES];
	assert_int_equal(cau_dds_proofs_find(who->guid, found), subject != NULL);
	if (subject)
		assert_string_equal(found, subject);
}

static void a_name_is_there_from_the_proof_to_the_end(void **state)
{
	(void)state;
	char pem[PEM_BYTES];
	participant robot = numbered(1), other = numbered(2);
	cau_dds_proofs_meet(robot.guid, 11);
	cau_dds_proofs_begin(11, 101);
	is(&robot, NULL);
	cau_dds_proofs_prove(101, certificate(pem, "knee-robot", "", 0));
	is(&robot, "CN=knee-robot,O=Cautery");
	is(&other, NULL);
	cau_dds_proofs_forget(11);
	is(&robot, NULL);
}

static void who_comes_under_a_guid_that_was_anothers_has_proved_nothing(void **state)
{
	(void)state;
	char pem[PEM_BYTES];
	participant robot = numbered(3);
	cau_dds_proofs_meet(robot.guid, 12);
	cau_dds_proofs_begin(12, 102);
	cau_dds_proofs_prove(102, certificate(pem, "chief", "", 0));
	is(&robot, "CN=chief,O=Cautery");
	cau_dds_proofs_meet(robot.guid, 13);
	is(&robot, NULL);
	// 102 is the handle of the earlier handshake.
	cau_dds_proofs_prove(102, pem);
	is(&robot, NULL);
	cau_dds_proofs_forget(13);
}

static void what_is_no_certificate_or_too_long_a_name_proves_nothing(void **state)
{
	(void)state;
	char pem[PEM_BYTES], unit[PART_BYTES + 1];
	participant robot = numbered(4);
	memset(unit, 'u', PART_BYTES);
	unit[PART_BYTES] = 0;
	cau_dds_proofs_meet(robot.guid, 14);
	cau_dds_proofs_begin(14, 104);
	cau_dds_proofs_prove(104, "-----BEGIN CERTIFICATE-----\nnone\n-----END CERTIFICATE-----\n");
	is(&robot, NULL);
	cau_dds_proofs_prove(104, certificate(pem, "robot", unit, LONG_PARTS));
	is(&robot, NULL);
	cau_dds_proofs_prove(104, certificate(pem, "a,b", "", 0));
	// a comma in a name is escaped, so it cannot look like two parts
	is(&robot, "CN=a\\,b,O=Cautery");
	cau_dds_proofs_forget(14);
}

static void beyond_what_fits_the_oldest_is_forgotten(void **state)
{
	(void)state;
	char pem[PEM_BYTES];
	certificate(pem, "one-of-many", "", 0);
	for (int i = 0; i < MORE_THAN_FIT; i++) {
		participant robot = numbered(1000 + i);
		cau_dds_proofs_meet(robot.guid, 1000 + i);
		cau_dds_proofs_begin(1000 + i, 5000 + i);
		cau_dds_proofs_prove(5000 + i, pem);
	}
	participant first = numbered(1000), last = numbered(1000 + MORE_THAN_FIT - 1);
	is(&first, NULL);
	is(&last, "CN=one-of-many,O=Cautery");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_name_is_there_from_the_proof_to_the_end),
		cmocka_unit_test(who_comes_under_a_guid_that_was_anothers_has_proved_nothing),
		cmocka_unit_test(what_is_no_certificate_or_too_long_a_name_proves_nothing),
		cmocka_unit_test(beyond_what_fits_the_oldest_is_forgotten),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
