// SPDX-License-Identifier: GPL-3.0-or-later
// What commands share: results and exit codes, options, the connection to a daemon, and the words
// of the protocol.
#include "cautery/cli.h"

#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/message_choices.h"
#include "cautery/name.h"
#include "cautery/nearest.h"

enum { SESSIONS_MAX = 4096 };

// ---- complaints and exit codes -----------------------------------------------------------------
void cli_complain(const cli *c, const char *format, ...)
{
	va_list arguments;
	fprintf(c->complaints, "cautery%s%s: ", c->command ? " " : "",
	        c->command ? c->command->name : "");
	va_start(arguments, format);
	vfprintf(c->complaints, format, arguments);
	va_end(arguments);
	fputc('\n', c->complaints);
}

void cli_complain_unknown(const cli *c, const char *what, const char *word,
                          const char *const *words, size_t count)
{
	const char *meant = cau_nearest(word, words, count);
	if (meant)
		cli_complain(c, "no %s \"%s\"; did you mean \"%s\"? --help lists them", what, word, meant);
	else
		cli_complain(c, "no %s \"%s\"; --help lists them", what, word);
}

static void print_error_json(const cli *c)
{
	char text[2048];
	cau_json_writer writer;
	cau_json_begin(&writer, text, sizeof text, 0);
	cau_json_open(&writer, NULL, '{');
	cau_json_open(&writer, "error", '{');
	cau_json_string(&writer, "status", cau_status_name(c->error.status));
	cau_json_string(&writer, "file", c->error.file);
	cau_json_string(&writer, "path", c->error.path);
	cau_json_string(&writer, "reason", c->error.reason);
	cau_json_close(&writer);
	cau_json_close(&writer);
	if (!cau_json_end(&writer, NULL, NULL))
		fprintf(c->out, "%s\n", text);
}

static void tell_error(const cli *c)
{
	const cau_error *e = &c->error;
	if (c->json)
		print_error_json(c);
	cli_complain(c, "%s%s%s%s%s", e->file, *e->file ? ": " : "", e->path, *e->path ? ": " : "",
	             *e->reason ? e->reason : cau_status_sentence(e->status));
}

cli_exit cli_fail(cli *c)
{
	tell_error(c);
	bool answered = c->client && cau_client_fault(c->client)->code != 0;
	return answered ? CLI_REFUSED : c->error.status == CAU_BAD_VALUE ? CLI_USAGE : CLI_CONNECTION;
}

cli_exit cli_fail_file(cli *c)
{
	tell_error(c);
	return CLI_FILE;
}

static volatile sig_atomic_t interrupted;

static void note_signal(int number)
{
	(void)number;
	interrupted = 1;
}

void cli_watch_signals(void)
{
	struct sigaction action = {.sa_handler = note_signal, .sa_flags = (int)SA_RESETHAND};
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

bool cli_interrupted(void)
{
	return interrupted;
}

// ---- options -----------------------------------------------------------------------------------
bool cli_read_number(const cli *c, const char *what, const char *text, double least, double most,
                     double *value)
{
	char *end;
	*value = strtod(text, &end);
	if (end != text && !*end && *value >= least && *value <= most)
		return true;
	cli_complain(c, "%s needs a number from %g to %g, not \"%s\"", what, least, most, text);
	return false;
}

const char *cli_value(const cli *c, const char *option)
{
	for (int i = 0; i < CLI_OPTIONS_MAX && c->command->options[i].name; i++)
		if (strcmp(c->command->options[i].name, option) == 0)
			return c->values[i];
	return NULL;
}

double cli_number(const cli *c, const char *option, double least, double most, double otherwise,
                  bool *bad)
{
	char what[64];
	double value = otherwise;
	const char *text = cli_value(c, option);
	snprintf(what, sizeof what, "--%s", option);
	if (text && !cli_read_number(c, what, text, least, most, &value))
		*bad = true;
	return value;
}

// ---- connection --------------------------------------------------------------------------------
typedef struct cli_daemon {
	char url[CLI_CONTEXT_TEXT_BYTES];
	char token[CAU_CLIENT_TOKEN_BYTES]; // "" if there is none
} cli_daemon;

static cli_exit read_token(cli *c, const char *file, cli_daemon *daemon)
{
	return cau_client_read_token(file, daemon->token, &c->error) ? cli_fail_file(c) : CLI_DONE;
}

// Chooses the daemon's only session, for a command line that names no session.
static cli_exit only_session(cli *c)
{
	cli_exit code = CLI_DONE;
	cau_wire_session_list list = {
		.sessions = {calloc(SESSIONS_MAX, sizeof(cau_wire_session_summary)), 0, SESSIONS_MAX}};
	cau_wire_session_summary *all = list.sessions.items;
	if (!all)
		return cli_fail_memory(c);
	if (cau_client_call(c->client, CAU_METHOD_SESSION_LIST, &(cau_wire_nothing){0}, &list,
	                    &c->error)) {
		code = cli_fail(c);
	} else if (list.sessions.count != 1) {
		cli_complain(c, "the daemon has %d sessions: name one of them (cautery ls lists them)",
		             list.sessions.count);
		code = CLI_USAGE;
	} else {
		memcpy(c->session, all[0].session, sizeof c->session);
	}
	free(all);
	return code;
}

static cli_exit choose_session(cli *c)
{
	if (!c->command->session_optional)
		return CLI_DONE;
	// An argument beyond the command's minimum is the session.
	if (c->argument_count <= c->command->least)
		return only_session(c);
	snprintf(c->session, sizeof c->session, "%s", c->arguments[0]);
	c->argument_count--;
	memmove(c->arguments, c->arguments + 1, (size_t)c->argument_count * sizeof *c->arguments);
	return CLI_DONE;
}

// Returns the URL of the daemon. --url comes first, then --context, then CAUTERYD_URL, then the
// current context. The caller leaves `context` empty unless the context applies.
static const char *choose_url(const cli *c, const cli_context *context)
{
	const char *url = getenv("CAUTERYD_URL");
	if (c->url)
		return c->url;
	if (*context->url)
		return context->url;
	return url && !c->context ? url : CAU_CLIENT_DEFAULT_URL;
}

static cli_exit find_daemon(cli *c, cli_daemon *daemon)
{
	cli_context context = {0};
	const char *token = getenv("CAUTERYD_TOKEN");
	// A context's token is only for the context's own daemon.
	bool told = c->url || (getenv("CAUTERYD_URL") && !c->context);
	if ((c->context || !told) && cli_context_find(c->context, &context, &c->error))
		return cli_fail_file(c);
	snprintf(daemon->url, sizeof daemon->url, "%s", choose_url(c, &context));
	const char *file = c->token_file ? c->token_file : context.token_file;
	if (*file)
		return read_token(c, file, daemon);
	snprintf(daemon->token, sizeof daemon->token, "%s", token ? token : "");
	return CLI_DONE;
}

// Returns the session that the command line names, or NULL.
static const char *named_session(const cli *c)
{
	const cli_command *command = c->command;
	bool named = command->session_optional
	                 ? c->argument_count > command->least
	                 : c->argument_count > 0 && strncmp(command->arguments, "SESSION", 7) == 0;
	return named ? c->arguments[0] : NULL;
}

cli_exit cli_connect_to(cli *c, const char *session, const char *label)
{
	cli_daemon daemon = {0};
	cli_finish(c);
	cli_exit found = find_daemon(c, &daemon);
	if (found)
		return found;
	// A proxy in front of several daemons routes by the session. The daemon refuses an invalid
	// name.
	c->def.session = session && cau_name_is_valid(session) ? session : NULL;
	c->def.label = label;
	// Commands reuse this definition for other connections after this function has returned. So the
	// strings must outlive it.
	memcpy(c->daemon_url, daemon.url, sizeof daemon.url);
	memcpy(c->token, daemon.token, sizeof daemon.token);
	c->def.url = c->daemon_url;
	c->def.token = *c->token ? c->token : NULL;
	c->def.timeout_s = c->timeout_s;
	if (cau_loop_create(&c->loop, &c->error) ||
	    cau_client_create(c->loop, &c->def, &c->client, &c->error) ||
	    cau_client_connect(c->client, &c->error))
		return cli_fail(c);
	return CLI_DONE;
}

cli_exit cli_find_fleet(cli *c, cau_fleet *fleet)
{
	cli_daemon daemon = {0};
	cli_finish(c);
	cli_exit found = find_daemon(c, &daemon);
	if (found)
		return found;
	if (cau_loop_create(&c->loop, &c->error) ||
	    cau_client_find_fleet(c->loop, daemon.url, c->timeout_s, fleet, &c->error))
		found = cli_fail(c);
	cli_finish(c);
	return found;
}

cli_exit cli_connect(cli *c)
{
	if (c->label && strchr(c->label, ',')) {
		cli_complain(c, "--label takes one label here; only `ls` takes several");
		return CLI_USAGE;
	}
	cli_exit code = cli_connect_to(c, named_session(c), c->label);
	return code ? code : choose_session(c);
}

void cli_finish(cli *c)
{
	if (c->client)
		cau_client_close(c->client);
	cau_client_destroy(c->client);
	cau_loop_destroy(c->loop);
	c->client = NULL;
	c->loop = NULL;
}

// ---- results -----------------------------------------------------------------------------------
void cli_print_result(const cli *c, cau_method method, const void *result)
{
	// The message tables write a whole JSON-RPC answer. Only its member "result" is printed.
	static const char member[] = "\"result\":";
	cau_rpc_id id = {.kind = CAU_RPC_ID_NONE};
	cau_rpc_buffer out = {NULL, 0, 0};
	cau_rpc_write_result(&out, &id, method, result, NULL);
	out.capacity = out.bytes + 1;
	out.buffer = malloc(out.capacity);
	if (out.buffer && !cau_rpc_write_result(&out, &id, method, result, NULL)) {
		const char *start = strstr(out.buffer, member);
		if (start)
			fprintf(c->out, "%.*s\n", (int)(strlen(start) - sizeof member),
			        start + sizeof member - 1);
	}
	free(out.buffer);
}

cli_exit cli_call(cli *c, cau_method method, const void *params, void *result)
{
	if (cau_client_call(c->client, method, params, result, &c->error))
		return cli_fail(c);
	if (c->json)
		cli_print_result(c, method, result ? result : &(cau_wire_nothing){0});
	return CLI_DONE;
}

// ---- words -------------------------------------------------------------------------------------
#define X(code, word) word,
static const char *const states[] = {CAU_SESSION_STATE_TABLE(X)};
static const char *const layers[] = {CAU_LAYER_TABLE(X)};
static const char *const reasons[] = {CAU_ENERGY_OFF_TABLE(X)};
static const char *const events[] = {CAU_EVENT_TABLE(X)};
#undef X
#define X(code, word, ...) #word,
static const char *const shapes[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X

#define WORD(table, index)                                                                         \
	((uint32_t)(index) < sizeof(table) / sizeof *(table) ? (table)[(uint32_t)(index)] : "?")

const char *cli_state_word(int32_t state)
{
	return WORD(states, state);
}

const char *cli_layer_word(int32_t kind)
{
	return WORD(layers, kind);
}

const char *cli_shape_word(int32_t shape)
{
	return WORD(shapes, shape);
}

const char *cli_energy_off_word(int32_t reason)
{
	return WORD(reasons, reason);
}

const char *cli_event_word(int32_t kind)
{
	return WORD(events, kind);
}

int32_t cli_shape_of_word(const char *word)
{
	for (int32_t i = 0; i < CAU_TOOL_SHAPE_COUNT; i++)
		if (strcmp(word, shapes[i]) == 0)
			return i;
	return -1;
}
