// SPDX-License-Identifier: GPL-3.0-or-later
// Tests connecting, calling, losing the connection and reconnecting.
#include "clients/library/fixture.h"

// ---- hello -------------------------------------------------------------------------------------
typedef struct greeting {
	cau_wire_hello hello[4]; // hello of each connection
} greeting;

static bool note_hello(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	greeting *g = scripted_user(peer);
	(void)text;
	if (message->method == CAU_METHOD_HELLO)
		cau_rpc_params(message, &g->hello[scripted_number(peer) - 1], NULL);
	return false;
}

static void hello_says_who_we_are(void **state)
{
	(void)state;
	fixture f;
	greeting g = {0};
	fixture_begin(&f, &(scripted_script){.text = note_hello, .user = &g});
	f.def.token = "secret";
	f.def.client_id = "lasting";
	f.def.role = CAU_ROLE_VIEW;
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_string_equal(cau_client_server(f.client)->server, "scripted 1");
	assert_int_equal(cau_client_get_condition(f.client), CAU_CLIENT_READY);
	fixture_end(&f);
	assert_int_equal(g.hello[0].version, 1);
	assert_string_equal(g.hello[0].client, "test");
	assert_string_equal(g.hello[0].token, "secret");
	assert_string_equal(g.hello[0].client_id, "lasting");
	assert_true(g.hello[0].has_role);
	assert_int_equal(g.hello[0].role, CAU_ROLE_VIEW);
	assert_false(g.hello[0].has_resume);
}

static bool refuse_hello(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	(void)text;
	scripted_refuse(peer, message, CAU_RPC_UNAUTHORIZED, "unauthorized", "params.token",
	                "not known");
	scripted_close(peer, CAU_CLOSE_UNAUTHORIZED);
	return true;
}

static void a_refused_hello_says_why(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, &(scripted_script){.text = refuse_hello});
	f.def.reconnect = true; // the client must not reconnect after a refusal
	assert_int_not_equal(fixture_connect(&f), CAU_OK);
	assert_string_equal(f.error.path, "params.token");
	assert_non_null(strstr(f.error.reason, "not known"));
	assert_int_equal(cau_client_fault(f.client)->code, CAU_RPC_UNAUTHORIZED);
	assert_int_equal(cau_client_get_condition(f.client), CAU_CLIENT_CLOSED);
	fixture_end(&f);
}

static bool keep_silent(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	(void)peer;
	(void)message;
	(void)text;
	return true;
}

static void silence_ends_in_time(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, &(scripted_script){.text = keep_silent});
	f.def.timeout_s = 0.2;
	assert_int_equal(fixture_connect(&f), CAU_IO);
	assert_non_null(strstr(f.error.reason, "no answer to hello"));
	fixture_end(&f);
}

static void nobody_there_is_an_error(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, NULL);
	f.def.url = "ws://127.0.0.1:1";
	assert_int_equal(fixture_connect(&f), CAU_IO);
	assert_non_null(strstr(f.error.reason, "127.0.0.1 port 1"));
	assert_int_equal(cau_client_send(f.client, CAU_METHOD_SESSION_LIST, &(cau_wire_nothing){0},
	                                 NULL, NULL, &f.error),
	                 CAU_IO);
	fixture_end(&f);
}

static void a_url_that_is_none_is_refused(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, NULL);
	f.def.url = "localhost";
	assert_int_equal(cau_client_create(f.loop, &f.def, &f.client, &f.error), CAU_BAD_VALUE);
	assert_null(f.client);
	fixture_end(&f);
}

static void a_session_that_is_no_name_is_refused(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, NULL);
	f.def.session = "a\r\nX: y";
	assert_int_equal(cau_client_create(f.loop, &f.def, &f.client, &f.error), CAU_BAD_VALUE);
	assert_string_equal(f.error.path, "session");
	fixture_end(&f);
}

// ---- answers -----------------------------------------------------------------------------------
static bool refuse_pause(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	(void)text;
	if (message->method != CAU_METHOD_SESSION_PAUSE)
		return false;
	// these invalid messages must not disturb the client
	scripted_send(peer, false, "{\"no\": json", 11);
	scripted_send(peer, true, "neither frame nor chunk", 23);
	scripted_refuse(peer, message, CAU_RPC_NOT_FOUND, "not_found", "params.session", "no `t1-x`");
	return true;
}

static void an_error_answer_is_told_whole(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, &(scripted_script){.text = refuse_pause});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_wire_session_change params = {.has_session = true, .session = "t1-x"};
	assert_int_equal(cau_client_call(f.client, CAU_METHOD_SESSION_PAUSE, &params, NULL, &f.error),
	                 CAU_NOT_FOUND);
	assert_string_equal(f.error.path, "params.session");
	assert_non_null(strstr(f.error.reason, "no `t1-x`"));
	assert_int_equal(cau_client_fault(f.client)->code, CAU_RPC_NOT_FOUND);
	assert_int_equal(cau_client_get_condition(f.client), CAU_CLIENT_READY);
	fixture_end(&f);
}

static void params_out_of_range_never_leave(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, NULL);
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_wire_session_speed params = {.speed = 1e9};
	assert_int_equal(cau_client_call(f.client, CAU_METHOD_SESSION_SPEED, &params, NULL, &f.error),
	                 CAU_BAD_VALUE);
	assert_int_equal(cau_client_fault(f.client)->code, 0);
	fixture_end(&f);
}

static bool answer_nothing_but_hello(scripted_peer *peer, const cau_rpc_message *message,
                                     const char *text)
{
	(void)peer;
	(void)text;
	return message->method != CAU_METHOD_HELLO;
}

static void a_call_without_answer_ends_in_time(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, &(scripted_script){.text = answer_nothing_but_hello});
	f.def.timeout_s = 2; // timeout of the call, and of hello, which is answered at once
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_int_equal(cau_client_call(f.client, CAU_METHOD_SESSION_DESCRIBE,
	                                 &(cau_wire_session_ref){0}, NULL, &f.error),
	                 CAU_IO);
	assert_non_null(strstr(f.error.reason, "session.describe"));
	fixture_end(&f);
}

// A server that takes so long for a reset that two heartbeats arrive.
typedef struct long_work {
	cau_rpc_message reset;
	int heartbeats;
	bool deaf; // true if the server answers nothing after the first heartbeat
} long_work;

static bool work_long(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	long_work *work = scripted_user(peer);
	(void)text;
	if (message->method == CAU_METHOD_SESSION_RESET)
		work->reset = (cau_rpc_message){.id = message->id, .method = message->method};
	if (message->method == CAU_METHOD_HEARTBEAT && ++work->heartbeats == 2 && !work->deaf)
		scripted_result(peer, &work->reset, CAU_METHOD_SESSION_RESET,
		                &(cau_wire_restored){.tick = 0, .epoch = 7});
	return message->method == CAU_METHOD_SESSION_RESET || (work->deaf && work->heartbeats > 1);
}

static cau_status reset_of(long_work *work, fixture *f, cau_wire_restored *restored)
{
	fixture_begin(f, &(scripted_script){.text = work_long, .user = work});
	f->def.timeout_s = 0.5; // timeout of the call, of hello and of each heartbeat
	assert_int_equal(fixture_connect(f), CAU_OK);
	return cau_client_call(f->client, CAU_METHOD_SESSION_RESET, &(cau_wire_session_change){0},
	                       restored, &f->error);
}

static void what_costs_much_is_waited_for_while_the_server_is_heard(void **state)
{
	(void)state;
	fixture f;
	long_work work = {0};
	cau_wire_restored restored = {0};
	assert_int_equal(reset_of(&work, &f, &restored), CAU_OK);
	assert_int_equal(restored.epoch, 7);
	fixture_end(&f);
	assert_int_equal(work.heartbeats, 2); // the server's thread has ended, so the count is final
}

static void what_costs_much_ends_with_a_server_that_is_not_heard(void **state)
{
	(void)state;
	fixture f;
	long_work work = {.deaf = true};
	assert_int_equal(reset_of(&work, &f, NULL), CAU_IO);
	assert_non_null(strstr(f.error.reason, "session.reset"));
	fixture_end(&f);
	assert_int_equal(work.heartbeats, 2);
}

// ---- reconnecting ------------------------------------------------------------------------------
typedef struct breaking {
	greeting greeting;
	char energize[2][512]; // the request on each connection
	int close_code;
} breaking;

// Cuts the first connection when it receives tool.energize; answers on the second connection.
static bool cut_once(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	breaking *b = scripted_user(peer);
	int number = scripted_number(peer);
	if (message->method == CAU_METHOD_HELLO)
		cau_rpc_params(message, &b->greeting.hello[number - 1], NULL);
	if (message->method == CAU_METHOD_TOOL_ENERGIZE && number <= 2) {
		snprintf(b->energize[number - 1], sizeof b->energize[0], "%s", text);
		if (number == 1)
			scripted_close(peer, b->close_code);
		else
			scripted_result(peer, message, CAU_METHOD_TOOL_ENERGIZE,
			                &(cau_wire_command_result){.tick = 9, .sequence = 3});
		return true;
	}
	return message->method == CAU_METHOD_SESSION_PAUSE;
}

static cau_command energize(void)
{
	return (cau_command){
		.kind = CAU_COMMAND_TOOL_ENERGIZE, .sequence = 3, .tool = "hook", .as.energized = 1};
}

static void note_error(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	assert_null(answer);
	*(cau_status *)user = error->status;
}

static void a_lost_connection_resumes_and_resends_what_acts_once(void **state)
{
	(void)state;
	fixture f;
	breaking b = {0};
	cau_command command = energize();
	cau_wire_command_result result = {0};
	cau_status pause_status = CAU_OK;
	fixture_begin(&f, &(scripted_script){.text = cut_once, .user = &b});
	f.def.reconnect = true;
	assert_int_equal(fixture_connect(&f), CAU_OK);
	// A request without client_sequence may or may not have acted. So it fails and is not resent.
	assert_int_equal(cau_client_send(f.client, CAU_METHOD_SESSION_PAUSE,
	                                 &(cau_wire_session_change){0}, note_error, &pause_status,
	                                 &f.error),
	                 CAU_OK);
	assert_int_equal(cau_client_command(f.client, "t1-x", &command, &result, &f.error), CAU_OK);
	assert_int_equal(result.tick, 9);
	assert_int_equal(pause_status, CAU_IO);
	assert_int_equal(cau_client_connections(f.client), 2);
	fixture_end(&f);
	assert_string_equal(b.greeting.hello[1].resume, "resume-1");
	assert_string_equal(b.greeting.hello[1].client_id, "made-up");
	assert_string_equal(b.energize[0], b.energize[1]);
	assert_non_null(strstr(b.energize[0], "\"client_sequence\":1"));
}

static void without_reconnect_a_loss_is_final_and_says_so(void **state)
{
	(void)state;
	fixture f;
	breaking b = {.close_code = CAU_CLOSE_TOO_SLOW};
	cau_command command = energize();
	fixture_begin(&f, &(scripted_script){.text = cut_once, .user = &b});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_int_equal(cau_client_command(f.client, "t1-x", &command, NULL, &f.error), CAU_IO);
	assert_non_null(strstr(f.error.reason, "tool.energize"));
	assert_int_equal(cau_client_get_condition(f.client), CAU_CLIENT_CLOSED);
	assert_non_null(strstr(cau_client_trouble(f.client)->reason, "4004"));
	fixture_end(&f);
}

static void some_close_codes_mean_it(void **state)
{
	(void)state;
	fixture f;
	breaking b = {.close_code = CAU_CLOSE_RESUMED};
	cau_command command = energize();
	fixture_begin(&f, &(scripted_script){.text = cut_once, .user = &b});
	f.def.reconnect = true;
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_int_equal(cau_client_command(f.client, "t1-x", &command, NULL, &f.error), CAU_IO);
	assert_int_equal(cau_client_get_condition(f.client), CAU_CLIENT_CLOSED);
	fixture_end(&f);
}

// ---- heartbeats --------------------------------------------------------------------------------
static bool count_heartbeats(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	(void)text;
	if (message->method == CAU_METHOD_HEARTBEAT && message->kind == CAU_RPC_NOTIFICATION)
		atomic_fetch_add((atomic_int *)scripted_user(peer), 1);
	return false;
}

static void heartbeats_are_sent_while_wanted(void **state)
{
	(void)state;
	fixture f;
	atomic_int heartbeats = 0;
	fixture_begin(&f, &(scripted_script){.text = count_heartbeats, .user = &heartbeats});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_client_keep_alive(f.client, true);
	FIXTURE_AWAIT(&f, atomic_load(&heartbeats) >= 3);
	fixture_end(&f);
}

static void the_clock_is_measured(void **state)
{
	(void)state;
	fixture f;
	cau_client_clock clock = {0};
	fixture_begin(&f, NULL);
	assert_int_equal(fixture_connect(&f), CAU_OK);
	double before_s = cau_client_now();
	assert_int_equal(cau_client_measure_clock(f.client, 4, &clock, &f.error), CAU_OK);
	double after_s = cau_client_now();
	// The scripted server's clock always shows 1 us.
	assert_true(clock.offset_s > 1e-6 - after_s && clock.offset_s < 1e-6 - before_s);
	assert_true(clock.error_s > 0 && clock.error_s < after_s - before_s);
	fixture_end(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(hello_says_who_we_are),
		cmocka_unit_test(a_refused_hello_says_why),
		cmocka_unit_test(silence_ends_in_time),
		cmocka_unit_test(nobody_there_is_an_error),
		cmocka_unit_test(a_url_that_is_none_is_refused),
		cmocka_unit_test(a_session_that_is_no_name_is_refused),
		cmocka_unit_test(an_error_answer_is_told_whole),
		cmocka_unit_test(params_out_of_range_never_leave),
		cmocka_unit_test(a_call_without_answer_ends_in_time),
		cmocka_unit_test(what_costs_much_is_waited_for_while_the_server_is_heard),
		cmocka_unit_test(what_costs_much_ends_with_a_server_that_is_not_heard),
		cmocka_unit_test(a_lost_connection_resumes_and_resends_what_acts_once),
		cmocka_unit_test(without_reconnect_a_loss_is_final_and_says_so),
		cmocka_unit_test(some_close_codes_mean_it),
		cmocka_unit_test(heartbeats_are_sent_while_wanted),
		cmocka_unit_test(the_clock_is_measured),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
