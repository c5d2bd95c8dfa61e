// SPDX-License-Identifier: GPL-3.0-or-later
// The command `move`: carries a session from one daemon to another. The two daemons do not talk to
// each other: this program is the courier between them. It may be killed at any moment. The same
// command then completes the move.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/name.h"
#include "cautery/progress.h"

enum { MOVES_MOST = 1024, PIECE_FLAGS_AT = 12, PART_ENDS = 1, ENDS = 2, HEAD_BYTES = 16 };

typedef struct courier {
	cli *c;
	cau_client *to; // connection to the target daemon; c->client is connected to the source
	const char *label;
	// the move, with the session's id on the source (`from_ref`) and on the target (`to_ref`)
	cau_wire_move_ref from_ref, to_ref;
	bool exact;
	double bytes;
	bool arrives;     // the target daemon has at least one piece
	char receipt[65]; // receipt of the last delivered piece
	double stood_s;   // time at which the session was suspended, s
	char token[CAU_CLIENT_TOKEN_BYTES];
} courier;

static cli_exit fail_to(courier *m)
{
	cli_complain(m->c, "error with the target daemon %s:", m->label);
	return cli_fail(m->c);
}

static cau_status ask_from(courier *m, cau_method method, void *result)
{
	return cau_client_call(m->c->client, method, &m->from_ref, result, &m->c->error);
}

static cau_status ask_to(courier *m, cau_method method, void *result)
{
	return cau_client_call(m->to, method, &m->to_ref, result, &m->c->error);
}

// ---- connecting ---------------------------------------------------------------------------------

static cli_exit check_label(courier *m, const char *session)
{
	size_t bytes = strlen(m->label);
	if (!cau_name_is_valid(m->label) || strchr(m->label, '-')) {
		cli_complain(m->c, "`%s` is not a label of a daemon", m->label);
		return CLI_USAGE;
	}
	if (strncmp(session, m->label, bytes) == 0 && session[bytes] == '-') {
		cli_complain(m->c, "%s is on %s already", session, m->label);
		return CLI_USAGE;
	}
	return CLI_DONE;
}

// Makes the session's id on the target daemon: the new label, then --name or the part after the old
// label.
static cli_exit name_target(courier *m, const char *session)
{
	char text[2 * CAU_NAME_BYTES];
	const char *name = cli_value(m->c, "name"), *dash = strchr(session, '-');
	snprintf(text, sizeof text, "%.48s-%.48s", m->label, name ? name : dash ? dash + 1 : session);
	if (!cau_name_is_valid(text) || strlen(text) >= CAU_NAME_BYTES) {
		cli_complain(m->c,
		             "`%s` is not a valid name: %s, at most %d bytes; give another with --name",
		             text, CAU_NAME_RULE, CAU_NAME_BYTES - 1);
		return CLI_USAGE;
	}
	snprintf(m->from_ref.session, sizeof m->from_ref.session, "%s", session);
	memcpy(m->to_ref.session, text, sizeof m->to_ref.session);
	return CLI_DONE;
}

static cli_exit check_daemon(courier *m, cau_client *client, const char *option)
{
	const char *daemon = cau_client_server(client)->daemon;
	if (strcmp(daemon, m->label) == 0)
		return CLI_DONE;
	cli_complain(m->c, "this is the daemon `%s`: give the address of `%s` with %s", daemon, option,
	             m->label);
	return CLI_USAGE;
}

static cli_exit connect_target(courier *m)
{
	cli *c = m->c;
	const char *url = cli_value(c, "to-url"), *file = cli_value(c, "to-token-file");
	cau_client_def def = c->def;
	if (file && cau_client_read_token(file, m->token, &c->error))
		return cli_fail_file(c);
	if (file)
		def.token = m->token;
	if (url)
		def.url = url;
	def.session = NULL;
	// Without --to-url, one proxy leads to both daemons, and the label chooses the target.
	def.label = url ? NULL : m->label;
	if (cau_client_create(c->loop, &def, &m->to, &c->error) || cau_client_connect(m->to, &c->error))
		return fail_to(m);
	return check_daemon(m, m->to, "--to-url");
}

// ---- deciding -----------------------------------------------------------------------------------

// Gives the target daemon the proof that the session is its own. If no answer comes, the same
// command completes the move.
static cli_exit deliver(courier *m, const char *proof)
{
	cau_wire_move_accept params = {0};
	memcpy(params.session, m->to_ref.session, sizeof params.session);
	memcpy(params.move, m->to_ref.move, sizeof params.move);
	snprintf(params.proof, sizeof params.proof, "%s", proof);
	if (!cau_client_call(m->to, CAU_METHOD_MOVE_ACCEPT, &params, NULL, &m->c->error))
		return CLI_DONE;
	cli_complain(m->c,
	             "the session belongs to %s, which does not serve it yet: run the same command "
	             "again to finish the move",
	             m->label);
	return fail_to(m);
}

static cli_exit tell_moved(courier *m)
{
	cli *c = m->c;
	if (c->json)
		fprintf(c->out, "{\"session\":\"%s\",\"exact\":%s}\n", m->to_ref.session,
		        m->exact ? "true" : "false");
	else
		fprintf(c->out, "%s is now %s\n", m->from_ref.session, m->to_ref.session);
	return CLI_DONE;
}

// Makes the target remove the pieces of the move. `release` comes from the source. NULL means that
// the source is lost.
static cli_exit forget(courier *m, const char *release)
{
	cau_wire_move_forget params = {.has_release = release != NULL,
	                               .has_source_lost = release == NULL,
	                               .source_lost = release == NULL};
	memcpy(params.session, m->to_ref.session, sizeof params.session);
	memcpy(params.move, m->to_ref.move, sizeof params.move);
	snprintf(params.release, sizeof params.release, "%s", release ? release : "");
	if (cau_client_call(m->to, CAU_METHOD_MOVE_FORGET, &params, NULL, &m->c->error))
		return fail_to(m);
	return CLI_DONE;
}

// Asks the source about the outcome of the move. Passes the outcome to the target if the target
// knows the move. *moved is true if the session now belongs to the target.
static cli_exit settle(courier *m, bool known_there, bool *moved)
{
	cau_wire_move_decision decision = {0};
	*moved = false;
	if (ask_from(m, CAU_METHOD_MOVE_CANCEL, &decision))
		return cli_fail(m->c);
	*moved = decision.moved;
	if (decision.moved)
		return deliver(m, decision.proof);
	return known_there ? forget(m, decision.release) : CLI_DONE;
}

// Finds the unfinished move of this session in the list of `client`'s daemon. If there is none,
// found->move is "". `id` is the session's id on that daemon. If `id` is "", `other` is the
// session's id on the other daemon.
static cau_status find_move(courier *m, cau_client *client, const char *id, const char *other,
                            cau_wire_move_entry *found)
{
	cau_wire_move_list list = {
		.moves = {calloc(MOVES_MOST, sizeof(cau_wire_move_entry)), 0, MOVES_MOST}};
	const cau_wire_move_entry *entries = list.moves.items;
	*found = (cau_wire_move_entry){0};
	if (!entries)
		return cau_fail(&m->c->error, CAU_NO_MEMORY, "", "no memory for the list of moves");
	cau_status status =
		cau_client_call(client, CAU_METHOD_MOVE_LIST, &(cau_wire_nothing){0}, &list, &m->c->error);
	for (int32_t i = 0; !status && i < list.moves.count; i++)
		if (strcmp(*id ? entries[i].session : entries[i].other, *id ? id : other) == 0 &&
		    strcmp(entries[i].state, "gone") != 0)
			*found = entries[i];
	free(list.moves.items);
	return status;
}

static void take_move(courier *m, const cau_wire_move_entry *found)
{
	memcpy(m->to_ref.session, found->session, sizeof m->to_ref.session);
	memcpy(m->to_ref.move, found->move, sizeof m->to_ref.move);
	memcpy(m->from_ref.move, found->move, sizeof m->from_ref.move);
}

// Completes the move that an earlier courier left unfinished. If that courier died before the
// target had a piece, only the source knows the move.
static cli_exit settle_earlier(courier *m, bool *moved)
{
	cau_wire_move_entry found;
	*moved = false;
	if (find_move(m, m->to, "", m->from_ref.session, &found))
		return fail_to(m);
	if (*found.move) {
		take_move(m, &found);
		return settle(m, true, moved);
	}
	if (!cli_value(m->c, "cancel"))
		return CLI_DONE;
	if (find_move(m, m->c->client, m->from_ref.session, "", &found))
		return cli_fail(m->c);
	memcpy(m->from_ref.move, found.move, sizeof m->from_ref.move);
	return *found.move ? settle(m, false, moved) : CLI_DONE;
}

// The source is lost, so the target removes its part of the session.
static cli_exit give_up(courier *m)
{
	cau_wire_move_entry found;
	cli_exit code = cli_connect_to(m->c, NULL, m->label);
	if (!code)
		code = check_daemon(m, m->c->client, "--url");
	if (code)
		return code;
	m->to = m->c->client; // The caller of this command closes the connection.
	if (find_move(m, m->to, "", m->from_ref.session, &found))
		return cli_fail(m->c);
	if (!*found.move) {
		cli_complain(m->c, "%s has no unfinished move of %s", m->label, m->from_ref.session);
		return CLI_REFUSED;
	}
	take_move(m, &found);
	return forget(m, NULL);
}

// ---- carrying -----------------------------------------------------------------------------------

static cli_exit carry_piece(courier *m, unsigned *flags)
{
	cli *c = m->c;
	unsigned char *bytes = NULL;
	cau_wire_transfer transfer = {0};
	cau_wire_upload_result uploaded = {0};
	cau_wire_move_receive receive = {.upload = "piece"};
	cau_wire_move_received received = {0};
	if (cau_client_download(c->client, CAU_METHOD_MOVE_READ, &m->from_ref, NULL, NULL, &transfer,
	                        &bytes, &c->error))
		return cli_fail(c);
	size_t count = (size_t)transfer.byte_count;
	*flags = count >= HEAD_BYTES ? bytes[PIECE_FLAGS_AT] : 0;
	m->bytes += (double)count;
	memcpy(receive.session, m->to_ref.session, sizeof receive.session);
	memcpy(receive.move, m->to_ref.move, sizeof receive.move);
	cau_status status = cau_client_upload(m->to, "piece", "piece.caum", bytes, count, NULL, NULL,
	                                      &uploaded, &c->error);
	if (!status)
		status = cau_client_call(m->to, CAU_METHOD_MOVE_RECEIVE, &receive, &received, &c->error);
	m->arrives = m->arrives || !status;
	if (!status && received.has_receipt)
		memcpy(m->receipt, received.receipt, sizeof m->receipt);
	free(bytes);
	return status ? fail_to(m) : CLI_DONE;
}

static cli_exit carry_until(courier *m, unsigned flag)
{
	unsigned flags = 0;
	cli_exit code = CLI_DONE;
	while (!code && !(flags & flag))
		code = carry_piece(m, &flags);
	return code;
}

static cli_exit begin(courier *m)
{
	cau_wire_move_begin params = {0};
	cau_wire_move_begun result = {0};
	const char *url = cli_value(m->c, "to-url");
	memcpy(params.session, m->from_ref.session, sizeof params.session);
	memcpy(params.target, m->to_ref.session, sizeof params.target);
	snprintf(params.label, sizeof params.label, "%s", m->label);
	params.has_url = url != NULL;
	snprintf(params.url, sizeof params.url, "%s", url ? url : "");
	if (cau_client_call(m->c->client, CAU_METHOD_MOVE_BEGIN, &params, &result, &m->c->error))
		return cli_fail(m->c);
	memcpy(m->from_ref.move, result.move, sizeof m->from_ref.move);
	memcpy(m->to_ref.move, result.move, sizeof m->to_ref.move);
	return CLI_DONE;
}

static cli_exit prepare(courier *m)
{
	cau_wire_move_held ready = {0};
	cli_exit code = carry_until(m, PART_ENDS);
	if (code)
		return code;
	if (ask_to(m, CAU_METHOD_MOVE_READY, &ready))
		return fail_to(m);
	m->exact = ready.has_exact && ready.exact;
	if (m->exact || cli_value(m->c, "inexact"))
		return CLI_DONE;
	cli_complain(
		m->c,
		"%s is another build, or its processor has another instruction set. Its results "
		"would differ in the last digits. To move the session all the same, give --inexact",
		m->label);
	return CLI_REFUSED;
}

static cli_exit hand_over(courier *m)
{
	cau_wire_move_held held = {0};
	cau_wire_move_decision decision = {0};
	cau_wire_move_commit commit = {0};
	m->stood_s = cau_client_now();
	if (ask_from(m, CAU_METHOD_MOVE_HOLD, &held))
		return cli_fail(m->c);
	cli_exit code = carry_until(m, ENDS);
	if (code)
		return code;
	memcpy(commit.session, m->from_ref.session, sizeof commit.session);
	memcpy(commit.move, m->from_ref.move, sizeof commit.move);
	memcpy(commit.receipt, m->receipt, sizeof commit.receipt);
	if (cau_client_call(m->c->client, CAU_METHOD_MOVE_COMMIT, &commit, &decision, &m->c->error))
		return cli_fail(m->c);
	code = deliver(m, decision.proof);
	if (!code && !m->c->json)
		fprintf(m->c->complaints, "%s was suspended for %.3f s at tick %lld; %.1f MB moved%s\n",
		        m->from_ref.session, cau_client_now() - m->stood_s, (long long)held.tick,
		        m->bytes * 1e-6, m->exact ? "" : ", not bit-exact");
	return code;
}

static cli_exit move(courier *m)
{
	bool moved = false;
	cli_exit code = settle_earlier(m, &moved);
	if (!code && moved)
		return tell_moved(m);
	if (code || cli_value(m->c, "cancel"))
		return code;
	code = begin(m);
	if (code)
		return code;
	code = prepare(m);
	if (!code)
		code = hand_over(m);
	if (!code)
		return tell_moved(m);
	// The target may have the session already, if only an answer was lost.
	cli_exit settled = settle(m, m->arrives, &moved);
	return !settled && moved ? tell_moved(m) : code;
}

static cli_exit run(cli *c)
{
	courier m = {.c = c, .label = c->arguments[1], .exact = true};
	const char *session = c->arguments[0];
	// Neither connection may follow the session to the other daemon.
	c->def.follow = false;
	cli_exit code = check_label(&m, session);
	if (!code)
		code = name_target(&m, session);
	if (!code && cli_value(c, "source-lost"))
		return give_up(&m);
	if (!code)
		code = cli_connect(c);
	if (!code)
		code = connect_target(&m);
	if (!code)
		code = move(&m);
	if (m.to)
		cau_client_close(m.to);
	cau_client_destroy(m.to);
	return code;
}

const cli_command cli_move = {
	.name = "move",
	.arguments = "SESSION LABEL",
	.summary = "moves a session to the daemon LABEL; needs role admin on both",
	.help =
		"Behind a proxy one address leads to both daemons; otherwise --to-url is the address of\n"
		"LABEL. First the history is copied while the session runs. Then the session is\n"
		"suspended, with energy off, until the rest is copied and LABEL serves it. Clients that\n"
		"use the old id are sent there. If this command is killed, run it again to finish the\n"
		"move. --cancel ends it: the session stays where it is, unless it has moved already.\n"
		"If the daemon that has SESSION is gone for good, --source-lost with LABEL's address as\n"
		"--url removes what LABEL has of an unfinished move. If the other daemon had decided the\n"
		"move, the session is lost then.\n",
	.least = 2,
	.most = 2,
	.options = {{"to-url", "U", "address of the daemon LABEL for clients"},
                {"to-token-file", "F", "access token for that daemon (default: the same token)"},
                {"name", "NAME", "name of the session on the target (default: unchanged)"},
                {"inexact", NULL, "move also to another build or instruction set, not bit-exact"},
                {"cancel", NULL, "cancel an unfinished move of this session"},
                {"source-lost", NULL,
                 "LABEL forgets an unfinished move, without asking the other daemon"},
                {0}},
	.run = run};
