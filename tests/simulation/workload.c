// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/workload.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/books.h"
#include "simulation/core_watch.h"
#include "simulation/courier.h"
#include "simulation/promises.h"

// The value of the argument c of STEP_CREATE, which is 0 to 5, that creates an ephemeral session.
enum { EPHEMERAL = 5 };
#define TENTH_NS (SIM_SECOND / 10)

static int gravities; // number of gravities used so far

// ---- making a workload
typedef struct maker {
	workload *work;
	sim_random random;
	int64_t at_ns;
	bool moves; // true if sessions move between two machines in this run
	int machines;
} maker;

static void add(maker *m, step_kind kind, int a, int b, int c)
{
	if (m->work->count < STEPS_MOST)
		m->work->steps[m->work->count++] = (work_step){m->at_ns, kind, a, b, c, false};
}

static int pick(maker *m, int count)
{
	return (int)sim_between(&m->random, 0, count - 1);
}

static void pass(maker *m, int64_t most_ms)
{
	m->at_ns += sim_between(&m->random, 0, most_ms * 1000) * 1000;
}

// A client drives a tool with energy on, and then something happens to it.
static void drive(maker *m)
{
	int client = pick(m, CLIENTS), session = pick(m, SESSIONS), tool = pick(m, TOOLS);
	add(m, STEP_CONNECT, client, pick(m, m->machines), 0);
	add(m, STEP_BEAT, client, 0, 0);
	add(m, STEP_SHOW, client, 0, 0);
	pass(m, 40);
	add(m, STEP_TAKE, client, session, tool);
	if (pick(m, 2))
		pass(m, 60);
	add(m, STEP_ON, client, session, tool);
	if (pick(m, 3) == 0) {
		pass(m, 100);
		add(m, STEP_STEP, client, session, 1 + pick(m, 20));
	}
	if (pick(m, 8) == 0) {
		pass(m, 100);
		add(m, STEP_STOP, pick(m, m->machines), 3 + pick(m, 9), 0);
	}
	if (pick(m, 3) == 0) {
		pass(m, 100);
		add(m, STEP_SILENT, client, 0, 0);
	}
	pass(m, 300);
}

// A client advances a paused session in lock-step, with energy on.
static void drive_by_ticks(maker *m)
{
	int client = pick(m, CLIENTS), session = pick(m, SESSIONS), tool = pick(m, TOOLS);
	add(m, STEP_CONNECT, client, pick(m, m->machines), 0);
	add(m, STEP_SHOW, client, 0, 0);
	pass(m, 40);
	add(m, STEP_TAKE, client, session, tool);
	add(m, STEP_PAUSE, client, session, 0);
	for (int left = 1 + pick(m, 6); left > 0; left--) {
		pass(m, 400);
		add(m, STEP_ADVANCE, client, session, TOOLS * pick(m, 30) + tool);
	}
}

// A machine loses power shortly after commands were acknowledged.
static void lose_power(maker *m)
{
	int session = pick(m, SESSIONS);
	for (int left = 1 + pick(m, 4); left > 0; left--) {
		add(m, STEP_GRAVITY, pick(m, CLIENTS), session, 0);
		pass(m, 20);
	}
	pass(m, 60);
	add(m, STEP_POWER, pick(m, m->machines), 0, 0);
}

static void befall(maker *m)
{
	static const struct {
		step_kind kind;
		// a, b, c: each argument is below this value; 0: the step has no such argument
		int weight, a, b, c;
	} kinds[] = {
		{STEP_CUT, 6, CLIENTS, 0, 0},
		{STEP_HIDE, 6, CLIENTS, 0, 0},
		{STEP_SILENT, 6, CLIENTS, 0, 0},
		{STEP_LATE, 6, CLIENTS, 20, 0},
		{STEP_OFF, 5, CLIENTS, SESSIONS, TOOLS},
		{STEP_PAUSE, 5, CLIENTS, SESSIONS, 0},
		{STEP_RESUME, 6, CLIENTS, SESSIONS, 0},
		{STEP_HAND_OVER, 3, CLIENTS, SESSIONS, TOOLS},
		{STEP_TAKE, 5, CLIENTS, SESSIONS, TOOLS},
		{STEP_ON, 6, CLIENTS, SESSIONS, TOOLS},
		{STEP_ON_LATER, 4, CLIENTS, SESSIONS, 60},
		{STEP_MOVE, 3, CLIENTS, SESSIONS, TOOLS},
		{STEP_GRAVITY, 14, CLIENTS, SESSIONS, 0},
		{STEP_BURST, 2, CLIENTS, SESSIONS, 60},
		{STEP_GRAVITY_LATER, 4, CLIENTS, SESSIONS, 60},
		{STEP_CANCEL, 1, CLIENTS, SESSIONS, 0},
		{STEP_STEP, 4, CLIENTS, SESSIONS, 30},
		{STEP_ADVANCE, 4, CLIENTS, SESSIONS, 60},
		{STEP_REWIND, 2, CLIENTS, SESSIONS, 100},
		{STEP_RESET, 1, CLIENTS, SESSIONS, 0},
		{STEP_SNAPSHOT, 2, CLIENTS, SESSIONS, 3},
		{STEP_RESTORE, 1, CLIENTS, SESSIONS, 3},
		{STEP_PAST, 2, CLIENTS, SESSIONS, 100},
		{STEP_SPEED, 1, CLIENTS, SESSIONS, 8},
		{STEP_HOLD, 2, CLIENTS, SESSIONS, TOOLS},
		{STEP_REMOVE, 1, CLIENTS, SESSIONS, 0},
		{STEP_ADD, 2, CLIENTS, SESSIONS, 0},
		{STEP_AGAIN, 8, CLIENTS, 0, 0},
		{STEP_JOIN, 4, CLIENTS, SESSIONS, 0},
		{STEP_KEY_FRAME, 1, CLIENTS, SESSIONS, 0},
		{STEP_STOP_READING, 1, CLIENTS, 0, 0},
		{STEP_READ, 3, CLIENTS, 16, 0},
		{STEP_CREATE, 3, CLIENTS, SESSIONS, 6},
		{STEP_DESTROY, 1, CLIENTS, SESSIONS, 0},
		{STEP_FORK, 2, CLIENTS, SESSIONS, SESSIONS},
		{STEP_FORK_PAST, 1, CLIENTS, SESSIONS, SESSIONS},
		{STEP_MOVE_SESSION, 4, SESSIONS, 0, 0},
		{STEP_KILL, 2, DISK_MACHINES, 0, 0},
		{STEP_POWER, 2, DISK_MACHINES, 0, 0},
		{STEP_RESTART, 1, DISK_MACHINES, 0, 0},
		{STEP_STOP, 3, DISK_MACHINES, 12, 0},
		{STEP_FULL, 1, DISK_MACHINES, 0, 0},
		{STEP_SLOW_DISK, 1, DISK_MACHINES, 100, 0},
		{STEP_BAD_DISK, 1, DISK_MACHINES, 0, 20},
		{STEP_ROOM, 2, DISK_MACHINES, 0, 0},
		{STEP_GOOD_DISK, 2, DISK_MACHINES, 0, 0},
	};
	enum { KINDS = sizeof kinds / sizeof *kinds };
	int total = 0, i = 0;
	for (int k = 0; k < KINDS; k++)
		total += kinds[k].weight;
	for (int at = pick(m, total); (at -= kinds[i].weight) >= 0;)
		i++;
	int a = kinds[i].a ? pick(m, kinds[i].a) : 0;
	bool of_machine = kinds[i].kind >= STEP_KILL;
	if ((of_machine && a >= m->machines) || (kinds[i].kind == STEP_MOVE_SESSION && !m->moves))
		return;
	add(m, kinds[i].kind, a, kinds[i].b ? pick(m, kinds[i].b) : 0,
	    kinds[i].c ? pick(m, kinds[i].c) : 0);
}

void workload_make(workload *work, uint64_t seed, const sim_profile *profile)
{
	maker m = {.work = work, .random = sim_random_of(seed, 7)};
	*work = (workload){0};
	m.moves = pick(&m, 3) == 0;
	m.machines = work->machines = m.moves ? 2 : 1;
	for (int i = 0; i < CLIENTS; i++)
		add(&m, STEP_CONNECT, i, 0, 0);
	pass(&m, 50);
	for (int i = 0; i < SESSIONS; i++)
		if (i == 0 || pick(&m, 2))
			add(&m, STEP_CREATE, pick(&m, CLIENTS), i, pick(&m, 2));
	pass(&m, 200);
	while (m.at_ns < profile->length_ns && work->count < STEPS_MOST) {
		if (pick(&m, 4) == 0)
			drive(&m);
		if (pick(&m, 16) == 0)
			drive_by_ticks(&m);
		if (pick(&m, 100) == 0)
			lose_power(&m);
		befall(&m);
		if (m.moves && pick(&m, 12) == 0)
			add(&m, STEP_MOVE_SESSION, pick(&m, SESSIONS), 0, 0);
		pass(&m, pick(&m, 20) ? 200 : 6000);
	}
}

void workload_print(const workload *work)
{
	static const char *const words[STEP_KINDS] = {
#define X(code, word) [STEP_##code] = word,
		STEP_TABLE(X)
#undef X
	};
	for (int i = 0; i < work->count; i++) {
		const work_step *s = &work->steps[i];
		if (!s->left_out)
			printf("%4d  %8.3f s  %s %d %d %d\n", i, 1e-9 * (double)s->at_ns, words[s->kind], s->a,
			       s->b, s->c);
	}
}

// ---- performing the steps
void workload_begin(void)
{
	gravities = 0;
}

static bool exists(const work_step *s)
{
	return sim_sessions[s->b].wanted;
}

// Begins the record of a new session. Returns false if the client may not create the session.
static bool begin_session(int client, int place, char name[NAME_MOST])
{
	sim_session *made = &sim_sessions[place];
	if (made->wanted || !sim_clients[client].link || !clients_may(client, ASK_CREATE, place))
		return false;
	*made = (sim_session){
		.life = made->life + 1, .machine = sim_clients[client].machine, .wanted = true};
	memset(&sim_books[place], 0, sizeof sim_books[place]);
	sim_session_name(place, name);
	return true;
}

static void create(const work_step *s)
{
	char name[NAME_MOST], params[256];
	if (!begin_session(s->a, s->b, name))
		return;
	sim_sessions[s->b].ephemeral = s->c == EPHEMERAL;
	snprintf(params, sizeof params,
	         "\"name\":\"%s\",\"scene\":\"sheet\",\"paused\":%s,\"ephemeral\":%s", name,
	         s->c % 2 ? "true" : "false", s->c == EPHEMERAL ? "true" : "false");
	clients_ask(s->a, ASK_CREATE, "session.create", s->b, -1, true, params);
}

static void fork_session(const work_step *s)
{
	char name[NAME_MOST], params[256], source[NAME_MOST], of_tick[32] = "";
	int gravity;
	int64_t tick;
	bool there = core_watch_state(s->b, sim_clients[s->a].machine, &gravity, &tick);
	if (!begin_session(s->a, s->c, name))
		return;
	sim_session_id(s->b, sim_clients[s->a].machine, source);
	sim_sessions[s->c].ephemeral = sim_sessions[s->b].ephemeral;
	if (s->kind == STEP_FORK_PAST && there)
		snprintf(of_tick, sizeof of_tick, ",\"tick\":%lld", (long long)tick / 2);
	snprintf(params, sizeof params, "\"session\":\"%s\",\"name\":\"%s\"%s", source, name, of_tick);
	clients_ask(s->a, ASK_CREATE, "session.fork", s->c, -1, true, params);
}

static void destroy(const work_step *s)
{
	if (!exists(s) || !sim_clients[s->a].link || sim_sessions[s->b].moving ||
	    !clients_may(s->a, ASK_DESTROY, s->b))
		return;
	clients_ask(s->a, ASK_DESTROY, "session.destroy", s->b, -1, true, "");
	sim_sessions[s->b].wanted = sim_sessions[s->b].made = false;
}

// Sets gravity after `ticks` ticks; 0: at once.
static void set_gravity(int client, int place, int ticks)
{
	char params[96], at_tick[32] = "";
	int gravity;
	int64_t tick;
	if (gravities + 1 >= GRAVITIES_MOST || !sim_clients[client].link)
		return;
	if (ticks && !core_watch_state(place, sim_clients[client].machine, &gravity, &tick))
		return;
	if (ticks)
		snprintf(at_tick, sizeof at_tick, ",\"tick\":%lld", (long long)tick + ticks);
	snprintf(params, sizeof params, "\"gravity_m_s2\":[0,0,%.6f]%s", books_gravity(++gravities),
	         at_tick);
	uint64_t number = clients_ask(client, ASK_GRAVITY, "gravity.set", place, -1, true, params);
	clients_request(number)->gravity = gravities;
	clients_request(number)->later = ticks > 0;
}

static uint64_t of_tool(const work_step *s, ask what, const char *method, const char *more)
{
	char params[160];
	snprintf(params, sizeof params, "\"tool\":\"%s\"%s", sim_tools[s->c % TOOLS], more);
	return clients_ask(s->a, what, method, s->b, s->c % TOOLS, true, params);
}

static void change_tools(const work_step *s)
{
	char params[256];
	bool removes = s->kind == STEP_REMOVE;
	snprintf(params, sizeof params,
	         removes ? "\"tool\":\"%s\"" : "\"name\":\"%s\",\"shape\":\"hook\"",
	         sim_tools[TOOLS - 1]);
	clients_ask(s->a, removes ? ASK_REMOVE : ASK_OTHER, removes ? "tool.remove" : "tool.add", s->b,
	            TOOLS - 1, true, params);
}

static void advance(const work_step *s)
{
	char params[256];
	int tool = s->c % TOOLS;
	snprintf(params, sizeof params,
	         "\"ticks\":%d,\"commands\":[{\"method\":\"tool.energize\",\"tool\":\"%s\","
	         "\"energized\":true}]",
	         1 + s->c / 2, sim_tools[tool]);
	uint64_t number = clients_ask(s->a, ASK_ADVANCE, "session.advance", s->b, tool, false, params);
	if (number)
		clients_request(number)->ticks = 1 + s->c / 2;
}

static void energize_later(const work_step *s)
{
	char more[64];
	int gravity;
	int64_t tick;
	if (!core_watch_state(s->b, sim_clients[s->a].machine, &gravity, &tick))
		return;
	snprintf(more, sizeof more, ",\"energized\":true,\"tick\":%lld", (long long)tick + 1 + s->c);
	uint64_t number = of_tool(s, ASK_ON, "tool.energize", more);
	if (number)
		clients_request(number)->later = true;
}

static void move_tool(const work_step *s)
{
	char params[256], id[NAME_MOST];
	sim_session_id(s->b, sim_clients[s->a].machine, id);
	snprintf(params, sizeof params,
	         "\"session\":\"%s\",\"tool\":\"%s\",\"position_m\":[0.01,0,0.02],"
	         "\"rotation\":[1,0,0,0]",
	         id, sim_tools[s->c]);
	clients_notify(s->a, "tool.move", params);
}

// Requests something about a past tick of the session.
static void ask_past(const work_step *s, ask what, const char *method, bool changes)
{
	char params[64];
	int gravity;
	int64_t tick;
	if (!core_watch_state(s->b, sim_clients[s->a].machine, &gravity, &tick))
		return;
	snprintf(params, sizeof params, "\"tick\":%lld", (long long)(tick * s->c / 100));
	clients_ask(s->a, what, method, s->b, -1, changes, params);
}

static void ask_named(const work_step *s, ask what, const char *method)
{
	char params[64];
	snprintf(params, sizeof params, "\"name\":\"kept%d\"", s->c);
	clients_ask(s->a, what, method, s->b, -1, true, params);
}

static void step_session(const work_step *s)
{
	char params[64];
	snprintf(params, sizeof params, "\"ticks\":%d", 1 + s->c);
	clients_ask(s->a, ASK_STEP, "session.step", s->b, -1, true, params);
}

static void set_speed(const work_step *s)
{
	char params[64];
	snprintf(params, sizeof params, "\"speed\":%.1f", 0.5 * (1 + s->c));
	clients_ask(s->a, ASK_OTHER, "session.speed", s->b, -1, true, params);
}

// Steps that are one request each. The params have at most a tool and `more`.
static const struct {
	step_kind kind;
	ask what;
	const char *method;
	bool of_tool, changes;
	const char *more;
} plain[] = {
	{STEP_TAKE, ASK_TAKE, "tool.take_over", true, true, ""},
	{STEP_ON, ASK_ON, "tool.energize", true, true, ",\"energized\":true"},
	{STEP_OFF, ASK_OFF, "tool.energize", true, true, ",\"energized\":false"},
	{STEP_HAND_OVER, ASK_HAND_OVER, "tool.hand_over", true, true, ""},
	{STEP_HOLD, ASK_OTHER, "tool.hold", true, true, ""},
	{STEP_PAUSE, ASK_PAUSE, "session.pause", false, true, ""},
	{STEP_RESUME, ASK_RESUME, "session.resume", false, true, ""},
	{STEP_RESET, ASK_RESET, "session.reset", false, true, ""},
	{STEP_CANCEL, ASK_OTHER, "session.cancel", false, false, ""},
	{STEP_JOIN, ASK_JOIN, "session.join", false, false, ""},
	{STEP_KEY_FRAME, ASK_KEY_FRAME, "stream.key_frame", false, false, ""},
};

static bool ask_plainly(const work_step *s)
{
	for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) {
		if (plain[i].kind != s->kind)
			continue;
		if (plain[i].of_tool)
			of_tool(s, plain[i].what, plain[i].method, plain[i].more);
		else
			clients_ask(s->a, plain[i].what, plain[i].method, s->b, -1, plain[i].changes, "");
		return true;
	}
	return false;
}

static void do_to_session(const work_step *s)
{
	if (ask_plainly(s))
		return;
	switch (s->kind) {
	case STEP_ON_LATER:
		energize_later(s);
		break;
	case STEP_MOVE:
		move_tool(s);
		break;
	case STEP_GRAVITY:
		set_gravity(s->a, s->b, 0);
		break;
	case STEP_GRAVITY_LATER:
		set_gravity(s->a, s->b, 1 + s->c);
		break;
	case STEP_BURST:
		for (int i = 0; i < s->c; i++)
			set_gravity(s->a, s->b, 0);
		break;
	case STEP_STEP:
		step_session(s);
		break;
	case STEP_ADVANCE:
		advance(s);
		break;
	case STEP_REWIND:
		ask_past(s, ASK_REWIND, "session.rewind", true);
		break;
	case STEP_SNAPSHOT:
		ask_named(s, ASK_SNAPSHOT, "session.snapshot");
		break;
	case STEP_RESTORE:
		ask_named(s, ASK_REWIND, "session.restore");
		break;
	case STEP_PAST:
		ask_past(s, ASK_OTHER, "session.frame_at", false);
		break;
	case STEP_SPEED:
		set_speed(s);
		break;
	case STEP_REMOVE:
	case STEP_ADD:
		change_tools(s);
		break;
	default:
		assert(false);
	}
}

static void do_to_client(const work_step *s)
{
	sim_client *c = &sim_clients[s->a];
	switch (s->kind) {
	case STEP_CONNECT:
		clients_connect(s->a, s->b);
		break;
	case STEP_CUT:
		clients_cut(s->a);
		break;
	case STEP_HIDE:
	case STEP_SHOW:
		clients_show(s->a, s->kind == STEP_SHOW);
		break;
	case STEP_SILENT:
	case STEP_BEAT:
		c->beats = s->kind == STEP_BEAT;
		c->beat_ns = sim_now();
		break;
	case STEP_LATE:
		clients_late(s->a, (1 + s->b) * TENTH_NS);
		break;
	case STEP_STOP_READING:
	case STEP_READ:
		clients_read(s->a, s->kind == STEP_READ, 1 + s->b);
		break;
	default:
		clients_send_again(s->a);
	}
}

static void do_to_machine(const work_step *s)
{
	disk_manner *disk = disk_manner_of(s->a);
	switch (s->kind) {
	case STEP_KILL:
	case STEP_POWER:
		if (!daemons_down(s->a))
			daemons_kill(s->a, s->kind == STEP_POWER);
		break;
	case STEP_RESTART:
		daemons_end(s->a);
		break;
	case STEP_STOP:
		if (daemons_up(s->a))
			sim_stop_machine(s->a, sim_now() + (1 + s->b) * TENTH_NS);
		break;
	case STEP_FULL:
	case STEP_ROOM:
		disk->full = s->kind == STEP_FULL;
		break;
	case STEP_SLOW_DISK:
		disk->sync_most_ns = (1 + s->b) * SIM_MS;
		break;
	case STEP_BAD_DISK:
		disk->fail_write_one_in = disk->fail_sync_one_in = 5 + s->c;
		break;
	default:
		*disk = (disk_manner){.sync_least_ns = 50000, .sync_most_ns = 2 * SIM_MS};
	}
}

void workload_do(const work_step *s)
{
	if (s->kind == STEP_CREATE)
		create(s);
	else if (s->kind == STEP_DESTROY)
		destroy(s);
	else if (s->kind == STEP_FORK || s->kind == STEP_FORK_PAST) {
		if (exists(s))
			fork_session(s);
	} else if (s->kind == STEP_MOVE_SESSION)
		courier_move(s->a);
	else if (s->kind >= STEP_KILL)
		do_to_machine(s);
	else if (s->kind >= STEP_TAKE && s->kind != STEP_AGAIN) {
		if (exists(s))
			do_to_session(s);
	} else
		do_to_client(s);
}
