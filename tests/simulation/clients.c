// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated clients: their connections, requests and heartbeats.
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/promises.h"
#include "simulation/world.h"

// interval of heartbeats: a fifth of the deadline, as the protocol says
#define BEAT_NS (50 * SIM_MS)

enum { CLOCK_BYTES = 48 };

sim_client sim_clients[CLIENTS + COURIERS];
sim_request sim_requests[REQUESTS_MOST];
int sim_request_count;
sim_session sim_sessions[SESSIONS];
const char *const sim_tools[TOOLS] = {"hook", "probe"};

static sim_random random_delays;
static int64_t latency_most_ns;
static bool have_tokens;

// The clients' tokens, the same as in the daemons' file `tokens`.
static const struct {
	const char *token;
	bool looks;  // the role is view
	int session; // the only session allowed; -1: all sessions
	int quota;   // expensive requests a minute; 0: no quota
} owners[CLIENTS] = {
	{"the-token-of-client-0-and-the-courier", false, -1, 0},
	{"the-token-of-client-1", false, -1, 0},
	{"the-token-of-client-2", false, 0, 1},
	{"the-token-of-client-3", true, -1, 0},
};

void clients_begin(uint64_t seed, const sim_profile *profile)
{
	memset(sim_sessions, 0, sizeof sim_sessions);
	sim_request_count = 0;
	random_delays = sim_random_of(seed, 5);
	latency_most_ns = profile->latency_most_ns;
	have_tokens = profile->tokens;
	for (int i = 0; i < CLIENTS + COURIERS; i++) {
		sim_client *c = &sim_clients[i];
		*c = (sim_client){.index = i, .visible = true};
		c->clocked = sim_chance(&random_delays, 2);
		c->clock_ahead_ns = sim_between(&random_delays, -900, 900) * SIM_SECOND;
		snprintf(c->client_id, sizeof c->client_id, "client%d", i);
	}
}

static int64_t delay(const sim_client *c)
{
	int64_t late_ns = c->late_until_ns - sim_now();
	return sim_between(&random_delays, 50000, latency_most_ns) + (late_ns > 0 ? late_ns : 0);
}

// ---- names
void sim_session_name(int place, char name[NAME_MOST])
{
	snprintf(name, NAME_MOST, "s%d_%d", place, sim_sessions[place].life);
}

void sim_session_id(int place, int machine, char id[NAME_MOST])
{
	char name[NAME_MOST];
	sim_session_name(place, name);
	snprintf(id, NAME_MOST, "%s-%.40s", daemons_label(machine), name);
}

int sim_session_of(const char *id)
{
	const char *dash = strchr(id, '-');
	for (int i = 0; dash && i < SESSIONS; i++) {
		char name[NAME_MOST];
		sim_session_name(i, name);
		if (strcmp(dash + 1, name) == 0)
			return i;
	}
	return -1;
}

// ---- requests
sim_request *clients_request(uint64_t number)
{
	assert(number >= 1 && number <= (uint64_t)sim_request_count);
	return &sim_requests[number - 1];
}

static void send_request(sim_client *c, uint64_t number)
{
	char text[2048], id[NAME_MOST], session[NAME_MOST + 16] = "", sequence[48] = "";
	sim_request *r = clients_request(number);
	if (r->session >= 0 && r->what != ASK_CREATE) {
		sim_session_id(r->session, c->machine, id);
		snprintf(session, sizeof session, "\"session\":\"%s\"", id);
	}
	if (r->sequence)
		snprintf(sequence, sizeof sequence, "%s\"client_sequence\":%lld", *session ? "," : "",
		         (long long)r->sequence);
	bool members = *session || *sequence;
	int bytes =
		snprintf(text, sizeof text,
	             "{\"jsonrpc\":\"2.0\",\"id\":%llu,\"method\":\"%s\",\"params\":{%s%s%s%s}}",
	             (unsigned long long)number, r->method, session, sequence,
	             members && *r->params ? "," : "", r->params);
	assert(bytes < (int)sizeof text);
	r->sent_ns = sim_now();
	r->connection = c->connection;
	r->machine = c->machine;
	sim_say("client %d sends %s", c->index, text);
	sim_link_send(c->link, text, (size_t)bytes, false, number, delay(c));
}

static uint64_t make_request(sim_client *c, const sim_request *like)
{
	assert(sim_request_count < REQUESTS_MOST);
	sim_requests[sim_request_count] = *like;
	sim_requests[sim_request_count].client = c->index;
	return (uint64_t)++sim_request_count;
}

uint64_t clients_ask(int index, ask what, const char *method, int place, int tool, bool changes,
                     const char *params)
{
	sim_client *c = &sim_clients[index];
	if (!c->link)
		return 0;
	sim_request like = {.what = what,
	                    .session = place,
	                    .tool = tool,
	                    .life = place >= 0 ? sim_sessions[place].life : 0,
	                    .sequence = changes ? ++c->sequence : 0,
	                    .method = strdup(method),
	                    .params = strdup(params)};
	uint64_t number = make_request(c, &like);
	if (changes)
		c->newest = number;
	send_request(c, number);
	return number;
}

// Resends the newest request that changes something, as a client does after a lost connection.
void clients_send_again(int index)
{
	sim_client *c = &sim_clients[index];
	if (!c->link || !c->newest)
		return;
	const sim_request *old = clients_request(c->newest);
	if (old->session >= 0 && old->life != sim_sessions[old->session].life)
		return;
	if (old->what == ASK_CREATE && old->machine != c->machine)
		// Another daemon would create another session.
		return;
	sim_request like = {.what = old->what,
	                    .session = old->session,
	                    .tool = old->tool,
	                    .life = old->life,
	                    .sequence = old->sequence,
	                    .gravity = old->gravity,
	                    .later = old->later,
	                    .first = old->first ? old->first : c->newest,
	                    .method = old->method,
	                    .params = old->params};
	send_request(c, make_request(c, &like));
}

void clients_notify(int index, const char *method, const char *params)
{
	char text[512];
	const sim_client *c = &sim_clients[index];
	if (!c->link)
		return;
	int bytes = snprintf(text, sizeof text,
	                     "{\"jsonrpc\":\"2.0\",\"method\":\"%s\",\"params\":{%s}}", method, params);
	sim_link_send(c->link, text, (size_t)bytes, false, 0, delay(c));
}

// ---- tokens
static const char *token_of(const sim_client *c)
{
	return owners[c->index < CLIENTS ? c->index : 0].token;
}

bool clients_may(int client, ask what, int place)
{
	if (!have_tokens || client >= CLIENTS)
		return true;
	bool reads = what == ASK_HELLO || what == ASK_JOIN || what == ASK_KEY_FRAME ||
	             // Some of the requests of the kind OTHER only read.
	             what == ASK_LIST || what == ASK_OTHER;
	bool there = place < 0 || owners[client].session < 0 || owners[client].session == place;
	return (reads || !owners[client].looks) && there;
}

int clients_quota(int client)
{
	return have_tokens && client < CLIENTS ? owners[client].quota : 0;
}

// ---- connections
void clients_connect(int index, int machine)
{
	char params[256];
	sim_client *c = &sim_clients[index];
	if (c->link || !daemons_up(machine))
		return;
	c->late_until_ns = 0;
	c->link = sim_link_open(machine, c, delay(c));
	if (!c->link)
		return;
	if (c->machine != machine)
		c->resume[0] = 0;
	c->machine = machine;
	c->connection++;
	c->greeted = c->clock_counts = false;
	c->beats = c->visible = c->reads = true;
	c->reads_ns = sim_now();
	c->beat_ns = sim_now();
	int at = snprintf(params, sizeof params,
	                  "\"version\":1,\"client\":\"simulated %d\",\"client_id\":\"%s\"", index,
	                  c->client_id);
	if (have_tokens)
		at += snprintf(params + at, sizeof params - (size_t)at, ",\"token\":\"%s\"", token_of(c));
	if (c->resume[0])
		snprintf(params + at, sizeof params - (size_t)at, ",\"resume\":\"%s\"", c->resume);
	clients_ask(index, ASK_HELLO, "hello", -1, -1, false, params);
}

void clients_cut(int index)
{
	sim_client *c = &sim_clients[index];
	if (c->link)
		sim_link_cut(c->link);
}

void clients_show(int index, bool visible)
{
	sim_clients[index].visible = visible;
	sim_clients[index].beat_ns = sim_now();
}

// Delays the client's messages, but only if the daemon already knows the client's clock. Otherwise
// nothing shows how long the client's first message travelled.
void clients_late(int index, int64_t ns)
{
	sim_client *c = &sim_clients[index];
	if (c->link && c->clock_counts == c->clocked)
		c->late_until_ns = sim_now() + ns;
}

void clients_read(int index, bool reads, int frames)
{
	sim_client *c = &sim_clients[index];
	if (!c->link)
		return;
	c->reads_ns = reads && !c->reads ? sim_now() : c->reads_ns;
	c->reads = reads;
	sim_link_read(c->link, reads, frames);
}

// ---- heartbeats
// Returns a member `client_time_us` to append to others, or "" if the client has no clock.
static const char *clock_of(const sim_client *c, char text[CLOCK_BYTES])
{
	text[0] = 0;
	if (c->clocked)
		snprintf(text, CLOCK_BYTES, ",\"client_time_us\":%lld",
		         (long long)(sim_now() + c->clock_ahead_ns) / 1000);
	return text;
}

int64_t clients_beat_due(void)
{
	int64_t due_ns = SIM_NEVER;
	for (int i = 0; i < CLIENTS; i++)
		if (sim_clients[i].link && sim_clients[i].beats && sim_clients[i].beat_ns < due_ns)
			due_ns = sim_clients[i].beat_ns;
	return due_ns;
}

void clients_beat(void)
{
	int64_t now_ns = sim_now();
	for (int i = 0; i < CLIENTS; i++) {
		sim_client *c = &sim_clients[i];
		if (!c->link || !c->beats || c->beat_ns > now_ns)
			continue;
		c->beat_ns = now_ns + BEAT_NS;
		char params[32 + CLOCK_BYTES], clock[CLOCK_BYTES];
		snprintf(params, sizeof params, "\"visible\":%s%s", c->visible ? "true" : "false",
		         clock_of(c, clock));
		clients_notify(i, "heartbeat", params);
	}
}

// ---- receiving
bool clients_member(const char *text, const char *name, char *out, size_t capacity)
{
	char key[48];
	snprintf(key, sizeof key, "\"%s\":", name);
	const char *at = strstr(text, key);
	if (!at)
		return false;
	at += strlen(key);
	bool quoted = *at == '"';
	at += quoted;
	size_t count = strcspn(at, quoted ? "\"" : ",}]");
	if (count >= capacity)
		return false;
	memcpy(out, at, count);
	out[count] = 0;
	return true;
}

static void take_hello(sim_client *c, const char *result)
{
	char number[24] = "";
	c->greeted = true;
	clients_member(result, "client", number, sizeof number);
	c->number = (uint32_t)strtoul(number, NULL, 10);
	clients_member(result, "resume", c->resume, sizeof c->resume);
}

static void take_result(sim_client *c, sim_request *r)
{
	char unstored[8] = "";
	r->unstored =
		clients_member(r->result, "stored", unstored, sizeof unstored) && unstored[0] == 'f';
	if (r->what == ASK_HELLO)
		take_hello(c, r->result);
	if (r->what == ASK_CREATE && r->life == sim_sessions[r->session].life)
		sim_sessions[r->session].made = true;
	if (r->what == ASK_JOIN)
		streams_joined(c->index, r->session, r->result);
}

static void take_answer(sim_client *c, uint64_t number, const char *text)
{
	if (number < 1 || number > (uint64_t)sim_request_count)
		sim_fail("one_answer", "an answer to nothing: %s", text);
	sim_request *r = clients_request(number);
	if (r->client != c->index || r->connection != c->connection)
		sim_fail("one_answer", "client %d gets what was asked elsewhere: %s", c->index, text);
	if (r->answered)
		sim_fail("one_answer", "a second answer to %s: %s, after %s", r->method, text, r->result);
	const char *result = strstr(text, "\"result\":");
	r->answered = true;
	r->answered_ns = sim_now();
	r->ok = result != NULL;
	r->result = strdup(result ? result : text);
	if (r->ok)
		take_result(c, r);
	promises_answered(number);
}

static void on_text(void *user, const char *bytes, size_t count)
{
	sim_client *c = user;
	char *text = strndup(bytes, count), number[24];
	sim_say("client %d gets %s", c->index, text);
	sim_note(count);
	if (clients_member(text, "id", number, sizeof number))
		take_answer(c, strtoull(number, NULL, 10), text);
	else
		promises_told(c->index, text);
	free(text);
}

static void on_frame(void *user, const unsigned char *bytes, size_t count)
{
	const sim_client *c = user;
	sim_note(count);
	streams_frame(c->index, bytes, count);
}

// True if the message, or an earlier one, may have waited while its daemon was stopped. Such a
// message proves only that the client was alive at the time when the message could have been read.
// Its clock is not the first that the daemon trusts.
static bool waited(const sim_client *c, const sim_message *message)
{
	return message->due_ns < sim_stopped_until(c->machine);
}

// Records the latest time at which the sender was alive, as far as the message can show. For a
// client without a clock this is the time at which the message could be read. For a client with a
// clock it is the time of sending plus the longest latency, which is the error of the daemon's
// estimate.
static void hear(sim_client *c, const sim_message *message)
{
	bool clock = !message->binary && strstr(message->text, "\"client_time_us\"");
	bool late = waited(c, message);
	int64_t lived_ns = late ? message->due_ns : sim_now();
	if (c->clock_counts)
		lived_ns = clock ? message->sent_ns + latency_most_ns : 0;
	if (lived_ns > c->heard_ns)
		c->heard_ns = lived_ns;
	c->clock_counts = c->clock_counts || (clock && !late);
}

static void on_arriving(void *user, const sim_message *message)
{
	sim_client *c = user;
	hear(c, message);
	if (message->tag) {
		clients_request(message->tag)->arriving_ns = sim_now();
		promises_arriving(message->tag);
	} else if (!message->binary && strstr(message->text, "\"stream.ack\"")) {
		streams_ack_arriving(c->index, message->text);
	}
}

static void on_arrived(void *user, const sim_message *message)
{
	const sim_client *c = user;
	if (message->tag) {
		clients_request(message->tag)->arrived = true;
		promises_arrived(message->tag);
	} else if (strstr(message->text, "\"visible\":false")) {
		promises_away(c->index);
	}
}

static void on_closed(void *user, int code)
{
	sim_client *c = user;
	sim_say("client %d is closed, %d", c->index, code);
	c->link = NULL;
	c->greeted = false;
	promises_away(c->index);
	streams_forget(c->index);
}

const sim_end sim_clients_end = {on_arriving, on_arrived, on_text, on_frame, on_closed};
