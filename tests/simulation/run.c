// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/run.h"

#include <assert.h>
#include <errno.h>
#include <malloc.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "simulation/core_watch.h"
#include "simulation/courier.h"
#include "simulation/threads.h"

// Limits of time for one seed. A seed usually takes less than a second, or thirty with the address
// sanitizer. CPU_MOST_S limits the processor time. REAL_MOST_S limits the real time, for a run that
// waits without computing or gets no processor.
#if defined(__SANITIZE_ADDRESS__)
enum { CPU_MOST_S = 300, REAL_MOST_S = 1800 };
#else
enum { CPU_MOST_S = 20, REAL_MOST_S = 600 };
#endif
#define LOOK_NS (50 * SIM_MS) // interval at which the operator checks the daemons
#define CALM_NS (4 * SIM_SECOND)
#define UP_MOST_NS (60 * SIM_SECOND)
#define BEGIN_NS (1000 * SIM_SECOND)

extern const sim_end sim_clients_end;

static int result_pipe = -1;
static run_result now;
static int machines; // number of machines with a daemon in this run

// Returns the real time, s. It uses timespec_get, because time() and clock_gettime are simulated
// here.
double real_s(void)
{
	struct timespec time;
	timespec_get(&time, TIME_UTC);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// ---- the seed's profile
sim_profile sim_profile_of(uint64_t seed)
{
	sim_random r = sim_random_of(seed, 8);
	sim_profile p = {
		.length_ns = sim_between(&r, 5, 40) * SIM_SECOND,
		.workers = (int)sim_between(&r, 1, 3),
		.step_least_ns = 20000,
		.step_most_ns = sim_between(&r, 30, 4000) * 1000,
		.latency_most_ns = sim_between(&r, 1, 30) * SIM_MS,
		.queue_commands = sim_between(&r, 0, 1) ? 8 : 64,
		.subscriber_bytes = 16384,
		.store_bytes = sim_between(&r, 0, 1) ? 0 : 3000000,
		.checkpoint_s = 0.1 * (double)sim_between(&r, 2, 30),
		.tokens = sim_between(&r, 0, 2) == 0,
		.roughness = {.switch_one_in = sim_between(&r, 3, 60),
	                  .stall_one_in = sim_between(&r, 0, 1) ? 0 : sim_between(&r, 300, 3000),
	                  .stall_most_ns = 3 * SIM_MS,
	                  .wake_early_one_in = sim_between(&r, 0, 1) ? 0 : 50}};
	return p;
}

// ---- end of a run
static void send_result(void)
{
	now.simulated_ns = sim_now() - BEGIN_NS;
	now.switches = sim_switches();
	now.trace = sim_trace();
	now.counts = promises_counted;
	now.disk = disk_counted;
	now.requests = sim_request_count;
	const char *at = (const char *)&now;
	for (size_t sent = 0; result_pipe >= 0 && sent < sizeof now;) {
		ssize_t count = write(result_pipe, at + sent, sizeof now - sent);
		if (count <= 0)
			break;
		sent += (size_t)count;
	}
}

static void on_failed(const char *promise, const char *text)
{
	now.failed = true;
	snprintf(now.promise, sizeof now.promise, "%s", promise);
	snprintf(now.text, sizeof now.text, "%s", text);
	if (result_pipe < 0)
		fprintf(stderr, "%s: %s\n", promise, text);
	send_result();
	_exit(1);
}

// ---- one run
static void keep_daemons_up(void)
{
	for (int m = 0; m < machines; m++)
		if (daemons_down(m))
			daemons_start(m);
}

// Lets time pass, with heartbeats. The operator restarts daemons that have ended.
static void pass_until(int64_t until_ns)
{
	for (int64_t now_ns = sim_now(); now_ns < until_ns; now_ns = sim_now()) {
		int64_t due_ns = clients_beat_due(), look_ns = now_ns + LOOK_NS;
		keep_daemons_up();
		due_ns = due_ns < look_ns ? due_ns : look_ns;
		due_ns = due_ns < until_ns ? due_ns : until_ns;
		sim_sleep(due_ns - now_ns > 1000 ? due_ns - now_ns : 1000);
		clients_beat();
		streams_acknowledge();
	}
}

static void await_daemons(void)
{
	int64_t most_ns = sim_now() + UP_MOST_NS;
	pass_until(sim_now() + LOOK_NS);
	while (!daemons_up(0) || !daemons_up(machines - 1)) {
		pass_until(sim_now() + LOOK_NS);
		for (int m = 0; m < machines; m++)
			if (!daemons_up(m) && sim_now() > most_ns)
				sim_fail("up", "machine %d does not start: %s", m, daemons_trouble(m));
	}
}

static void heal(void)
{
	for (int m = 0; m < machines; m++)
		workload_do(&(work_step){.kind = STEP_GOOD_DISK, .a = m});
	await_daemons();
	for (int64_t end_ns = sim_now() + UP_MOST_NS; !courier_is_idle() && sim_now() < end_ns;)
		pass_until(sim_now() + LOOK_NS);
	if (!courier_is_idle())
		sim_fail("answered", "a move cannot be settled");
	for (int c = 0; c < CLIENTS; c++) {
		workload_do(&(work_step){.kind = STEP_CONNECT, .a = c});
		workload_do(&(work_step){.kind = STEP_READ, .a = c, .b = 16});
	}
}

// Checks at the end of every run: everything works again, all requests are answered, and the state
// survives a loss of power on every machine.
static void settle(void)
{
	heal();
	promises_calm();
	pass_until(sim_now() + CALM_NS);
	promises_settled();
	for (int m = 0; m < machines; m++)
		daemons_kill(m, true);
	await_daemons();
	pass_until(sim_now() + CALM_NS);
	promises_settled();
}

static void do_run(uint64_t seed, const workload *work)
{
	sim_profile profile = sim_profile_of(seed);
	mallopt(M_MMAP_THRESHOLD, 1 << 30); // the allocator must reuse freed memory at once
	mallopt(M_TRIM_THRESHOLD, 1 << 30);
	mallopt(M_TOP_PAD, 16 << 20);
	sim_failed = on_failed;
	sim_begin(seed, &profile.roughness);
	sim_threads_begin(seed);
	disk_begin(seed);
	disk_vfs_register();
	sim_network_begin(&sim_clients_end);
	clients_begin(seed, &profile);
	promises_begin(&profile);
	core_watch_begin(seed, &profile);
	courier_begin();
	faults_begin(seed);
	daemons_begin(&profile);
	streams_begin(&profile);
	workload_begin();
	machines = work->machines;
	await_daemons();
	int64_t begin_ns = sim_now();
	for (int i = 0; i < work->count; i++) {
		if (work->steps[i].left_out)
			continue;
		pass_until(begin_ns + work->steps[i].at_ns);
		workload_do(&work->steps[i]);
	}
	settle();
}

// ---- in a process of its own
void run_begin(uint64_t seed, const workload *work, run_child *child)
{
	int ends[2];
	*child = (run_child){.seed = seed, .most_s = real_s() + REAL_MOST_S};
	int code = pipe(ends);
	assert(code == 0);
	(void)code;
	fflush(stdout);
	child->process = fork();
	if (child->process == 0) {
		setrlimit(RLIMIT_CPU, &(struct rlimit){CPU_MOST_S, CPU_MOST_S});
		close(ends[0]);
		result_pipe = ends[1];
		do_run(seed, work);
		send_result();
		_exit(0);
	}
	close(ends[1]);
	child->from = ends[0];
}

static void crashed(int status, run_result *result)
{
	*result = (run_result){.failed = true, .promise = "crash"};
	int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	if (signal == SIGKILL || signal == SIGXCPU)
		snprintf(result->text, sizeof result->text,
		         "no end within %d s of processor time, or %d s of real time", CPU_MOST_S,
		         REAL_MOST_S);
	else
		snprintf(result->text, sizeof result->text, "it ended by itself, status %#x",
		         (unsigned)status);
}

// Waits for the run's result, its end, or its time limit.
static void take_result(const run_child *child, run_result *result)
{
	size_t got = 0;
	struct pollfd ready = {child->from, POLLIN, 0};
	while (got < sizeof *result) {
		int count = poll(&ready, 1, 0);
		if (count < 0 && errno == EINTR)
			continue;
		ssize_t part =
			count > 0 ? read(child->from, (char *)result + got, sizeof *result - got) : 0;
		if (part <= 0)
			break;
		got += (size_t)part;
	}
	int status = 0;
	if (got < sizeof *result)
		kill(child->process, SIGKILL); // the run hangs, or has ended
	waitpid(child->process, &status, 0);
	close(child->from);
	if (got < sizeof *result)
		crashed(status, result);
}

int run_end(const run_child *children, int count, run_result *result)
{
	struct pollfd ready[RUNS_MOST];
	double first_s = children[0].most_s;
	assert(count >= 1 && count <= RUNS_MOST);
	for (int i = 0; i < count; i++) {
		ready[i] = (struct pollfd){children[i].from, POLLIN, 0};
		first_s = fmin(first_s, children[i].most_s);
	}
	for (;;) {
		double left_s = first_s - real_s();
		poll(ready, (nfds_t)count, left_s > 0 ? (int)(1000 * left_s) + 1 : 0);
		for (int i = 0; i < count; i++)
			if (ready[i].revents || real_s() > children[i].most_s) {
				take_result(&children[i], result);
				return i;
			}
	}
}

void run_seed(uint64_t seed, const workload *work, run_result *result)
{
	run_child child;
	run_begin(seed, work, &child);
	run_end(&child, 1, result);
}

void run_here(uint64_t seed, const workload *work)
{
	do_run(seed, work);
	send_result();
}
