// SPDX-License-Identifier: GPL-3.0-or-later
// The command `run`: sends a script's commands at their ticks, counted from the present tick.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/command_json.h"
#include "cautery/progress.h"

enum {
	SCRIPT_BYTES_MAX = 1 << 28,
	LEAD_TICKS = 8, // largest number of ticks from sending a command to the tick at which it acts
	// largest number of unanswered requests; the server keeps as many commands of a client for
	// later ticks
	OUTSTANDING_MAX = 64,
	TOLD_MAX = 10, // largest number of refusals that are printed
};

typedef struct script_line {
	cau_command command; // its tick counts from the start of the script
	int32_t line;
} script_line;

typedef struct runner runner;

// A sent command, so that its answer can be matched with its line.
typedef struct sent {
	runner *r;
	int32_t line;
	uint64_t tick; // tick at which the command should act
} sent;

struct runner {
	cli *c;
	cau_client_stream *stream;
	script_line *lines;
	int32_t count, capacity;
	sent *sent;
	uint64_t base_tick, epoch;
	cli_faces faces;
	int32_t next, answered, refused, late, watchdog_cuts;
	bool lost; // The connection was lost, which ended the script.
};

// ---- script ------------------------------------------------------------------------------------
static cau_status add_line(runner *r, const cau_command *command, int32_t line, cau_error *error)
{
	if (r->count == r->capacity) {
		int32_t capacity = r->capacity ? 2 * r->capacity : 256;
		void *grown = realloc(r->lines, (size_t)capacity * sizeof *r->lines);
		if (!grown)
			return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the script");
		r->lines = grown;
		r->capacity = capacity;
	}
	r->lines[r->count++] = (script_line){*command, line};
	return CAU_OK;
}

static cau_status read_script(runner *r, const char *file)
{
	char *text;
	size_t bytes;
	bool end = false;
	cau_script script;
	cau_error *error = &r->c->error;
	cau_status status = cli_read_file(file, SCRIPT_BYTES_MAX, &text, &bytes, error);
	if (status)
		return status;
	cau_script_begin(&script, file, text, bytes);
	while (!status && !end) {
		cau_command command;
		status = cau_script_next(&script, &command, &end, error);
		if (!status && !end)
			status = add_line(r, &command, script.line, error);
	}
	if (!status && r->count == 0)
		status = cau_fail(error, CAU_BAD_VALUE, NULL, "the script has no command");
	if (!status && r->count > 0)
		r->sent = calloc((size_t)r->count, sizeof *r->sent);
	if (!status && !r->sent)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the script");
	snprintf(error->file, sizeof error->file, "%.255s", status ? file : "");
	free(text);
	return status;
}

// ---- driving -----------------------------------------------------------------------------------
// Takes over the tools that the script drives and does not add itself.
static cli_exit take_tools(runner *r)
{
	for (int32_t i = 0; i < r->count; i++) {
		const cau_command *command = &r->lines[i].command;
		if (command->kind == CAU_COMMAND_TOOL_ADD || !*command->tool)
			continue;
		cli_exit code = cli_take(r->c, r->stream, command->tool);
		if (code)
			return code;
	}
	return CLI_DONE;
}

static void take_answer(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	const sent *s = user;
	runner *r = s->r;
	cau_wire_command_result result = {0};
	r->answered++;
	if (answer) {
		if (!cau_rpc_result(answer, CAU_METHOD_TOOL_MOVE, &result, NULL))
			r->late += (uint64_t)result.tick > s->tick;
		return;
	}
	if (cau_client_get_condition(r->c->client) != CAU_CLIENT_READY) {
		r->lost = true; // the loss is reported once, at the end
		return;
	}
	if (r->refused++ < TOLD_MAX)
		cli_complain(r->c, "line %d: %s%s%s", s->line, error->path, *error->path ? ": " : "",
		             error->reason);
}

static bool uses_tool(const runner *r, const char *tool)
{
	for (int32_t i = 0; i < r->count; i++)
		if (strcmp(r->lines[i].command.tool, tool) == 0)
			return true;
	return false;
}

// Warns that the watchdog turned energy off. The script's motion continues without energy.
static void take_notification(void *user, cau_client *client, const cau_rpc_message *message)
{
	runner *r = user;
	cau_wire_event_notice notice = {0};
	(void)client;
	if (message->method != CAU_METHOD_EVENT || cau_rpc_params(message, &notice, NULL) ||
	    notice.event.kind != CAU_EVENT_WATCHDOG || strcmp(notice.session, r->c->session) != 0 ||
	    !uses_tool(r, notice.event.tool))
		return;
	r->watchdog_cuts++;
	cli_complain(r->c, "tick %lld: the watchdog turned off the energy of `%s`: %s",
	             (long long)notice.event.tick, notice.event.tool, notice.event.detail);
}

// Sends the commands that are due within LEAD_TICKS. A command without a sequence in the script
// gets its line number.
static cau_status send_due(runner *r)
{
	uint64_t horizon = r->stream->state->tick + LEAD_TICKS;
	while (r->next < r->count && r->next - r->answered < OUTSTANDING_MAX) {
		const script_line *line = &r->lines[r->next];
		cau_command command = line->command;
		command.tick += r->base_tick;
		if (command.tick > horizon)
			break;
		if (!command.sequence)
			command.sequence = (uint64_t)line->line;
		sent *s = &r->sent[r->next];
		*s = (sent){r, line->line, command.tick};
		cau_status status = cau_client_send_command(r->c->client, r->c->session, &command,
		                                            take_answer, s, &r->c->error);
		if (status)
			return status;
		r->next++;
	}
	return CAU_OK;
}

static bool is_over(const runner *r)
{
	return r->next == r->count && r->answered == r->count &&
	       r->stream->state->tick >= r->base_tick + r->lines[r->count - 1].command.tick;
}

// Returns why the script cannot continue, or NULL.
static const char *trouble(const runner *r)
{
	const cau_stream_state *state = r->stream->state;
	if (r->stream->ended)
		return "the session no longer exists";
	if (state->synced && state->epoch != r->epoch)
		return "the session was rewound or restarted, so the script's ticks no longer apply";
	if (state->flags & CAU_FRAME_FAULTED)
		return "the session is faulted: rewind or reset it";
	return NULL;
}

static void show_progress(runner *r, cli_progress *progress)
{
	char note[128];
	const cau_stream_state *state = r->stream->state;
	cli_faces_count(&r->faces, state, r->stream->def.face_count);
	uint64_t done = state->tick > r->base_tick ? state->tick - r->base_tick : 0;
	uint64_t total = r->lines[r->count - 1].command.tick + 1;
	snprintf(note, sizeof note, "tick %llu, %lld faces gone, %u edges parted%s",
	         (unsigned long long)state->tick, (long long)r->faces.gone,
	         state->statistics.edges_parted, state->flags & CAU_FRAME_PAUSED ? ", paused" : "");
	cli_progress_show(progress, done < total ? done : total, total, note);
}

static cli_exit play(runner *r)
{
	cli *c = r->c;
	cli_progress progress;
	const char *reason = NULL;
	cau_status status = CAU_OK;
	cli_progress_begin(&progress, c->complaints, "running");
	while (!status && !is_over(r) && !(reason = trouble(r)) && !cli_interrupted() &&
	       cau_client_get_condition(c->client) == CAU_CLIENT_READY) {
		status = send_due(r);
		show_progress(r, &progress);
		if (!status)
			cau_loop_wait(c->loop, 0.25);
	}
	cli_progress_end(&progress);
	if (cau_client_get_condition(c->client) != CAU_CLIENT_READY) {
		c->error = *cau_client_trouble(c->client);
		cli_complain(c, "stopped after %d of %d commands", r->next, r->count);
		return cli_fail(c);
	}
	if (status)
		return cli_fail(c);
	if (reason || cli_interrupted()) {
		cli_complain(c, "stopped after %d of %d commands: %s", r->next, r->count,
		             reason ? reason : "interrupted");
		return reason ? CLI_REFUSED : CLI_INCOMPLETE;
	}
	return r->refused || r->watchdog_cuts ? CLI_INCOMPLETE : CLI_DONE;
}

static void print_end(runner *r)
{
	const cau_stream_state *state = r->stream->state;
	cli_faces_count(&r->faces, state, r->stream->def.face_count);
	if (r->c->json)
		fprintf(r->c->out,
		        "{\"session\": \"%s\", \"commands\": %d, \"sent\": %d, \"refused\": %d, "
		        "\"late\": %d, \"watchdog_cuts\": %d, \"first_tick\": %llu, \"last_tick\": %llu, "
		        "\"faces_gone\": %lld, "
		        "\"edges_parted\": %u, \"elements_removed\": %u}\n",
		        r->c->session, r->count, r->next, r->refused, r->late, r->watchdog_cuts,
		        (unsigned long long)r->base_tick, (unsigned long long)state->tick,
		        (long long)r->faces.gone, state->statistics.edges_parted,
		        state->statistics.elements_removed);
	else
		fprintf(r->c->out,
		        "%s: %d commands, %d refused, %d late, ticks %llu to %llu, %lld faces gone\n",
		        r->c->session, r->next, r->refused, r->late, (unsigned long long)r->base_tick,
		        (unsigned long long)state->tick, (long long)r->faces.gone);
}

static cli_exit join_and_play(runner *r)
{
	cli *c = r->c;
	cli_exit code = cli_join_tools(c, &r->stream);
	if (!code && r->stream->state->flags & CAU_FRAME_PAUSED) {
		cli_complain(c, "%s is paused: cautery resume %s", c->session, c->session);
		return CLI_REFUSED;
	}
	if (!code)
		code = take_tools(r);
	if (code)
		return code;
	cau_client_keep_alive(c->client, true);
	r->epoch = r->stream->state->epoch;
	r->base_tick = r->stream->state->tick + LEAD_TICKS;
	cli_faces_count(&r->faces, r->stream->state, r->stream->def.face_count);
	code = play(r);
	print_end(r);
	return code;
}

static cli_exit run(cli *c)
{
	runner r = {.c = c};
	cli_exit code = CLI_DONE;
	if (read_script(&r, c->arguments[c->argument_count - 1]))
		code = cli_fail_file(c);
	cli_watch_signals();
	c->def.user = &r;
	// A move turns energy off, so the rest of the script would no longer act as written.
	c->def.follow = false;
	c->def.on_notification = take_notification;
	if (!code)
		code = cli_connect(c);
	if (!code)
		code = join_and_play(&r);
	// Closes the connection first, because a later answer would use the freed script.
	if (c->client)
		cau_client_close(c->client);
	cli_faces_finish(&r.faces);
	free(r.lines);
	free(r.sent);
	return code;
}

const cli_command cli_run = {
	.name = "run",
	.arguments = "[SESSION] SCRIPT",
	.summary = "runs a script of commands at their ticks, counted from now",
	.help =
		"SCRIPT has one command as JSON on each line, as `cautery log` and\n"
		"`cautery-sim --print-cut` write them; - reads standard input.\n"
		"First the command takes over the tools that the script uses. In the output, late is the\n"
		"number of commands that reached the server after their tick. watchdog_cuts is the number\n"
		"of times that energy went off because this command was silent for too long.\n",
	.least = 1,
	.most = 1,
	.session_optional = true,
	.run = run};
