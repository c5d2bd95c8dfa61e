// SPDX-License-Identifier: GPL-3.0-or-later
// A session among threads: those that ask, those that bring losses, the worker that steps and the
// store that commits. Losses are held up until they meet a moment of an enable's way exactly, and
// then come at random. The double's step looks at each tick's tools: lit is what was decided when
// the tick began, and nothing that was asked for before a loss.
#include <assert.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"
#include "server/double/fake_session.h"

enum {
	CLIENTS = 2,
	TOOLS = 2,
	ROUNDS = 1500, // of each client
	REQUESTS = 2 * CLIENTS * ROUNDS + 512,
	IN_FLIGHT = 4, // of a client; with the cuts between two ticks the core's queue holds them
};

// Of an enable's way through the session.
typedef enum moment {
	NOWHERE,
	WAITING,    // between its coming in and its application
	TAKEN,      // while the core takes it
	APPLIED,    // between its application and the tick
	COMMITTING, // while its row is written
	STEPPING,   // within the tick that it heats
	MOMENT_COUNT
} moment;

typedef enum loss { CUT, FORGET, FULL_STORE, OFF_BY_ANOTHER, LOSS_COUNT } loss;

typedef struct request {
	atomic_int answers;
	atomic_bool failed;
	int client;
} request;

// What is known of a tool's energy, from what everybody is told of it.
typedef struct tool_book {
	bool on;
	uint64_t lit_from, dark_from; // ticks
	uint64_t asked;               // number of the newest enable that the core took
	uint64_t lit_ticks;
} tool_book;

// Enables of a client up to this number heat no tick from this one on.
typedef struct loss_mark {
	uint64_t asked, from_tick;
} loss_mark;

static const char *const tool_names[TOOLS] = {"hook", "probe"};

static struct {
	char folder[40], file[64];
	cau_config config;
	cau_store *store;
	_Atomic int64_t memory_held;
	cau_surroundings around;
	_Atomic(cau_hosted *) h;
	request requests[REQUESTS];
	atomic_int request_count;
	// Meeting: the thread that comes to the moment waits while another brings the loss.
	atomic_int wanted; // moment
	pthread_barrier_t met, over;
	atomic_bool ended;
	_Atomic uint64_t asked[CLIENTS]; // newest enable that came in, by its number
	// Guarded by the lock, which is taken within the session's.
	pthread_mutex_t lock;
	pthread_cond_t changed;
	tool_book tools[TOOLS];
	loss_mark marks[CLIENTS];
	uint64_t steps, answered, wrongs;
	int in_flight[CLIENTS];
	bool full; // the store, as the session was told
	char wrong[160];
} t;

// ---- what is seen -------------------------------------------------------------------------------

static void note_wrong(const char *what, uint64_t tick, int tool)
{
	if (!t.wrongs++)
		snprintf(t.wrong, sizeof t.wrong, "%s: tick %llu, tool %s", what, (unsigned long long)tick,
		         tool_names[tool]);
}

static void meet(moment here)
{
	int wanted = (int)here;
	if (!atomic_compare_exchange_strong(&t.wanted, &wanted, NOWHERE))
		return;
	pthread_barrier_wait(&t.met);
	pthread_barrier_wait(&t.over);
}

// The client of an enable is in its number.
static int client_of(uint64_t asked)
{
	return (int)(asked % CLIENTS);
}

static void see_submit(const cau_command *command)
{
	if (command->kind != CAU_COMMAND_TOOL_ENERGIZE || !command->as.energized)
		return;
	pthread_mutex_lock(&t.lock);
	for (int i = 0; i < TOOLS; i++)
		if (strcmp(command->tool, tool_names[i]) == 0)
			t.tools[i].asked = command->sequence;
	pthread_mutex_unlock(&t.lock);
	meet(TAKEN);
}

static void check_tool(int i, uint64_t tick, bool lit)
{
	tool_book *book = &t.tools[i];
	const loss_mark *mark = &t.marks[client_of(book->asked)];
	bool decided = book->lit_from <= tick && (book->on || tick < book->dark_from);
	book->lit_ticks += lit;
	if (lit && !decided)
		note_wrong("lit after it was cut", tick, i);
	if (!lit && decided)
		note_wrong("dark though it was enabled", tick, i);
	if (lit && book->asked <= mark->asked && tick >= mark->from_tick)
		note_wrong("lit by an enable from before the loss", tick, i);
}

static void see_step(const cau_session *session)
{
	cau_frame frame;
	bool lit = false;
	cau_session_frame(session, &frame);
	pthread_mutex_lock(&t.lock);
	for (int32_t i = 0; i < frame.tool_count; i++) {
		check_tool((int)i, frame.tick, frame.tools[i].energized);
		lit = lit || frame.tools[i].energized;
	}
	t.steps++;
	pthread_cond_broadcast(&t.changed);
	pthread_mutex_unlock(&t.lock);
	meet(lit ? STEPPING : WAITING);
}

// The first tick that has not begun. Under the session's lock.
static uint64_t next_tick(const cau_hosted *h)
{
	return h->logic->tick + (h->logic->acting == CAU_ACT_STEP);
}

// Told under the session's lock: what is decided is what is told.
static void see_drives(const cau_hosted *h)
{
	pthread_mutex_lock(&t.lock);
	for (int i = 0; i < TOOLS; i++) {
		const cau_drive *drive = cau_logic_drive(h->logic, tool_names[i]);
		tool_book *book = &t.tools[i];
		if (!drive || drive->enabled == book->on)
			continue;
		book->on = drive->enabled;
		*(book->on ? &book->lit_from : &book->dark_from) = next_tick(h);
	}
	pthread_mutex_unlock(&t.lock);
}

static void notify(void *user, cau_audience audience, cau_buffer *text)
{
	(void)user, (void)audience;
	static const char told[] = "tool.driver_changed";
	cau_hosted *h = t.h;
	if (h && memmem(cau_buffer_bytes(text), text->byte_count, told, strlen(told)))
		see_drives(h);
	cau_buffer_release(text);
}

static void see_frames(void *user)
{
	(void)user;
}

static void see_slice(void *user, uint32_t session)
{
	(void)user, (void)session;
}

static void see_armed(void *user)
{
	(void)user;
	meet(APPLIED);
}

// The store asks for the time as it begins to write.
static int64_t see_commit(void)
{
	struct timespec now;
	bool lit = false;
	clock_gettime(CLOCK_REALTIME, &now);
	pthread_mutex_lock(&t.lock);
	for (int i = 0; i < TOOLS; i++)
		lit = lit || t.tools[i].on;
	pthread_mutex_unlock(&t.lock);
	if (lit)
		meet(COMMITTING);
	return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static void see_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)reply;
	request *r = user;
	r->failed = outcome->error != NULL;
	pthread_mutex_lock(&t.lock);
	r->answers++;
	t.answered++;
	t.in_flight[r->client]--;
	pthread_cond_broadcast(&t.changed);
	pthread_mutex_unlock(&t.lock);
}

// ---- what is asked ------------------------------------------------------------------------------

static cau_order *new_order(int client, cau_order_kind kind, cau_method method, request **asked)
{
	cau_order *order = calloc(1, sizeof *order);
	int number = t.request_count++;
	assert(number < REQUESTS);
	request *r = *asked = &t.requests[number];
	r->client = client;
	order->kind = kind;
	order->asker = (cau_asker){
		.client = (uint32_t)client + 1, .role = CAU_ROLE_ADMIN, .deadline_s = client ? 0.02 : 60};
	snprintf(order->asker.name, sizeof order->asker.name, "client %d", client);
	snprintf(order->asker.client_id, sizeof order->asker.client_id, "client-%d", client);
	order->client_sequence = r - t.requests + 1;
	order->reply = (cau_reply){.answer = see_answer, .user = r, .method = method};
	return order;
}

// One that is refused at once is answered by whoever submitted it.
static void submit(cau_order *order, request *r)
{
	cau_error error = {0};
	cau_outcome refused = {.error = &error};
	pthread_mutex_lock(&t.lock);
	t.in_flight[r->client]++;
	pthread_mutex_unlock(&t.lock);
	if (!cau_hosted_submit(t.h, order, &error))
		return;
	see_answer(r, &order->reply, &refused);
	free(order);
}

static request *ask(int client, cau_order_kind kind, cau_method method, int tool)
{
	request *r;
	cau_order *order = new_order(client, kind, method, &r);
	if (kind == CAU_ORDER_TAKE_OVER)
		snprintf(order->as.tool.tool, sizeof order->as.tool.tool, "%s", tool_names[tool]);
	submit(order, r);
	return r;
}

static request *take_over(int client, int tool)
{
	return ask(client, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER, tool);
}

static request *energize(int client, int tool, bool on)
{
	request *r;
	cau_order *order = new_order(client, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE, &r);
	cau_command *command = &order->as.command;
	cau_default_command(command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(command->tool, sizeof command->tool, "%s", tool_names[tool]);
	command->as.energized = on;
	uint64_t number = command->sequence =
		(uint64_t)(r - t.requests + 1) * CLIENTS + (uint64_t)client;
	submit(order, r);
	if (on)
		t.asked[client] = number;
	return r;
}

static void move(int client, int tool, double x_m)
{
	cau_error error = {0};
	cau_order *order = calloc(1, sizeof *order);
	order->kind = CAU_ORDER_COMMAND;
	order->motion = true;
	order->asker = (cau_asker){.client = (uint32_t)client + 1, .role = CAU_ROLE_ADMIN};
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_MOVE);
	snprintf(order->as.command.tool, sizeof order->as.command.tool, "%s", tool_names[tool]);
	order->as.command.as.move.pose.position_m[0] = x_m;
	if (cau_hosted_submit(t.h, order, &error))
		free(order);
}

static bool done(request *r)
{
	pthread_mutex_lock(&t.lock);
	while (!r->answers)
		pthread_cond_wait(&t.changed, &t.lock);
	pthread_mutex_unlock(&t.lock);
	return !r->failed;
}

static void await_steps(uint64_t count)
{
	pthread_mutex_lock(&t.lock);
	uint64_t until = t.steps + count;
	while (t.steps < until && !t.ended)
		pthread_cond_wait(&t.changed, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

// ---- losses -------------------------------------------------------------------------------------

// Nothing that the client asked for up to `asked` heats a tick that begins from now on.
static void mark_loss(int client, uint64_t asked)
{
	cau_hosted *h = t.h;
	pthread_mutex_lock(&h->deciding);
	pthread_mutex_lock(&t.lock);
	t.marks[client] = (loss_mark){asked, next_tick(h)};
	pthread_mutex_unlock(&t.lock);
	pthread_mutex_unlock(&h->deciding);
}

static void lose(loss kind, int client)
{
	uint64_t asked[CLIENTS] = {t.asked[0], t.asked[1]};
	if (kind == CUT)
		cau_hosted_cut(t.h, (uint32_t)client + 1, "its connection is lost");
	else if (kind == FORGET)
		cau_hosted_forget_client(t.h, (uint32_t)client + 1);
	else if (kind == FULL_STORE)
		cau_hosted_store_takes(t.h, false, "a test");
	else
		energize(!client, 0, false);
	for (int i = 0; i < CLIENTS; i++)
		if (i == client || kind == FULL_STORE)
			mark_loss(i, asked[i]);
}

// ---- the session --------------------------------------------------------------------------------

static cau_scene_def *make_scene(void)
{
	cau_scene_def *scene = calloc(1, sizeof *scene);
	cau_default_scene_def(scene);
	snprintf(scene->name, sizeof scene->name, "threads");
	scene->step_s = 0.002; // many ticks in little time
	scene->layer_count = 1;
	cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
	snprintf(scene->layers[0].name, sizeof scene->layers[0].name, "sheet");
	scene->tool_count = TOOLS;
	for (int i = 0; i < TOOLS; i++) {
		cau_default_tool_def(&scene->tools[i], CAU_TOOL_HOOK);
		snprintf(scene->tools[i].name, sizeof scene->tools[i].name, "%s", tool_names[i]);
	}
	return scene;
}

static void open_surroundings(void)
{
	cau_store_config of_store = cau_store_default_config();
	cau_config_default(&t.config);
	snprintf(t.folder, sizeof t.folder, "/tmp/cautery-threads-XXXXXX");
	assert_non_null(mkdtemp(t.folder));
	snprintf(t.file, sizeof t.file, "%s/store.db", t.folder);
	of_store.path = t.file;
	of_store.commit_delay_ms = 0;
	of_store.wall_clock_ms = see_commit;
	assert_int_equal(cau_store_open(&of_store, &t.store, NULL), CAU_OK);
	t.around = (cau_surroundings){.config = &t.config,
	                              .store = t.store,
	                              .memory_held = &t.memory_held,
	                              .armed = see_armed,
	                              .sink = {NULL, notify, see_frames, see_slice}};
	assert_int_equal(cau_worker_pool_create(&t.around.pool, 2, 4, 0, NULL), CAU_OK);
	assert_int_equal(cau_builder_create(&t.around.builder, 0, NULL), CAU_OK);
}

static int begin(void **state)
{
	(void)state;
	cau_hosted *h;
	request *r = &t.requests[0];
	memset(&t, 0, sizeof t);
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.changed, NULL);
	pthread_barrier_init(&t.met, NULL, 2);
	pthread_barrier_init(&t.over, NULL, 2);
	cau_log_set_level("error");
	cau_fake_hooks_set = (cau_fake_hooks){.submit = see_submit, .step = see_step};
	open_surroundings();
	t.request_count = t.in_flight[0] = 1;
	cau_hosted_def def = {
		.id = "d1-threads",
		.number = 1,
		.scene = make_scene(),
		.reply = {.answer = see_answer, .user = r, .method = CAU_METHOD_SESSION_CREATE}};
	assert_int_equal(cau_hosted_create(&h, &t.around, &def, NULL), CAU_OK);
	t.h = h;
	assert_true(done(r));
	return 0;
}

static int end(void **state)
{
	(void)state;
	cau_hosted_stop(t.h);
	cau_store_flush(t.store);
	cau_hosted_release(t.h);
	cau_worker_pool_destroy(t.around.pool);
	cau_builder_stop(t.around.builder);
	cau_builder_destroy(t.around.builder);
	cau_store_close(t.store);
	pthread_barrier_destroy(&t.met);
	pthread_barrier_destroy(&t.over);
	pthread_cond_destroy(&t.changed);
	pthread_mutex_destroy(&t.lock);
	unlink(t.file);
	return rmdir(t.folder);
}

// ---- tests --------------------------------------------------------------------------------------

static void await_answers(void)
{
	pthread_mutex_lock(&t.lock);
	while (t.answered < (uint64_t)t.request_count)
		pthread_cond_wait(&t.changed, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

static void assert_all_well(void)
{
	await_answers();
	await_steps(2);
	cau_store_flush(t.store); // what would be answered a second time has been
	for (int i = 0; i < t.request_count; i++)
		assert_int_equal(t.requests[i].answers, 1);
	pthread_mutex_lock(&t.lock);
	if (t.wrongs)
		fail_msg("%llu times; first: %s", (unsigned long long)t.wrongs, t.wrong);
	pthread_mutex_unlock(&t.lock);
}

// An enable that meets a loss: the session's thread, or the store's, stands still at the moment.
static request *enable_meets(moment at, loss kind)
{
	request *enable = NULL;
	t.wanted = (int)at;
	if (at != WAITING)
		enable = energize(0, 0, true);
	pthread_barrier_wait(&t.met);
	if (at == WAITING)
		enable = energize(0, 0, true);
	lose(kind, 0);
	pthread_barrier_wait(&t.over);
	return enable;
}

static uint64_t lit_ticks(void)
{
	pthread_mutex_lock(&t.lock);
	uint64_t ticks = t.tools[0].lit_ticks;
	pthread_mutex_unlock(&t.lock);
	return ticks;
}

static void assert_a_loss_holds(moment at, loss kind)
{
	assert_true(done(take_over(0, 0)));
	request *enable = enable_meets(at, kind);
	bool taken = done(enable);
	assert_true(at != WAITING || !taken || kind == OFF_BY_ANOTHER);
	assert_true(at <= TAKEN || taken);
	await_steps(2); // the one that had begun, and one more
	uint64_t ticks = lit_ticks();
	await_steps(3);
	assert_int_equal(lit_ticks(), ticks);
	if (at <= APPLIED)
		assert_int_equal(ticks, 0);
	if (kind == FULL_STORE)
		cau_hosted_store_takes(t.h, true, NULL);
	assert_true(done(take_over(0, 0)));
	assert_true(done(energize(0, 0, true)));
	await_steps(2); // the first of them is checked tick by tick in check_tool
	assert_true(lit_ticks() > ticks);
	assert_true(done(energize(1, 0, false)));
	pthread_mutex_lock(&t.lock);
	t.tools[0].lit_ticks = 0;
	pthread_mutex_unlock(&t.lock);
}

static void a_loss_holds_at_every_moment_of_an_enable(void **state)
{
	(void)state;
	for (int at = WAITING; at < MOMENT_COUNT; at++)
		for (int kind = 0; kind < LOSS_COUNT; kind++) {
			assert_a_loss_holds((moment)at, (loss)kind);
			assert_all_well();
		}
}

static uint64_t next_random(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return *state >> 33;
}

static void await_turn(int client)
{
	pthread_mutex_lock(&t.lock);
	while (t.in_flight[client] >= IN_FLIGHT)
		pthread_cond_wait(&t.changed, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

// A pause is never refused; to resume needs a store that has room.
static void pause_and_resume(int client)
{
	ask(client, CAU_ORDER_PAUSE, CAU_METHOD_SESSION_PAUSE, 0);
	while (!done(ask(client, CAU_ORDER_RESUME, CAU_METHOD_SESSION_RESUME, 0))) {
		pthread_mutex_lock(&t.lock);
		while (t.full)
			pthread_cond_wait(&t.changed, &t.lock);
		pthread_mutex_unlock(&t.lock);
	}
}

// The store has room, or has not; who waits for room sees it once the session was told.
static void tell_room(bool room)
{
	if (room)
		cau_hosted_store_takes(t.h, true, NULL);
	pthread_mutex_lock(&t.lock);
	t.full = !room;
	pthread_cond_broadcast(&t.changed);
	pthread_mutex_unlock(&t.lock);
}

static void ask_something(int client, uint64_t *random)
{
	int tool = (int)(next_random(random) % TOOLS);
	uint64_t what = next_random(random) % 100;
	if (what < 35) {
		energize(client, tool, true);
	} else if (what < 50) {
		energize(client, tool, false);
	} else if (what < 75) {
		move(client, tool, 1e-4 * (double)(next_random(random) % 100));
	} else if (what < 96) {
		take_over(client, tool);
	} else if (what < 99) {
		pause_and_resume(client);
	} else { // longer than its deadline
		await_steps(20);
	}
}

static void *ask_at_random(void *user)
{
	int client = *(int *)user;
	uint64_t random = 71 + (uint64_t)client;
	for (int i = 0; i < ROUNDS; i++) {
		await_turn(client);
		ask_something(client, &random);
	}
	return NULL;
}

static void *lose_at_random(void *user)
{
	uint64_t random = 5;
	(void)user;
	while (!t.ended) {
		await_steps(1 + next_random(&random) % 4);
		for (uint64_t i = next_random(&random) % 512; i > 0; i--) // somewhere within a tick
			atomic_thread_fence(memory_order_seq_cst);
		int client = (int)(next_random(&random) % CLIENTS);
		uint64_t what = next_random(&random) % 10;
		if (what < 5) {
			lose(CUT, client);
		} else if (what < 8) {
			lose(FORGET, client);
		} else {
			tell_room(false);
			lose(FULL_STORE, client);
			tell_room(true);
		}
	}
	return NULL;
}

static void *watch(void *user)
{
	(void)user;
	while (!t.ended) {
		cau_hosted_watch(t.h, cau_monotonic_s());
		cau_hosted_feed(t.h, 1);
		await_steps(1);
	}
	return NULL;
}

static void nothing_is_lit_after_its_loss_whatever_comes_when(void **state)
{
	(void)state;
	int clients[CLIENTS] = {0, 1};
	pthread_t asking[CLIENTS], losing, watching;
	pthread_create(&losing, NULL, lose_at_random, NULL);
	pthread_create(&watching, NULL, watch, NULL);
	for (int i = 0; i < CLIENTS; i++)
		pthread_create(&asking[i], NULL, ask_at_random, &clients[i]);
	for (int i = 0; i < CLIENTS; i++)
		pthread_join(asking[i], NULL);
	await_answers();
	await_steps(2); // while losses still come
	pthread_mutex_lock(&t.lock);
	t.ended = true;
	pthread_cond_broadcast(&t.changed);
	pthread_mutex_unlock(&t.lock);
	pthread_join(losing, NULL);
	pthread_join(watching, NULL);
	assert_all_well();
	pthread_mutex_lock(&t.lock);
	uint64_t least = t.tools[0].lit_ticks;
	for (int i = 1; i < TOOLS; i++)
		least = t.tools[i].lit_ticks < least ? t.tools[i].lit_ticks : least;
	pthread_mutex_unlock(&t.lock);
	assert_true(least > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_loss_holds_at_every_moment_of_an_enable, begin, end),
		cmocka_unit_test_setup_teardown(nothing_is_lit_after_its_loss_whatever_comes_when, begin,
	                                    end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
