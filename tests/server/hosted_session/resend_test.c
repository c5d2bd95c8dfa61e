// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/sink.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

typedef struct heard {
	int answers;
	const char *text;
	int32_t code;
	cau_error error;
} heard;

static void hear(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	heard *h = user;
	(void)reply;
	h->answers++;
	h->text = outcome->text;
	h->code = outcome->code;
	if (outcome->error)
		h->error = *outcome->error;
}

static heard resent(cau_method method, const char *text)
{
	heard h = {0};
	cau_reply reply = {.answer = hear, .user = &h, .method = method};
	cau_resend_answer(&reply, text, strlen(text));
	assert_int_equal(h.answers, 1);
	return h;
}

static void an_answer_goes_to_its_own_method(void **state)
{
	(void)state;
	const char *text = "{\"jsonrpc\":\"2.0\",\"id\":\"session.pause\",\"result\":{}}";
	assert_ptr_equal(resent(CAU_METHOD_SESSION_PAUSE, text).text, text);
	heard other = resent(CAU_METHOD_SESSION_RESUME, text);
	assert_null(other.text);
	assert_int_equal(other.code, CAU_RPC_SEQUENCE_CONFLICT);
	assert_string_equal(other.error.path, "params.client_sequence");
	assert_non_null(strstr(other.error.reason, "session.pause"));
}

static void an_answer_of_an_older_version_names_no_method_and_goes_to_any(void **state)
{
	(void)state;
	const char *text = "{\"jsonrpc\":\"2.0\",\"id\":0,\"result\":{\"id\":\"x\"}}";
	assert_ptr_equal(resent(CAU_METHOD_SESSION_PAUSE, text).text, text);
	assert_ptr_equal(resent(CAU_METHOD_SESSION_CREATE, text).text, text);
}

static void a_damaged_answer_is_handed_over_as_it_is(void **state)
{
	(void)state;
	// the id has no end, so it names no method
	const char *open = "{\"jsonrpc\":\"2.0\",\"id\":\"session.pause";
	assert_ptr_equal(resent(CAU_METHOD_SESSION_RESUME, open).text, open);
	assert_string_equal(resent(CAU_METHOD_SESSION_RESUME, "").text, "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_answer_goes_to_its_own_method),
		cmocka_unit_test(an_answer_of_an_older_version_names_no_method_and_goes_to_any),
		cmocka_unit_test(a_damaged_answer_is_handed_over_as_it_is),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
