// SPDX-License-Identifier: GPL-3.0-or-later
#include "daemon/daemon.h"

#include <math.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include "agent/agent.h"
#include "auth/auth.h"
#include "builder/builder.h"
#include "clock/clock.h"
#include "daemon/reports.h"
#include "http/static_files.h"
#include "hub/hub.h"
#include "lease/lease.h"
#include "log/log.h"
#include "move/move.h"
#include "places/places.h"
#include "rpc/service.h"
#include "transport_dds/dds_transport.h"
#include "transport_ws/network.h"
#include "watchdog/watchdog.h"
#include "worker/pool.h"

enum {
	CLOSING_S = 2, // longest time for connections to take their close frames
	REAP_MS = 250,
	SCENES_S = 1,         // time between checks of the folder of scenes
	LAST_WORD_US = 50000, // longest time for the log to take the last line before the process ends
};

struct cau_daemon {
	cau_config *config;
	cau_auth *auth;
	cau_static_files *files;
	cau_static_files *manual; // NULL if no manual is installed
	cau_scenes *scenes;
	cau_store *store, *memory; // memory: the store of ephemeral sessions
	cau_lease *lease;          // NULL if not configured
	cau_worker_pool *pool;
	cau_builder *builder, *mover;
	cau_hub *hub;
	cau_moves *moves;
	cau_watchdog *watchdog;
	cau_service *service;
	cau_network *network;
	cau_dds *dds;     // NULL if not configured
	cau_agent *agent; // NULL if not configured
	cau_load_meter meter;
	cau_restart restart;
	atomic_bool draining, stands_aside;
	unsigned long ticks_seen;
	// these threads have run since the last notice to systemd
	bool network_moved, store_moved, watchdog_moved;
	// time of the next check of the folder of scenes
	double scenes_due_s;
};

static void on_armed(void *user)
{
	cau_daemon *daemon = user;
	cau_watchdog_wake(daemon->watchdog);
}

// Checks the sessions' deadlines and the lease, on the watchdog's thread. The lease is checked here
// too, because the thread that renews it may be stuck.
static double on_look(void *user, double now_s)
{
	cau_daemon *daemon = user;
	double look_s = cau_hub_watch(daemon->hub, now_s);
	return daemon->lease ? fmin(look_s, now_s + cau_lease_check(daemon->lease)) : look_s;
}

// ---- losing the label
// Ends the process as a kill would. The store withstands a kill: acknowledged records are on the
// disk. Energy ends with the process, and no client gets another message. If the reader of the log
// blocks, the kernel's timer signal still ends the process.
__attribute__((noreturn)) static void on_label_lost(void *user, const char *reason)
{
	const cau_daemon *daemon = user;
	const struct itimerval at_once = {.it_value.tv_usec = LAST_WORD_US};
	signal(SIGALRM, SIG_DFL);
	setitimer(ITIMER_REAL, &at_once, NULL);
	cau_log(CAU_LOG_ERROR, NULL, "label_lost", "label=%s reason=\"%s\"", daemon->config->label,
	        reason);
	_exit(EXIT_FAILURE);
}

// Checks the lease on the store thread, so that no commit is acknowledged once another daemon may
// have the label.
static void on_commit(void *user)
{
	cau_daemon *daemon = user;
	if (daemon->lease)
		cau_lease_check(daemon->lease);
}

static void note_stored(void *user, cau_status status, const char *reason)
{
	cau_fail(user, status, "store", "%s", reason);
}

static cau_status store_generation(void *user, const char *text, cau_error *error)
{
	cau_daemon *daemon = user;
	cau_error stored = {0};
	cau_store_batch *batch = cau_store_batch_create();
	if (!batch)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the generation");
	cau_status status = cau_store_put_generation(batch, text, error);
	if (!status)
		status = cau_store_submit(daemon->store, batch, note_stored, &stored, error);
	if (status) {
		cau_store_batch_destroy(batch);
		return status;
	}
	cau_store_flush(daemon->store);
	if (stored.status && error)
		*error = stored;
	return stored.status;
}

static cau_status take_label(cau_daemon *daemon, cau_error *error)
{
	const cau_config *config = daemon->config;
	char stored[CAU_STORE_ID_BYTES];
	_Static_assert((int)CAU_LEASE_STORED_BYTES <= CAU_STORE_ID_BYTES, "the store takes it");
	cau_lease *lease = NULL;
	cau_lease_def def = {.addresses = config->etcd,
	                     .label = config->label,
	                     .store = config->store,
	                     .ttl_s = config->etcd_ttl_s,
	                     .take_label = config->take_label,
	                     .stored = stored,
	                     .store_generation = store_generation,
	                     .lost = on_label_lost,
	                     .user = daemon};
	cau_status status = cau_store_read_generation(daemon->store, stored, error);
	if (!status)
		status = cau_lease_take(&lease, &def, error);
	daemon->lease = lease;
	return status;
}

static void tell_state(cau_daemon *daemon, bool ephemeral, cau_store_state state,
                       const char *reason)
{
	// The sessions are notified before the log, because a reader of the log may act on the line at
	// once.
	if (daemon->hub)
		cau_hub_store_takes(daemon->hub, ephemeral, state == CAU_STORE_READY, reason);
	cau_log(state == CAU_STORE_READY ? CAU_LOG_NOTICE : CAU_LOG_ERROR, NULL,
	        ephemeral ? "memory_state" : "store_state", "state=%s reason=\"%s\"",
	        cau_store_state_name(state), reason);
}

// Callbacks of the two stores, on their store threads.
static void on_store_state(void *user, cau_store_state state, const char *reason)
{
	tell_state(user, false, state, reason);
}

static void on_memory_state(void *user, cau_store_state state, const char *reason)
{
	tell_state(user, true, state, reason);
}

// Logs a change of the budget's state, on the store thread.
static void on_store_budget(void *user, cau_store_budget_state state, int64_t bytes,
                            int64_t dropped)
{
	static const char *const words[] = {[CAU_STORE_BUDGET_KEPT] = "kept",
	                                    [CAU_STORE_BUDGET_SHRINKING] = "shrinking",
	                                    [CAU_STORE_BUDGET_BEYOND] = "beyond"};
	const cau_daemon *daemon = user;
	cau_log(state == CAU_STORE_BUDGET_BEYOND ? CAU_LOG_WARNING : CAU_LOG_NOTICE, NULL,
	        "store_budget", "state=%s bytes=%lld most=%lld dropped=%lld", words[state],
	        (long long)bytes, (long long)daemon->config->store_bytes, (long long)dropped);
}

static cau_status open_store(cau_daemon *daemon, cau_error *error)
{
	const cau_config *config = daemon->config;
	cau_store_config store = cau_store_default_config();
	store.path = config->store;
	store.label = config->label;
	store.retention_bytes = config->retention_bytes;
	store.retention_age_ms = (int64_t)(config->retention_h * 3.6e6);
	store.store_bytes = config->store_bytes;
	store.on_state = on_store_state;
	store.on_budget = on_store_budget;
	store.on_commit = on_commit;
	store.user = daemon;
	return cau_store_open(&store, &daemon->store, error);
}

// Opens the store of ephemeral sessions. It has no disk, so a commit never waits to be joined with
// later batches.
static cau_status open_memory(cau_daemon *daemon, cau_error *error)
{
	cau_store_config memory = cau_store_default_config();
	memory.memory = true;
	memory.commit_delay_ms = 0;
	memory.store_bytes = memory.retention_bytes = daemon->config->ephemeral_bytes;
	memory.on_state = on_memory_state;
	memory.user = daemon;
	return cau_store_open(&memory, &daemon->memory, error);
}

static int32_t count_workers(const cau_config *config)
{
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	return config->workers ? (int32_t)config->workers : cores > 0 ? (int32_t)cores : 1;
}

// Returns the number of builder threads: one for each worker, up to the limit.
static int32_t count_builders(int32_t workers)
{
	return workers < CAU_BUILDER_THREADS_MOST ? workers : CAU_BUILDER_THREADS_MOST;
}

static cau_status open_moves(cau_daemon *daemon, cau_error *error)
{
	cau_moves_def def = {.config = daemon->config,
	                     .store = daemon->store,
	                     .mover = daemon->mover,
	                     .hub = daemon->hub};
	return cau_moves_create(&daemon->moves, &def, error);
}

static cau_status open_hub(cau_daemon *daemon, cau_error *error)
{
	cau_config *config = daemon->config;
	int32_t workers = count_workers(config);
	cau_status status = cau_worker_pool_create(
		&daemon->pool, workers, 2 * (int32_t)config->max_sessions + 1, CAU_NICE_LAST, error);
	if (!status)
		status = cau_builder_create(&daemon->builder, "cautery-build", count_builders(workers),
		                            CAU_NICE_BUILDER, error);
	// Moves have a builder of their own, at a higher priority than the other builder: a client that
	// waits for a moving session must not wait for processor time that workers leave.
	if (!status)
		status = cau_builder_create(&daemon->mover, "cautery-move", 1, CAU_NICE_LAST, error);
	cau_hub_def def = {.config = config,
	                   .store = daemon->store,
	                   .memory = daemon->memory,
	                   .pool = daemon->pool,
	                   .builder = daemon->builder,
	                   .mover = daemon->mover,
	                   .scenes = daemon->scenes,
	                   .armed = on_armed,
	                   .user = daemon};
	if (!status)
		status = cau_hub_create(&daemon->hub, &def, error);
	if (!status)
		status = open_moves(daemon, error);
	if (!status)
		status = cau_watchdog_create(&daemon->watchdog, on_look, daemon, error);
	return status;
}

static cau_status open_network(cau_daemon *daemon, cau_error *error)
{
	cau_service_def of_service = {.config = daemon->config,
	                              .auth = daemon->auth,
	                              .hub = daemon->hub,
	                              .moves = daemon->moves,
	                              .store = daemon->store,
	                              .builder = daemon->builder};
	cau_status status = cau_service_create(&daemon->service, &of_service, error);
	if (status)
		return status;
	cau_network_def def = {.config = daemon->config,
	                       .auth = daemon->auth,
	                       .files = daemon->files,
	                       .manual = daemon->manual,
	                       .handler = cau_service_handler(daemon->service)};
	status = cau_network_create(&daemon->network, &def, error);
	if (!status)
		cau_service_set_network(daemon->service, daemon->network);
	return status;
}

// Measures the load, on the agent's thread. `takes`: the daemon accepts new sessions.
static void measure_load(void *user, cau_load *load)
{
	cau_daemon *daemon = user;
	cau_store_health health;
	cau_store_get_health(daemon->store, &health);
	load->takes = cau_hub_resuming(daemon->hub) == 0 && health.state == CAU_STORE_READY &&
	              !daemon->draining && !daemon->stands_aside;
	cau_load_meter_read(&daemon->meter, load);
}

static cau_status open_agent(cau_daemon *daemon, cau_error *error)
{
	const cau_config *config = daemon->config;
	cau_load_meter_init(&daemon->meter, config, daemon->hub, count_workers(config));
	cau_agent_def def = {.address = config->listen,
	                     .port = (int)config->agent_port,
	                     .measure = measure_load,
	                     .user = daemon};
	return cau_agent_create(&daemon->agent, &def, error);
}

// Finds the folders of viewer, manual and scenes. Only the scenes are required. Without a viewer, a
// plain page says that there is none. Without a manual, the manual's addresses answer that there is
// none.
static cau_status find_files(cau_config *config, cau_error *error)
{
	if (!*config->viewer)
		cau_place_find("viewer", config->viewer, sizeof config->viewer);
	if (!*config->manual)
		cau_place_find("manual", config->manual, sizeof config->manual);
	if (*config->scenes || cau_place_find("scenes", config->scenes, sizeof config->scenes))
		return CAU_OK;
	return cau_fail(error, CAU_NOT_FOUND, "scenes",
	                "the folder ../share/cautery/scenes beside this program is missing: give the "
	                "folder of scenes with the setting scenes");
}

// Opens DDS. With `dds_optional` the daemon continues without DDS if the machine lacks ports or an
// interface for it. Wrong settings, roles or identities always end the daemon.
static cau_status open_dds(cau_daemon *daemon, cau_error *error)
{
	cau_status status = cau_dds_create(&daemon->dds, daemon->config, daemon->hub, error);
	bool missing = status == CAU_LIMIT || status == CAU_IO || status == CAU_UNSUPPORTED;
	if (!status || !daemon->config->dds_optional || !missing || strcmp(error->path, "dds") != 0)
		return status;
	cau_log(CAU_LOG_WARNING, NULL, "dds_not_open", "reason=\"%s\"", error->reason);
	daemon->config->dds = false;
	return CAU_OK;
}

static cau_status open_all(cau_daemon *daemon, cau_error *error)
{
	int32_t resumed = 0;
	cau_config *config = daemon->config;
	cau_status status = find_files(config, error);
	if (!status)
		status = cau_auth_create(&daemon->auth, config, error);
	if (!status)
		status = cau_static_files_load(&daemon->files, "viewer", config->viewer, error);
	if (!status && *config->manual)
		status = cau_static_files_load(&daemon->manual, "manual", config->manual, error);
	if (!status)
		status = cau_scenes_load(&daemon->scenes, config->scenes, error);
	if (!status)
		status = open_store(daemon, error);
	if (!status)
		status = open_memory(daemon, error);
	if (!status && *config->etcd)
		status = take_label(daemon, error);
	if (!status)
		status = open_hub(daemon, error);
	if (!status)
		status = open_network(daemon, error);
	if (!status && config->dds)
		status = open_dds(daemon, error);
	if (daemon->dds)
		cau_service_add_metrics(daemon->service, cau_dds_write_metrics, daemon->dds);
	if (!status)
		status = cau_moves_resume(daemon->moves, error);
	if (!status)
		status = cau_hub_resume(daemon->hub, &resumed, error);
	cau_restart_begin(&daemon->restart, daemon->hub, resumed);
	if (!status)
		status = cau_network_start(daemon->network, error);
	if (!status && daemon->dds)
		status = cau_dds_start(daemon->dds, error);
	if (!status && config->agent_port)
		status = open_agent(daemon, error);
	return status;
}

cau_status cau_daemon_start(cau_daemon **made, cau_config *config, cau_error *error)
{
	*made = NULL;
	cau_daemon *daemon = calloc(1, sizeof *daemon);
	if (!daemon)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the daemon");
	daemon->config = config;
	cau_status status = open_all(daemon, error);
	if (status) {
		cau_daemon_stop(daemon);
		return status;
	}
	cau_log(CAU_LOG_NOTICE, NULL, "listening", "address=%s port=%lld store=\"%s\"", config->listen,
	        (long long)config->port, config->store);
	sd_notify(0, "READY=1");
	*made = daemon;
	return CAU_OK;
}

// Notifies systemd that the daemon is alive, if the network, store and watchdog threads have all
// run. Network and watchdog turn energy off, and nothing is acknowledged without the store. So if
// any of these three threads hangs, the whole daemon counts as hung. Workers are not checked: a
// step may take long.
static void tell_alive(cau_daemon *daemon)
{
	unsigned long ticks = cau_service_ticks(daemon->service);
	daemon->network_moved = daemon->network_moved || ticks != daemon->ticks_seen;
	daemon->ticks_seen = ticks;
	daemon->store_moved = cau_store_moves(daemon->store) || daemon->store_moved;
	daemon->watchdog_moved = cau_watchdog_moves(daemon->watchdog) || daemon->watchdog_moved;
	if (!daemon->network_moved || !daemon->store_moved || !daemon->watchdog_moved)
		return;
	sd_notify(0, "WATCHDOG=1");
	daemon->network_moved = daemon->store_moved = daemon->watchdog_moved = false;
}

// Reads the folder of scenes again if it changed. If a scene cannot be read, all scenes stay as
// they were, and the error is logged once.
static void follow_scenes(cau_daemon *daemon)
{
	bool changed;
	cau_error error = {0};
	double now_s = cau_monotonic_s();
	if (now_s < daemon->scenes_due_s)
		return;
	daemon->scenes_due_s = now_s + SCENES_S;
	if (cau_scenes_follow(daemon->scenes, &changed, &error))
		cau_log(CAU_LOG_ERROR, NULL, "scenes_not_read",
		        "file=\"%s\" path=%s reason=\"%s\" kept=true", error.file, error.path,
		        error.reason);
	else if (changed)
		cau_log(CAU_LOG_NOTICE, NULL, "scenes_read", "folder=\"%s\"", daemon->config->scenes);
}

int cau_daemon_wait(cau_daemon *daemon, const sigset_t *signals, int *signal_number)
{
	struct timespec patience = {0, REAP_MS * 1000000L};
	siginfo_t info;
	int got = sigtimedwait(signals, &info, &patience);
	bool terminal_gone = got == SIGHUP && info.si_code == SI_KERNEL;
	if (got > 0)
		*signal_number = terminal_gone ? SIGTERM : got;
	cau_moves_reap(daemon->moves);
	cau_hub_reap(daemon->hub);
	follow_scenes(daemon);
	cau_restart_tell(&daemon->restart);
	tell_alive(daemon);
	return 0;
}

static bool reloaded(const char *setting, cau_status status, const cau_error *error)
{
	if (status)
		cau_log(CAU_LOG_ERROR, NULL, "reload_failed",
		        "setting=%s status=%s file=\"%s\" reason=\"%s\" kept=true", setting,
		        cau_status_name(status), error->file, error->reason);
	return !status;
}

void cau_daemon_reload(cau_daemon *daemon)
{
	cau_error error = {0};
	const cau_config *config = daemon->config;
	bool tokens = false, roles = false, pair = false;
	sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%lld", (long long)(cau_monotonic_s() * 1e6));
	if (*config->tokens)
		tokens = reloaded("tokens", cau_auth_reload(daemon->auth, config, &error), &error);
	if (tokens)
		cau_service_check_tokens(daemon->service);
	error = (cau_error){0};
	if (daemon->dds && *config->dds_roles)
		roles = reloaded("dds_roles", cau_dds_reload(daemon->dds, &error), &error);
	error = (cau_error){0};
	if (*config->tls_certificate)
		pair = reloaded("tls_certificate", cau_network_reload_tls(daemon->network, &error), &error);
	cau_log(CAU_LOG_NOTICE, NULL, "reloaded", "tokens=%d dds_roles=%d tls=%d", tokens, roles, pair);
	sd_notify(0, "READY=1");
}

void cau_daemon_stand_aside(cau_daemon *daemon, bool aside)
{
	daemon->stands_aside = aside;
	cau_log(CAU_LOG_NOTICE, NULL, "stands_aside", "aside=%d agent=%d", aside,
	        daemon->agent != NULL);
}

void cau_daemon_stop(cau_daemon *daemon)
{
	if (!daemon)
		return;
	sd_notify(0, "STOPPING=1");
	daemon->draining = true;
	if (daemon->hub)
		cau_hub_stop_time(daemon->hub); // first, because the calls below may wait
	if (daemon->service)
		cau_service_drain(daemon->service);
	cau_dds_stop(daemon->dds);
	double drained_s = cau_monotonic_s() + daemon->config->drain_s; // latest end of the drain
	cau_moves_drain(daemon->moves);
	if (daemon->hub)
		cau_hub_drain(daemon->hub, drained_s - cau_monotonic_s());
	if (daemon->network)
		cau_network_stop(daemon->network, CAU_CLOSE_DRAINING, CLOSING_S);
	cau_agent_destroy(daemon->agent);
	if (daemon->builder)
		cau_builder_stop(daemon->builder);
	if (daemon->mover)
		cau_builder_stop(daemon->mover);
	cau_watchdog_destroy(daemon->watchdog);
	if (daemon->service)
		cau_service_set_network(daemon->service, NULL);
	cau_network_destroy(daemon->network);
	// Destroy in this order: answers to waiting requests go to transports; transports may hold
	// sessions; sessions use the hub.
	cau_moves_stop(daemon->moves);
	cau_hub_stop(daemon->hub);
	cau_builder_destroy(daemon->builder);
	cau_builder_destroy(daemon->mover);
	cau_dds_destroy(daemon->dds);
	cau_service_destroy(daemon->service);
	cau_moves_destroy(daemon->moves);
	cau_hub_destroy(daemon->hub);
	cau_worker_pool_destroy(daemon->pool);
	cau_store_close(daemon->store);
	cau_store_close(daemon->memory);
	cau_lease_give_back(daemon->lease); // nothing is written to the store any more
	cau_scenes_destroy(daemon->scenes);
	cau_static_files_destroy(daemon->manual);
	cau_static_files_destroy(daemon->files);
	cau_auth_destroy(daemon->auth);
	free(daemon);
}
