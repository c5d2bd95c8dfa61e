// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/faults.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

#include "hub/hub.h"
#include "quota/quota.h"
#include "rpc/internal.h"
#include "server/double/fake_session.h"
#include "session/internal.h"
#include "simulation/promises.h"
#include "simulation/scheduler.h"
#include "store/store.h"

#define WRAPPED __attribute__((used)) // called by the linker's --wrap
#define LATE_S 0.5

enum { UNBOUNDED = 8 }; // factor on a configured limit that gives a disabled limit

sim_fault sim_planted;
static sim_random choices;

static const struct {
	const char *word, *promise, *meaning;
	int64_t found_by;
} faults[FAULT_COUNT] = {
#define X(code, promise, found_by, meaning) [FAULT_##code] = {#code, #promise, meaning, found_by},
	FAULT_TABLE(X)
#undef X
};

const char *faults_word(sim_fault fault)
{
	return faults[fault].word;
}

const char *faults_promise(sim_fault fault)
{
	return faults[fault].promise;
}

const char *faults_meaning(sim_fault fault)
{
	return faults[fault].meaning;
}

int64_t faults_found_by(sim_fault fault)
{
	return faults[fault].found_by;
}

bool faults_act(sim_fault fault, int64_t one_in)
{
	return sim_planted == fault && sim_chance(&choices, one_in);
}

static bool breaks_off(void)
{
	return faults_act(FAULT_core_ignores_off, 3);
}

void faults_begin(uint64_t seed)
{
	choices = sim_random_of(seed, 9);
	cau_fake_hooks_set.breaks_off = breaks_off;
}

// ---- wakes
double __real_cau_hub_watch(cau_hub *hub, double now_s);
double __wrap_cau_hub_watch(cau_hub *hub, double now_s);
WRAPPED double __wrap_cau_hub_watch(cau_hub *hub, double now_s)
{
	double look_s = __real_cau_hub_watch(hub, now_s);
	return faults_act(FAULT_watchdog_oversleeps, 1) ? look_s + LATE_S : look_s;
}

void __real_cau_worker_pool_wake(cau_worker_pool *pool, cau_task *task);
void __wrap_cau_worker_pool_wake(cau_worker_pool *pool, cau_task *task);
WRAPPED void __wrap_cau_worker_pool_wake(cau_worker_pool *pool, cau_task *task)
{
	if (!faults_act(FAULT_worker_wake_lost, 3))
		__real_cau_worker_pool_wake(pool, task);
}

// ---- the store
static void forget_commit(void *user, cau_status status, const char *reason)
{
	(void)user, (void)status, (void)reason;
}

cau_status __real_cau_store_submit(cau_store *store, cau_store_batch *batch,
                                   cau_store_callback callback, void *user, cau_error *error);
cau_status __wrap_cau_store_submit(cau_store *store, cau_store_batch *batch,
                                   cau_store_callback callback, void *user, cau_error *error);
WRAPPED cau_status __wrap_cau_store_submit(cau_store *store, cau_store_batch *batch,
                                           cau_store_callback callback, void *user,
                                           cau_error *error)
{
	if (!faults_act(FAULT_early_acknowledgement, 1) || !callback)
		return __real_cau_store_submit(store, batch, callback, user, error);
	cau_status status = __real_cau_store_submit(store, batch, forget_commit, NULL, error);
	if (!status)
		callback(user, CAU_OK, "");
	return status;
}

cau_status __real_cau_store_execute(sqlite3 *database, const char *sql, const char *what,
                                    cau_error *error);
cau_status __wrap_cau_store_execute(sqlite3 *database, const char *sql, const char *what,
                                    cau_error *error);
WRAPPED cau_status __wrap_cau_store_execute(sqlite3 *database, const char *sql, const char *what,
                                            cau_error *error)
{
	char text[512];
	static const char full[] = "synchronous = FULL";
	snprintf(text, sizeof text, "%s", sql);
	char *found = strstr(text, full);
	if (!found || !faults_act(FAULT_commit_not_synced, 1))
		return __real_cau_store_execute(database, sql, what, error);
	memcpy(found, "synchronous = OFF ", sizeof full - 1);
	return __real_cau_store_execute(database, text, what, error);
}

cau_status __real_cau_store_put_command(cau_store_batch *batch, const cau_store_command *command,
                                        cau_error *error);
cau_status __wrap_cau_store_put_command(cau_store_batch *batch, const cau_store_command *command,
                                        cau_error *error);
WRAPPED cau_status __wrap_cau_store_put_command(cau_store_batch *batch,
                                                const cau_store_command *command, cau_error *error)
{
	return faults_act(FAULT_row_lost, 8) ? CAU_OK
	                                     : __real_cau_store_put_command(batch, command, error);
}

cau_status __real_cau_store_read_answer(cau_store *store, const char *client, uint64_t sequence,
                                        cau_store_visit_answer visit, void *user, cau_error *error);
cau_status __wrap_cau_store_read_answer(cau_store *store, const char *client, uint64_t sequence,
                                        cau_store_visit_answer visit, void *user, cau_error *error);
WRAPPED cau_status __wrap_cau_store_read_answer(cau_store *store, const char *client,
                                                uint64_t sequence, cau_store_visit_answer visit,
                                                void *user, cau_error *error)
{
	return faults_act(FAULT_resend_acts, 1)
	           ? CAU_NOT_FOUND
	           : __real_cau_store_read_answer(store, client, sequence, visit, user, error);
}

// ---- energy
void __real_cau_hosted_cut(cau_hosted *h, uint32_t client, const char *cause);
void __wrap_cau_hosted_cut(cau_hosted *h, uint32_t client, const char *cause);
WRAPPED void __wrap_cau_hosted_cut(cau_hosted *h, uint32_t client, const char *cause)
{
	if (!faults_act(FAULT_loss_not_cut, 1) || !strstr(cause, "lost"))
		__real_cau_hosted_cut(h, client, cause);
}

void __real_cau_hub_heartbeat(cau_hub *hub, uint32_t number, bool visible, double alive_s);
void __wrap_cau_hub_heartbeat(cau_hub *hub, uint32_t number, bool visible, double alive_s);
WRAPPED void __wrap_cau_hub_heartbeat(cau_hub *hub, uint32_t number, bool visible, double alive_s)
{
	__real_cau_hub_heartbeat(hub, number, visible || faults_act(FAULT_hidden_page_ignored, 1),
	                         alive_s);
}

void __real_cau_drive_cut_energized(cau_logic *logic, uint64_t moment, int energy_off,
                                    const char *cause, cau_effects *effects);
void __wrap_cau_drive_cut_energized(cau_logic *logic, uint64_t moment, int energy_off,
                                    const char *cause, cau_effects *effects);
WRAPPED void __wrap_cau_drive_cut_energized(cau_logic *logic, uint64_t moment, int energy_off,
                                            const char *cause, cau_effects *effects)
{
	if (strcmp(cause, "paused") != 0 || !faults_act(FAULT_pause_keeps_energy, 1))
		__real_cau_drive_cut_energized(logic, moment, energy_off, cause, effects);
}

void __real_cau_drive_cut_silent(cau_logic *logic, double now_s, cau_effects *effects);
void __wrap_cau_drive_cut_silent(cau_logic *logic, double now_s, cau_effects *effects);
WRAPPED void __wrap_cau_drive_cut_silent(cau_logic *logic, double now_s, cau_effects *effects)
{
	if (logic->lockstep && faults_act(FAULT_ticks_not_counted, 1))
		logic->advance_tick = logic->tick;
	if (!faults_act(FAULT_silence_not_cut, 1))
		__real_cau_drive_cut_silent(logic, now_s, effects);
}

void __real_cau_hosted_feed(cau_hosted *h, uint32_t client, double alive_s);
void __wrap_cau_hosted_feed(cau_hosted *h, uint32_t client, double alive_s);
WRAPPED void __wrap_cau_hosted_feed(cau_hosted *h, uint32_t client, double alive_s)
{
	__real_cau_hosted_feed(h, client, alive_s);
	for (uint32_t other = 1; other <= CLIENTS && faults_act(FAULT_others_feed, 1); other++)
		__real_cau_hosted_feed(h, other, alive_s);
}

double __real_cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                                    double deadline_s);
double __wrap_cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                                    double deadline_s);
WRAPPED double __wrap_cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s,
                                            double client_s, double deadline_s)
{
	__real_cau_sign_of_life_hear(sign, arrival_s, client_s, deadline_s);
	if (faults_act(FAULT_late_beats_count, 1))
		sign->alive_s = arrival_s;
	return sign->alive_s;
}

void __real_cau_hosted_store_takes(cau_hosted *h, bool takes, const char *reason);
void __wrap_cau_hosted_store_takes(cau_hosted *h, bool takes, const char *reason);
WRAPPED void __wrap_cau_hosted_store_takes(cau_hosted *h, bool takes, const char *reason)
{
	if (takes)
		promises_store_takes(cau_hosted_id(h), true);
	if (!faults_act(FAULT_store_full_ignored, 1))
		__real_cau_hosted_store_takes(h, takes, reason);
	if (!takes)
		promises_store_takes(cau_hosted_id(h), false);
}

// ---- orders and answers
void __real_cau_queue_take(cau_logic *logic, const cau_asked *asked, cau_effects *effects);
void __wrap_cau_queue_take(cau_logic *logic, const cau_asked *asked, cau_effects *effects);
WRAPPED void __wrap_cau_queue_take(cau_logic *logic, const cau_asked *asked, cau_effects *effects)
{
	__real_cau_queue_take(logic, asked, effects);
	if (logic->count < 2 || !faults_act(FAULT_orders_swapped, 4))
		return;
	cau_asked *one = &logic->waiting[logic->count - 2].asked;
	cau_asked *other = &logic->waiting[logic->count - 1].asked, kept = *one;
	if (one->ask != CAU_ASK_TISSUE || other->ask != CAU_ASK_TISSUE)
		return;
	*one = *other;
	*other = kept;
}

cau_status __real_cau_session_submit(cau_session *session, const cau_command *command,
                                     cau_error *error);
cau_status __wrap_cau_session_submit(cau_session *session, const cau_command *command,
                                     cau_error *error);
WRAPPED cau_status __wrap_cau_session_submit(cau_session *session, const cau_command *command,
                                             cau_error *error)
{
	if (command->kind == CAU_COMMAND_SET_GRAVITY && faults_act(FAULT_command_twice, 30))
		__real_cau_session_submit(session, command, error);
	return __real_cau_session_submit(session, command, error);
}

void __real_cau_service_answer(void *user, const cau_reply *reply, const cau_outcome *outcome);
void __wrap_cau_service_answer(void *user, const cau_reply *reply, const cau_outcome *outcome);
WRAPPED void __wrap_cau_service_answer(void *user, const cau_reply *reply,
                                       const cau_outcome *outcome)
{
	if (faults_act(FAULT_answer_lost, 50))
		return;
	__real_cau_service_answer(user, reply, outcome);
	if (!outcome->joined && !outcome->file && faults_act(FAULT_answer_twice, 50))
		__real_cau_service_answer(user, reply, outcome);
}

// ---- streams
uint64_t __real_cau_streams_restart(cau_streams *streams);
uint64_t __wrap_cau_streams_restart(cau_streams *streams);
WRAPPED uint64_t __wrap_cau_streams_restart(cau_streams *streams)
{
	return streams->epoch && faults_act(FAULT_epoch_kept, 1) ? streams->epoch
	                                                         : __real_cau_streams_restart(streams);
}

cau_buffer *__real_cau_streams_next_frame(cau_streams *streams, cau_subscriber *subscriber,
                                          double now_s, bool *wake);
cau_buffer *__wrap_cau_streams_next_frame(cau_streams *streams, cau_subscriber *subscriber,
                                          double now_s, bool *wake);
WRAPPED cau_buffer *__wrap_cau_streams_next_frame(cau_streams *streams, cau_subscriber *subscriber,
                                                  double now_s, bool *wake)
{
	cau_buffer *frame = __real_cau_streams_next_frame(streams, subscriber, now_s, wake);
	if (!frame || !faults_act(FAULT_frame_lost, 60))
		return frame;
	cau_buffer_release(frame);
	return __real_cau_streams_next_frame(streams, subscriber, now_s, wake);
}

// ---- tokens
bool __real_cau_auth_role(const cau_auth *auth, const char *token, size_t bytes, cau_role *role);
bool __wrap_cau_auth_role(const cau_auth *auth, const char *token, size_t bytes, cau_role *role);
WRAPPED bool __wrap_cau_auth_role(const cau_auth *auth, const char *token, size_t bytes,
                                  cau_role *role)
{
	bool known = __real_cau_auth_role(auth, token, bytes, role);
	if (known && faults_act(FAULT_every_token_is_admin, 1))
		*role = CAU_ROLE_ADMIN;
	return known;
}

bool __real_cau_auth_grant_bounds(const cau_auth *auth, uint64_t grant, cau_auth_bounds *bounds);
bool __wrap_cau_auth_grant_bounds(const cau_auth *auth, uint64_t grant, cau_auth_bounds *bounds);
WRAPPED bool __wrap_cau_auth_grant_bounds(const cau_auth *auth, uint64_t grant,
                                          cau_auth_bounds *bounds)
{
	bool known = __real_cau_auth_grant_bounds(auth, grant, bounds);
	if (known && faults_act(FAULT_sessions_unbounded, 1))
		bounds->sessions[0] = 0;
	return known;
}

cau_status __real_cau_quota_take(cau_quota *quota, cau_allowance *connection,
                                 const cau_quota_token *token, const char *address, cau_role role,
                                 double now_s, cau_error *error);
cau_status __wrap_cau_quota_take(cau_quota *quota, cau_allowance *connection,
                                 const cau_quota_token *token, const char *address, cau_role role,
                                 double now_s, cau_error *error);
WRAPPED cau_status __wrap_cau_quota_take(cau_quota *quota, cau_allowance *connection,
                                         const cau_quota_token *token, const char *address,
                                         cau_role role, double now_s, cau_error *error)
{
	return faults_act(FAULT_quota_ignored, 1)
	           ? CAU_OK
	           : __real_cau_quota_take(quota, connection, token, address, role, now_s, error);
}

// ---- bounds
void __real_cau_streams_init(cau_streams *streams);
void __wrap_cau_streams_init(cau_streams *streams);
WRAPPED void __wrap_cau_streams_init(cau_streams *streams)
{
	__real_cau_streams_init(streams);
	if (faults_act(FAULT_flight_unbounded, 1))
		streams->in_flight_most *= UNBOUNDED;
}

size_t __real_cau_logic_bytes(int32_t capacity);
size_t __wrap_cau_logic_bytes(int32_t capacity);
WRAPPED size_t __wrap_cau_logic_bytes(int32_t capacity)
{
	return __real_cau_logic_bytes(sim_planted == FAULT_queue_unbounded ? UNBOUNDED * capacity
	                                                                   : capacity);
}

void __real_cau_logic_init(cau_logic *logic, int32_t capacity);
void __wrap_cau_logic_init(cau_logic *logic, int32_t capacity);
WRAPPED void __wrap_cau_logic_init(cau_logic *logic, int32_t capacity)
{
	__real_cau_logic_init(logic,
	                      sim_planted == FAULT_queue_unbounded ? UNBOUNDED * capacity : capacity);
}

void __real_cau_hosted_go_away(cau_hosted *h, const cau_moved_to *to);
void __wrap_cau_hosted_go_away(cau_hosted *h, const cau_moved_to *to);
WRAPPED void __wrap_cau_hosted_go_away(cau_hosted *h, const cau_moved_to *to)
{
	if (faults_act(FAULT_source_serves_on, 1))
		cau_hosted_go_on(h);
	else
		__real_cau_hosted_go_away(h, to);
}

cau_due __real_cau_hosted_run(cau_task *task);
cau_due __wrap_cau_hosted_run(cau_task *task);
WRAPPED cau_due __wrap_cau_hosted_run(cau_task *task)
{
	cau_due next = __real_cau_hosted_run(task);
	if (faults_act(FAULT_session_starved, 20))
		next.due_s += LATE_S;
	return next;
}
