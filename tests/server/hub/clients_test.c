// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the values that a client gets: a number, a client_id that others may see, and a secret
// token that no other client may see.
#include "hub/hub.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum {
	CLIENTS = 100,
	// Fewest consecutive digits by which a text reveals a secret. Two random texts of 32 hex digits
	// share twelve consecutive digits by chance once in 10^11.
	SHARED_DIGITS = 12,
};

static char folder[] = "/tmp/cautery-clients-XXXXXX", file[64];
static cau_config config;
static cau_store *store;
static cau_worker_pool *pool;
static cau_hub *hub;

static int open_hub(void **state)
{
	(void)state;
	cau_store_config of_store = cau_store_default_config();
	cau_config_default(&config);
	if (!mkdtemp(folder))
		return -1;
	snprintf(file, sizeof file, "%s/store.db", folder);
	of_store.path = file;
	if (cau_store_open(&of_store, &store, NULL) || cau_worker_pool_create(&pool, 1, 1, 0, NULL))
		return -1;
	cau_hub_def def = {.config = &config, .store = store, .pool = pool};
	return cau_hub_create(&hub, &def, NULL) ? -1 : 0;
}

static int close_hub(void **state)
{
	(void)state;
	cau_hub_stop(hub);
	cau_hub_destroy(hub);
	cau_worker_pool_destroy(pool);
	cau_store_close(store);
	unlink(file);
	return rmdir(folder);
}

static cau_client attach_of(const char *owner, const char *client_id, const char *resume)
{
	uint64_t replaced;
	cau_client client = {0};
	strcpy(client.said_id, client_id);
	strcpy(client.owner, owner);
	assert_true(cau_hub_attach(hub, &client, resume, &replaced));
	return client;
}

static cau_client attach(const char *client_id, const char *resume)
{
	return attach_of("", client_id, resume);
}

// True if SHARED_DIGITS consecutive digits of the secret are in the text.
static bool tells_of(const char *text, const char *secret)
{
	char part[SHARED_DIGITS + 1] = {0};
	for (size_t i = 0; i + SHARED_DIGITS <= strlen(secret); i++) {
		memcpy(part, secret + i, SHARED_DIGITS);
		if (strstr(text, part))
			return true;
	}
	return false;
}

static void a_made_client_id_tells_nothing_of_the_secret(void **state)
{
	(void)state;
	for (int i = 0; i < CLIENTS; i++) {
		cau_client made = attach("", NULL);
		assert_int_equal(strlen(made.resume), CAU_RESUME_BYTES - 1);
		assert_true(strncmp(made.asker.client_id, "made-", 5) == 0);
		assert_false(tells_of(made.asker.client_id, made.resume));
	}
}

static void no_two_clients_are_given_the_same(void **state)
{
	(void)state;
	cau_client one = attach("", NULL), other = attach("", NULL);
	assert_string_not_equal(one.asker.client_id, other.asker.client_id);
	assert_string_not_equal(one.resume, other.resume);
	assert_int_not_equal(one.asker.client, other.asker.client);
}

static void who_resumes_keeps_number_and_id_and_gets_another_secret(void **state)
{
	(void)state;
	cau_client first = attach("", NULL);
	cau_client again = attach("", first.resume);
	assert_int_equal(again.asker.client, first.asker.client);
	assert_string_equal(again.asker.client_id, first.asker.client_id);
	assert_string_not_equal(again.resume, first.resume);
	assert_false(tells_of(again.asker.client_id, again.resume));
	assert_int_not_equal(attach("", first.resume).asker.client, first.asker.client);
}

static void a_client_id_that_is_said_stays(void **state)
{
	(void)state;
	cau_client client = attach("surgeon", NULL);
	assert_string_equal(client.asker.client_id, "surgeon");
	assert_string_equal(client.said_id, "surgeon");
	assert_int_not_equal(attach("", "").asker.client, client.asker.client);
}

// Stored answers are found by the client_id, so no two owners may have the same one.
static void client_ids_are_bound_to_their_owner(void **state)
{
	(void)state;
	const struct {
		const char *owner, *client_id;
	} cases[] = {{"CN=a", "robot"},
	             {"CN=b", "robot"},
	             {"CN=a", "robot2"},
	             {"CN=a", "x"},
	             {"CN=arobot", "x"}};
	enum { CASES = sizeof cases / sizeof cases[0] };
	cau_client of[CASES];
	for (int i = 0; i < CASES; i++) {
		of[i] = attach_of(cases[i].owner, cases[i].client_id, NULL);
		assert_string_equal(of[i].said_id, cases[i].client_id);
		assert_string_not_equal(of[i].asker.client_id, cases[i].client_id);
		for (int j = 0; j < i; j++)
			assert_string_not_equal(of[i].asker.client_id, of[j].asker.client_id);
	}
	cau_client again = attach_of("CN=a", "robot", NULL);
	assert_string_equal(again.asker.client_id, of[0].asker.client_id);
	cau_client made = attach_of("CN=a", "", NULL), said = attach_of("CN=a", made.said_id, NULL);
	assert_string_equal(said.asker.client_id, made.asker.client_id);
	assert_string_not_equal(attach_of("CN=b", made.said_id, NULL).asker.client_id,
	                        made.asker.client_id);
}

// The client has another token after a lost connection. A request that is sent again must still act
// once.
static void resuming_keeps_the_client_id_whoever_owns_the_token(void **state)
{
	(void)state;
	cau_client first = attach_of("name:a", "surgeon", NULL);
	cau_client same = attach_of("name:b", "surgeon", first.resume);
	assert_string_equal(same.asker.client_id, first.asker.client_id);
	cau_client silent = attach_of("name:c", "", same.resume);
	assert_string_equal(silent.asker.client_id, first.asker.client_id);
	assert_string_equal(silent.said_id, "surgeon");
	cau_client other = attach_of("name:c", "nurse", silent.resume);
	assert_string_equal(other.asker.client_id, attach_of("name:c", "nurse", NULL).asker.client_id);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_made_client_id_tells_nothing_of_the_secret),
		cmocka_unit_test(no_two_clients_are_given_the_same),
		cmocka_unit_test(who_resumes_keeps_number_and_id_and_gets_another_secret),
		cmocka_unit_test(a_client_id_that_is_said_stays),
		cmocka_unit_test(client_ids_are_bound_to_their_owner),
		cmocka_unit_test(resuming_keeps_the_client_id_whoever_owns_the_token),
	};
	return cmocka_run_group_tests(tests, open_hub, close_hub);
}
