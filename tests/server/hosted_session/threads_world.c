// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/hosted_session/threads_world.h"

#include <assert.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "server/double/fake_session.h"

threads_world threads;

static const char *const tool_names[TOOLS] = {"hook", "probe"};

// ---- observations -------------------------------------------------------------------------------

static void note_wrong(const char *what, uint64_t tick, int tool)
{
	if (!threads.wrongs++)
		snprintf(threads.wrong, sizeof threads.wrong, "%s: tick %llu, tool %s", what,
		         (unsigned long long)tick, tool_names[tool]);
}

static void meet(moment here)
{
	int wanted = (int)here;
	if (!atomic_compare_exchange_strong(&threads.wanted, &wanted, NOWHERE))
		return;
	pthread_barrier_wait(&threads.met);
	pthread_barrier_wait(&threads.over);
}

// Returns the client of an enable. The number of the enable contains the client.
static int client_of(uint64_t asked)
{
	return (int)(asked % CLIENTS);
}

static void see_submit(const cau_command *command)
{
	if (command->kind != CAU_COMMAND_TOOL_ENERGIZE || !command->as.energized)
		return;
	pthread_mutex_lock(&threads.lock);
	for (int i = 0; i < TOOLS; i++)
		if (strcmp(command->tool, tool_names[i]) == 0)
			threads.tools[i].asked = command->sequence;
	pthread_mutex_unlock(&threads.lock);
	meet(TAKEN);
}

static void check_tool(int i, uint64_t tick, bool energized)
{
	tool_book *book = &threads.tools[i];
	const loss_mark *mark = &threads.marks[client_of(book->asked)];
	bool decided = book->on_from <= tick && (book->on || tick < book->off_from);
	book->energized_ticks += energized;
	if (energized && !decided)
		note_wrong("energy is on after it was cut", tick, i);
	if (!energized && decided)
		note_wrong("energy is off though it was enabled", tick, i);
	if (energized && book->asked <= mark->asked && tick >= mark->from_tick)
		note_wrong("an enable from before the loss turned energy on", tick, i);
}

static void see_step(const cau_session *session)
{
	cau_frame frame;
	bool energized = false;
	cau_session_frame(session, &frame);
	pthread_mutex_lock(&threads.lock);
	assert(frame.tool_count <= TOOLS);
	for (int32_t i = 0; i < frame.tool_count; i++) {
		check_tool((int)i, frame.tick, frame.tools[i].energized);
		energized = energized || frame.tools[i].energized;
	}
	threads.steps++;
	pthread_cond_broadcast(&threads.changed);
	pthread_mutex_unlock(&threads.lock);
	meet(energized ? STEPPING : WAITING);
}

// Returns the first tick that has not begun. Called under the session's lock.
static uint64_t next_tick(const cau_hosted *h)
{
	return h->decisions.logic->tick + (h->decisions.logic->acting == CAU_ACT_STEP);
}

// Called under the session's lock, so that the decisions are those of the notification.
static void see_drives(const cau_hosted *h)
{
	pthread_mutex_lock(&threads.lock);
	for (int i = 0; i < TOOLS; i++) {
		const cau_drive *drive = cau_logic_drive(h->decisions.logic, tool_names[i]);
		tool_book *book = &threads.tools[i];
		if (!drive || drive->enabled == book->on)
			continue;
		book->on = drive->enabled;
		*(book->on ? &book->on_from : &book->off_from) = next_tick(h);
	}
	pthread_mutex_unlock(&threads.lock);
}

static void notify(void *user, cau_audience audience, cau_buffer *text)
{
	(void)user, (void)audience;
	static const char told[] = "tool.driver_changed";
	cau_hosted *h = threads.h;
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

// Called when the store begins to write, because it asks for the time then.
static int64_t see_commit(void)
{
	struct timespec now;
	bool energized = false;
	clock_gettime(CLOCK_REALTIME, &now);
	pthread_mutex_lock(&threads.lock);
	for (int i = 0; i < TOOLS; i++)
		energized = energized || threads.tools[i].on;
	pthread_mutex_unlock(&threads.lock);
	if (energized)
		meet(COMMITTING);
	return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static void see_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)reply;
	request *r = user;
	r->failed = outcome->error != NULL;
	pthread_mutex_lock(&threads.lock);
	r->answers++;
	threads.answered++;
	threads.in_flight[r->client]--;
	pthread_cond_broadcast(&threads.changed);
	pthread_mutex_unlock(&threads.lock);
}

// ---- requests -----------------------------------------------------------------------------------

static cau_order *new_order(int client, cau_order_kind kind, cau_method method, request **asked)
{
	cau_order *order = calloc(1, sizeof *order);
	int number = threads.request_count++;
	assert(number < REQUESTS);
	request *r = *asked = &threads.requests[number];
	r->client = client;
	order->kind = kind;
	order->asker = (cau_asker){
		.client = (uint32_t)client + 1, .role = CAU_ROLE_ADMIN, .deadline_s = client ? 0.02 : 60};
	snprintf(order->asker.name, sizeof order->asker.name, "client %d", client);
	snprintf(order->asker.client_id, sizeof order->asker.client_id, "client-%d", client);
	order->client_sequence = r - threads.requests + 1;
	order->reply = (cau_reply){.answer = see_answer, .user = r, .method = method};
	return order;
}

// Submits an order. If it is refused at once, answers its request here.
static void submit(cau_order *order, request *r)
{
	cau_error error = {0};
	cau_outcome refused = {.error = &error};
	pthread_mutex_lock(&threads.lock);
	threads.in_flight[r->client]++;
	pthread_mutex_unlock(&threads.lock);
	if (!cau_hosted_submit(threads.h, order, &error))
		return;
	see_answer(r, &order->reply, &refused);
	free(order);
}

request *threads_ask(int client, cau_order_kind kind, cau_method method, int tool)
{
	request *r;
	cau_order *order = new_order(client, kind, method, &r);
	if (kind == CAU_ORDER_TAKE_OVER)
		snprintf(order->as.tool.tool, sizeof order->as.tool.tool, "%s", tool_names[tool]);
	submit(order, r);
	return r;
}

request *threads_take_over(int client, int tool)
{
	return threads_ask(client, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER, tool);
}

request *threads_energize(int client, int tool, bool on)
{
	request *r;
	cau_order *order = new_order(client, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE, &r);
	cau_command *command = &order->as.command;
	cau_default_command(command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(command->tool, sizeof command->tool, "%s", tool_names[tool]);
	command->as.energized = on;
	uint64_t number = command->sequence =
		(uint64_t)(r - threads.requests + 1) * CLIENTS + (uint64_t)client;
	submit(order, r);
	if (on)
		threads.asked[client] = number;
	return r;
}

void threads_move(int client, int tool, double x_m)
{
	cau_error error = {0};
	cau_order *order = calloc(1, sizeof *order);
	order->kind = CAU_ORDER_COMMAND;
	order->motion = true;
	order->asker = (cau_asker){.client = (uint32_t)client + 1, .role = CAU_ROLE_ADMIN};
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_MOVE);
	snprintf(order->as.command.tool, sizeof order->as.command.tool, "%s", tool_names[tool]);
	order->as.command.as.move.pose.position_m[0] = x_m;
	if (cau_hosted_submit(threads.h, order, &error))
		free(order);
}

bool threads_done(request *r)
{
	pthread_mutex_lock(&threads.lock);
	while (!r->answers)
		pthread_cond_wait(&threads.changed, &threads.lock);
	pthread_mutex_unlock(&threads.lock);
	return !r->failed;
}

void threads_await_steps(uint64_t count)
{
	pthread_mutex_lock(&threads.lock);
	uint64_t until = threads.steps + count;
	while (threads.steps < until && !threads.ended)
		pthread_cond_wait(&threads.changed, &threads.lock);
	pthread_mutex_unlock(&threads.lock);
}

// ---- losses -------------------------------------------------------------------------------------

// Notes that the client's requests up to `asked` heat no tick that begins from now on.
static void mark_loss(int client, uint64_t asked)
{
	cau_hosted *h = threads.h;
	pthread_mutex_lock(&h->decisions.lock);
	pthread_mutex_lock(&threads.lock);
	threads.marks[client] = (loss_mark){asked, next_tick(h)};
	pthread_mutex_unlock(&threads.lock);
	pthread_mutex_unlock(&h->decisions.lock);
}

void threads_lose(loss kind, int client)
{
	uint64_t asked[CLIENTS] = {threads.asked[0], threads.asked[1]};
	if (kind == CUT)
		cau_hosted_cut(threads.h, (uint32_t)client + 1, "its connection is lost");
	else if (kind == FORGET)
		cau_hosted_forget_client(threads.h, (uint32_t)client + 1);
	else if (kind == FULL_STORE)
		cau_hosted_store_takes(threads.h, false, "a test");
	else
		threads_energize(!client, 0, false);
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
	scene->step_s = 0.002; // gives many ticks in little time
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
	cau_config_default(&threads.config);
	snprintf(threads.folder, sizeof threads.folder, "/tmp/cautery-threads-XXXXXX");
	assert_non_null(mkdtemp(threads.folder));
	snprintf(threads.file, sizeof threads.file, "%s/store.db", threads.folder);
	of_store.path = threads.file;
	of_store.commit_delay_ms = 0;
	of_store.wall_clock_ms = see_commit;
	assert_int_equal(cau_store_open(&of_store, &threads.store, NULL), CAU_OK);
	threads.around = (cau_surroundings){.config = &threads.config,
	                                    .store = threads.store,
	                                    .memory_held = &threads.memory_held,
	                                    .beginnings = &threads.beginnings,
	                                    .armed = see_armed,
	                                    .sink = {NULL, notify, see_frames, see_slice}};
	assert_int_equal(cau_worker_pool_create(&threads.around.pool, 2, 4, 0, NULL), CAU_OK);
	assert_int_equal(cau_builder_create(&threads.around.builder, "cautery-build", 1, 0, NULL),
	                 CAU_OK);
	cau_beginnings_init(&threads.beginnings);
}

int threads_begin(void **state)
{
	(void)state;
	cau_hosted *h;
	request *r = &threads.requests[0];
	memset(&threads, 0, sizeof threads);
	pthread_mutex_init(&threads.lock, NULL);
	pthread_cond_init(&threads.changed, NULL);
	pthread_barrier_init(&threads.met, NULL, 2);
	pthread_barrier_init(&threads.over, NULL, 2);
	cau_log_set_level("error");
	cau_fake_hooks_set = (cau_fake_hooks){.submit = see_submit, .step = see_step};
	open_surroundings();
	threads.request_count = threads.in_flight[0] = 1;
	cau_hosted_def def = {
		.id = "d1-threads",
		.number = 1,
		.scene = make_scene(),
		.reply = {.answer = see_answer, .user = r, .method = CAU_METHOD_SESSION_CREATE}};
	assert_int_equal(cau_hosted_create(&h, &threads.around, &def, NULL), CAU_OK);
	threads.h = h;
	assert_true(threads_done(r));
	return 0;
}

int threads_end(void **state)
{
	(void)state;
	cau_hosted_stop(threads.h);
	cau_store_flush(threads.store);
	cau_hosted_release(threads.h);
	cau_worker_pool_destroy(threads.around.pool);
	cau_builder_stop(threads.around.builder);
	cau_builder_destroy(threads.around.builder);
	cau_beginnings_finish(&threads.beginnings);
	cau_store_close(threads.store);
	pthread_barrier_destroy(&threads.met);
	pthread_barrier_destroy(&threads.over);
	pthread_cond_destroy(&threads.changed);
	pthread_mutex_destroy(&threads.lock);
	unlink(threads.file);
	return rmdir(threads.folder);
}

void threads_await_answers(void)
{
	pthread_mutex_lock(&threads.lock);
	while (threads.answered < (uint64_t)threads.request_count)
		pthread_cond_wait(&threads.changed, &threads.lock);
	pthread_mutex_unlock(&threads.lock);
}
