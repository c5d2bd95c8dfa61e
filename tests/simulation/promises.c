// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/promises.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/books.h"
#include "simulation/core_watch.h"

#define DEADLINE_NS (250 * SIM_MS) // the setting browser_deadline_s
#define TICK_NS (SIM_SECOND / 60)
// Time that is added to the deadline, because the daemon reads the clock before it takes the lock,
// and a thread may stall between the two.
#define SLACK_NS (10 * SIM_MS)
// Longest time until a request must be answered. A disk may fail for some seconds, and a daemon may
// be without its session for as long.
#define ANSWER_MOST_NS (8 * SIM_SECOND)
#define LOOK_NS (5 * SIM_MS)

enum { SILENT_TICKS = 15 }; // the deadline of a driver in lock-step, in ticks

promise_counts promises_counted;
session_book sim_books[SESSIONS];
quota_book sim_quotas[DISK_MACHINES];

static struct {
	sim_profile profile;
	int64_t look_ns, calm_ns;
	uint64_t checked; // requests with a smaller number are answered or abandoned
	int64_t calm_tick[SESSIONS];
} own;

const char *promises_meaning(const char *word)
{
#define X(code, meaning)                                                                           \
	if (strcmp(word, #code) == 0)                                                                  \
		return meaning;
	PROMISE_TABLE(X)
#undef X
	return NULL;
}

// ---- energy
static void void_enables(int place, int tool, int client, int64_t before_ns)
{
	for (int t = 0; t < TOOLS; t++)
		for (int c = 0; c < CLIENTS; c++)
			if ((tool < 0 || t == tool) && (client == EVERY_CLIENT || c == client) &&
			    sim_books[place].enabled_ns[t][c] <= before_ns)
				sim_books[place].enabled_ns[t][c] = 0;
}

void promises_store_takes(const char *id, bool takes)
{
	int place = sim_session_of(id);
	if (place < 0 || sim_sessions[place].machine != sim_machine())
		return;
	sim_books[place].full = !takes;
	if (!takes)
		void_enables(place, -1, EVERY_CLIENT, sim_now());
}

void promises_away(int client)
{
	for (int i = 0; i < SESSIONS; i++)
		void_enables(i, -1, client, sim_now());
}

static bool is_heard(int client, int64_t at_ns)
{
	return at_ns - sim_clients[client].heard_ns <= DEADLINE_NS + TICK_NS + SLACK_NS;
}

energy promises_energy(int place, int tool, int64_t at_ns)
{
	energy found = ENERGY_CUT;
	for (int c = 0; c < CLIENTS; c++) {
		if (!sim_books[place].enabled_ns[tool][c])
			continue;
		if (sim_books[place].in_ticks[c] || is_heard(c, at_ns))
			return ENERGY_ALLOWED;
		found = ENERGY_SILENT;
	}
	return found;
}

int promises_by_ticks(int place, int tool, int64_t at_ns)
{
	int found = -1;
	const session_book *book = &sim_books[place];
	for (int c = 0; c < CLIENTS; c++) {
		if (!book->enabled_ns[tool][c])
			continue;
		if (found >= 0 || !book->in_ticks[c] || (!book->by_ticks[tool][c] && is_heard(c, at_ns)))
			return -1;
		found = c;
	}
	return found;
}

// ---- requests
// True if the request is about a session that the receiving daemon has.
static bool meets_session(const sim_request *r)
{
	int gravity;
	int64_t tick;
	return r->session >= 0 && r->life == sim_sessions[r->session].life &&
	       sim_sessions[r->session].machine == r->machine &&
	       core_watch_state(r->session, r->machine, &gravity, &tick);
}

void promises_arriving(uint64_t number)
{
	sim_request *r = clients_request(number);
	r->met = meets_session(r) && clients_may(r->client, r->what, r->session);
	if (r->what == ASK_KEY_FRAME && r->met)
		streams_key_asked(r->client, r->session);
	if (!r->met)
		return;
	session_book *book = &sim_books[r->session];
	if (r->what == ASK_ADVANCE) {
		book->in_ticks[r->client] = true;
		book->ticks_left[r->client] += r->ticks < SILENT_TICKS ? r->ticks : SILENT_TICKS;
	}
	if ((r->what == ASK_ON || r->what == ASK_ADVANCE) && !book->full) {
		int64_t *enabled_ns = &book->enabled_ns[r->tool][r->client];
		bool *by_ticks = &book->by_ticks[r->tool][r->client];
		*by_ticks = r->what == ASK_ADVANCE && (*by_ticks || !*enabled_ns);
		*enabled_ns = r->arriving_ns;
	}
	if (r->what == ASK_REWIND || r->what == ASK_RESET)
		books_line_leaves(book);
}

// Energy off and pause take effect regardless of the queue and the store, except for resent
// requests.
void promises_arrived(uint64_t number)
{
	const sim_request *r = clients_request(number);
	if (!r->met || r->first)
		return;
	if (r->what == ASK_OFF)
		void_enables(r->session, r->tool, EVERY_CLIENT, r->arriving_ns);
	if (r->what == ASK_PAUSE)
		void_enables(r->session, -1, EVERY_CLIENT, r->arriving_ns);
}

// True if the daemon looked for a stored answer. Some refusals come before this look-up, so they
// prove nothing about the first answer.
static bool was_looked_up(const sim_request *r)
{
	static const char *const refusals[] = {"\"moved\"", "not_here",      "store_full",
	                                       "draining",  "queue is full", "\"rate\""};
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++)
		if (!r->ok && strstr(r->result, refusals[i]))
			return false;
	return true;
}

// Checks that a resent request gets the first answer again. The answers of a session move with it,
// so the session's old daemon has no answers left.
static void check_same(const sim_request *r)
{
	if (sim_sessions[r->session].machine != r->machine || !was_looked_up(r))
		return;
	for (uint64_t i = 1; i <= (uint64_t)sim_request_count; i++) {
		const sim_request *other = clients_request(i);
		bool same = other != r && other->client == r->client && other->sequence == r->sequence;
		bool both_stored = other->answered && other->ok && !other->unstored && !r->unstored;
		if (same && both_stored && (!r->ok || strcmp(other->result, r->result) != 0))
			sim_fail("same_answer", "%s was answered with %s, then with %s", r->method,
			         other->result, r->result);
	}
}

static void check_refusal(const sim_request *r)
{
	if (strstr(r->result, "sequence_past") || strstr(r->result, "sequence_conflict") ||
	    strstr(r->result, "\"faulted\""))
		sim_fail("sound", "%s is answered with %s", r->method, r->result);
}

// Checks that a client stays within its quota. The quota allows the requests of one minute at once,
// and refills evenly. A request that is answered from the store uses as much quota as the first
// one.
static void check_quota(const sim_request *r, int64_t now_ns)
{
	int most = clients_quota(r->client);
	bool costs = r->what == ASK_CREATE || r->what == ASK_RESET || r->what == ASK_REWIND;
	quota_book *book = &sim_quotas[r->machine];
	if (!most || !costs || r->session < 0 || sim_sessions[r->session].ephemeral ||
	    sim_books[r->session].in_ticks[r->client])
		return;
	double minutes = 1e-9 / 60 * (double)(now_ns - book->from_ns);
	if (++book->done[r->client] > most * (1 + minutes))
		sim_fail("allowed",
		         "client %d has %d expensive requests done within %.1f s, with a quota of %d",
		         r->client, book->done[r->client], 60 * minutes, most);
}

static void check_allowed(const sim_request *r)
{
	bool present = r->session < 0 || r->life == sim_sessions[r->session].life;
	if (!clients_may(r->client, r->what, r->session))
		sim_fail("allowed", "client %d may not, and does: %s, answered with %s", r->client,
		         r->method, r->result);
	if (present)
		check_quota(r, r->answered_ns);
}

void promises_answered(uint64_t number)
{
	sim_request *r = clients_request(number);
	promises_counted.answers++;
	if (r->ok)
		check_allowed(r);
	if (r->first && r->session >= 0 && r->life == sim_sessions[r->session].life)
		check_same(r);
	if (!r->ok)
		check_refusal(r);
	if (r->session < 0 || r->life != sim_sessions[r->session].life)
		return;
	session_book *book = &sim_books[r->session];
	if (r->what == ASK_REWIND || r->what == ASK_RESET)
		books_line_arrives(book);
	if (!r->ok)
		return;
	for (int c = 0; c < CLIENTS && r->what == ASK_TAKE; c++)
		if (c != r->client && !r->first)
			void_enables(r->session, r->tool, c, r->arriving_ns - 1);
	if ((r->what == ASK_REWIND || r->what == ASK_RESET || r->what == ASK_HAND_OVER) && !r->first)
		void_enables(r->session, r->what == ASK_HAND_OVER ? r->tool : -1,
		             r->what == ASK_HAND_OVER ? r->client : EVERY_CLIENT, r->arriving_ns - 1);
	if (r->what == ASK_REMOVE && !r->first)
		void_enables(r->session, r->tool, EVERY_CLIENT, r->arriving_ns - 1);
	if (r->what == ASK_GRAVITY && !r->unstored) {
		promises_counted.acknowledged++;
		books_acknowledge(book, r->gravity);
	}
	if (r->what == ASK_CREATE)
		book->made = true;
}

void promises_moving(int place, int target)
{
	if (sim_sessions[place].machine == target)
		return;
	sim_sessions[place].machine = target;
	void_enables(place, -1, EVERY_CLIENT, sim_now());
	sim_books[place].restarted = true;
	sim_books[place].full = false;
}

// Checks notifications: some must not occur in the simulation.
void promises_told(int client, const char *text)
{
	if (strstr(text, "\"session.faulted\""))
		sim_fail("sound", "client %d is told %s", client, text);
	for (int i = 0; i < SESSIONS && strstr(text, "\"session.changed\""); i++) {
		char id[NAME_MOST];
		for (int machine = 0; machine < DISK_MACHINES; machine++) {
			sim_session_id(i, machine, id);
			if (strstr(text, id) && !clients_may(client, ASK_JOIN, i))
				sim_fail("allowed", "client %d hears of a session that is not its: %s", client,
				         text);
		}
	}
}

static bool is_due(const sim_request *r, int64_t now_ns)
{
	const sim_client *c = &sim_clients[r->client];
	if (r->session >= 0 && sim_sessions[r->session].moving)
		return false; // requests about a moving session wait
	int64_t since_ns = r->arriving_ns > c->reads_ns ? r->arriving_ns : c->reads_ns;
	if (since_ns < sim_stopped_until(r->machine))
		since_ns = sim_stopped_until(r->machine);
	return r->arrived && !r->answered && !r->later && c->link && c->connection == r->connection &&
	       c->reads && now_ns - since_ns > ANSWER_MOST_NS;
}

static void check_answers(int64_t now_ns)
{
	for (uint64_t i = own.checked + 1; i <= (uint64_t)sim_request_count; i++) {
		const sim_request *r = clients_request(i);
		if (is_due(r, now_ns))
			sim_fail("answered", "request %llu, %s %s, waits for %.3f s", (unsigned long long)i,
			         r->method, r->params, 1e-9 * (double)(now_ns - r->arriving_ns));
		bool over = r->answered || sim_clients[r->client].connection != r->connection;
		if (over && i == own.checked + 1)
			own.checked = i;
	}
}

// ---- time
static void advance(int64_t to_ns)
{
	if (to_ns < own.look_ns)
		return;
	own.look_ns = to_ns + LOOK_NS;
	promises_counted.checks++;
	core_watch_advance(to_ns);
	check_answers(to_ns);
}

void promises_begin(const sim_profile *profile)
{
	memset(&own, 0, sizeof own);
	memset(sim_books, 0, sizeof sim_books);
	memset(sim_quotas, 0, sizeof sim_quotas);
	promises_counted = (promise_counts){0};
	own.profile = *profile;
	sim_on_advance(advance);
}

// ---- daemons
void promises_killed(int machine)
{
	core_watch_killed(machine);
	for (int i = 0; i < SESSIONS; i++)
		if (sim_sessions[i].machine == machine) {
			void_enables(i, -1, EVERY_CLIENT, sim_now());
			books_line_arrives(&sim_books[i]);
			sim_books[i].restarted = true;
			sim_books[i].full = false;
			memset(sim_books[i].in_ticks, 0, sizeof sim_books[i].in_ticks);
		}
}

void promises_started(int machine)
{
	sim_quotas[machine] = (quota_book){.from_ns = sim_now()};
	promises_counted.restarts++;
}

// ---- end of a run
void promises_calm(void)
{
	own.calm_ns = sim_now();
	for (int i = 0; i < SESSIONS; i++) {
		int gravity;
		own.calm_tick[i] = -1;
		core_watch_state(i, sim_sessions[i].machine, &gravity, &own.calm_tick[i]);
	}
}

// True for sessions that were created and not destroyed.
static bool must_be_there(int place)
{
	return sim_books[place].made && sim_sessions[place].wanted && !sim_sessions[place].ephemeral;
}

void promises_settled(void)
{
	for (int i = 0; i < SESSIONS; i++) {
		int gravity;
		int64_t tick;
		if (must_be_there(i) && !core_watch_state(i, sim_sessions[i].machine, &gravity, &tick))
			sim_fail("up", "session %d, whose creation was acknowledged, is not there", i);
	}
	for (uint64_t i = 1; i <= (uint64_t)sim_request_count; i++) {
		const sim_request *r = clients_request(i);
		const sim_client *c = &sim_clients[r->client];
		if (r->arrived && !r->answered && !r->later && c->link && c->connection == r->connection &&
		    r->arriving_ns < own.calm_ns)
			sim_fail("answered", "request %llu, %s %s, is never answered", (unsigned long long)i,
			         r->method, r->params);
	}
}
