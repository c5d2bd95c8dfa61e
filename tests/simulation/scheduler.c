// SPDX-License-Identifier: GPL-3.0-or-later
#undef _FORTIFY_SOURCE // with it, longjmp would report a jump to another stack as an error
#include "simulation/scheduler.h"

#include <assert.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <ucontext.h>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
#endif

enum {
	// Largest number of fibers: two daemons of 16 threads each, twice because an ending daemon
	// overlaps with the next, and the simulation's own fibers.
	FIBERS_MOST = 96,
	STACK_BYTES = 1 << 20, // only used pages take memory; the address sanitizer needs the most
	GUARD_BYTES = 4096,
	MACHINES_MOST = 2,
	NAME_BYTES = 16,
	// advance of the clock at each reading, so that a loop that waits for the clock always ends
	CLOCK_READ_NS = 50,
};

typedef enum fiber_state { FREE, READY, WAITING, ENDED } fiber_state;

typedef struct fiber {
	uint64_t id;
	fiber_state state;
	int machine;
	char name[NAME_BYTES];
	ucontext_t context; // context of the fiber's start
	jmp_buf place;      // the point where the fiber continues
	bool begun;
	void *stack;
	const void *waits_for;
	int64_t until_ns;
	bool timed_out;
	bool nobodys; // the fiber is detached: no fiber joins it
	void *(*run)(void *);
	void *argument, *result;
	int64_t processor_ns;
	void *fake_stack; // address sanitizer's stack of this fiber
} fiber;

static struct {
	fiber fibers[FIBERS_MOST];
	int used; // number of entries that were ever used
	fiber *present;
	int ready_count, ready[FIBERS_MOST];
	uint64_t last_id, trace, switches;
	int64_t now_ns;
	int64_t stopped_until_ns[MACHINES_MOST];
	sim_random random;
	sim_roughness roughness;
	void (*watch)(int64_t);
	void *spare[FIBERS_MOST]; // stacks of ended fibers
	int spare_count;
} sim;

bool sim_verbose;
void (*sim_failed)(const char *promise, const char *text);

// ---- random numbers (splitmix64)
uint64_t sim_draw(sim_random *random)
{
	uint64_t z = random->state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

sim_random sim_random_of(uint64_t seed, uint64_t purpose)
{
	sim_random random = {seed ^ purpose * 0xd1342543de82ef95u};
	sim_draw(&random);
	return random;
}

int64_t sim_between(sim_random *random, int64_t least, int64_t most)
{
	assert(least <= most);
	return least + (int64_t)(sim_draw(random) % (uint64_t)(most - least + 1));
}

bool sim_chance(sim_random *random, int64_t one_in)
{
	return one_in > 0 && sim_draw(random) % (uint64_t)one_in == 0;
}

// ---- switching
#if defined(__SANITIZE_ADDRESS__)
static struct {
	const void *bottom;
	size_t bytes;
} world_stack; // stack of the program itself
#endif

static void begin_switch(fiber *from, const fiber *to)
{
#if defined(__SANITIZE_ADDRESS__)
	bool own = to->stack;
	__sanitizer_start_switch_fiber(&from->fake_stack, own ? to->stack : world_stack.bottom,
	                               own ? STACK_BYTES : world_stack.bytes);
#else
	(void)from, (void)to;
#endif
}

static void end_switch(const fiber *here)
{
#if defined(__SANITIZE_ADDRESS__)
	const void *bottom;
	size_t bytes;
	__sanitizer_finish_switch_fiber(here->fake_stack, &bottom, &bytes);
	// The first fiber that continues comes from the program's own stack, whose bounds are learned
	// here.
	if (!world_stack.bytes)
		world_stack.bottom = bottom, world_stack.bytes = bytes;
#else
	(void)here;
#endif
}

#if defined(__SANITIZE_ADDRESS__)
// Switches fibers. The address sanitizer treats longjmp as the end of calls, so this build switches
// by contexts.
static void change_stacks(fiber *from, fiber *next)
{
	swapcontext(&from->context, &next->context);
}
#else
// Switches fibers. swapcontext would call the kernel for the signal mask each time. This function
// uses a context only at each fiber's start, and longjmp later.
static void change_stacks(fiber *from, fiber *next)
{
	if (_setjmp(from->place))
		return;
	if (next->begun)
		_longjmp(next->place, 1);
	next->begun = true;
	setcontext(&next->context);
}
#endif

static void go_to(fiber *next)
{
	fiber *from = sim.present;
	sim.trace = (sim.trace ^ next->id ^ (uint64_t)sim.now_ns << 8) * 1099511628211u;
	sim.switches++;
	if (next == from)
		return;
	sim.present = next;
	begin_switch(from, next);
	change_stacks(from, next);
	end_switch(sim.present);
}

// Returns the time at which the fiber can continue. A fiber of a stopped machine continues only
// after the stop.
static int64_t due_of(const fiber *f)
{
	int64_t due_ns = f->state == WAITING ? f->until_ns : sim.now_ns;
	int64_t stopped_ns = sim_stopped_until(f->machine);
	return due_ns > stopped_ns ? due_ns : stopped_ns;
}

// Marks the fibers whose time has come as ready. Returns the earliest time of all other fibers.
static int64_t wake_due(void)
{
	int64_t earliest = SIM_NEVER;
	sim.ready_count = 0;
	for (int i = 0; i < sim.used; i++) {
		fiber *f = &sim.fibers[i];
		if (f->state != WAITING && f->state != READY)
			continue;
		int64_t due_ns = due_of(f);
		if (due_ns > sim.now_ns) {
			earliest = due_ns < earliest ? due_ns : earliest;
			continue;
		}
		f->timed_out = f->state == WAITING || f->timed_out;
		f->state = READY;
		sim.ready[sim.ready_count++] = i;
	}
	return earliest;
}

static void schedule(void)
{
	int64_t earliest = wake_due();
	while (sim.ready_count == 0) {
		if (earliest == SIM_NEVER)
			sim_fail("progress", "every thread waits, none for a time");
		if (sim.watch)
			sim.watch(earliest);
		sim.now_ns = earliest;
		earliest = wake_due();
	}
	int which = sim.ready_count == 1 ? 0 : (int)(sim_draw(&sim.random) % (uint64_t)sim.ready_count);
	go_to(&sim.fibers[sim.ready[which]]);
}

// ---- life of a fiber
static void live(void)
{
	fiber *f = sim.present;
	end_switch(f);
	f->result = f->run(f->argument);
	f->state = ENDED;
	sim_wake_all(f);
	schedule();
	abort(); // an ended fiber never continues
}

static void give_back(fiber *f)
{
	if (f->stack)
		sim.spare[sim.spare_count++] = f->stack;
	f->stack = NULL;
	f->state = FREE;
}

static fiber *place(void)
{
	for (int i = 0; i < FIBERS_MOST; i++) {
		fiber *f = &sim.fibers[i];
		if (f->state == ENDED && f->nobodys)
			give_back(f);
		if (f->state == FREE && f != sim.present) {
			sim.used = i >= sim.used ? i + 1 : sim.used;
			return f;
		}
	}
	fprintf(stderr, "more than %d threads at once\n", FIBERS_MOST);
	abort();
}

static void *make_stack(void)
{
	char *memory = mmap(NULL, STACK_BYTES + GUARD_BYTES, PROT_READ | PROT_WRITE,
	                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	assert(memory != MAP_FAILED);
	mprotect(memory, GUARD_BYTES, PROT_NONE);
	return memory + GUARD_BYTES;
}

uint64_t sim_start(void *(*run)(void *), void *argument)
{
	fiber *f = place();
	*f = (fiber){.id = ++sim.last_id, .state = READY, .machine = sim.present->machine};
	f->run = run;
	f->argument = argument;
	f->stack = sim.spare_count ? sim.spare[--sim.spare_count] : make_stack();
	getcontext(&f->context);
	f->context.uc_stack.ss_sp = f->stack;
	f->context.uc_stack.ss_size = STACK_BYTES;
	f->context.uc_link = NULL;
	makecontext(&f->context, live, 0);
	sim_point();
	return f->id;
}

static fiber *find(uint64_t id)
{
	for (int i = 0; i < sim.used; i++)
		if (sim.fibers[i].id == id && sim.fibers[i].state != FREE)
			return &sim.fibers[i];
	return NULL;
}

void *sim_join(uint64_t id)
{
	fiber *f = find(id);
	assert(f);
	while (f->state != ENDED)
		sim_wait(f, SIM_NEVER);
	void *result = f->result;
	give_back(f);
	return result;
}

void sim_let_go(uint64_t id)
{
	fiber *f = find(id);
	if (f)
		f->nobodys = true;
}

bool sim_is_alive(uint64_t id)
{
	return find(id) != NULL;
}

void sim_kill_machine(int machine)
{
	assert(sim.present->machine != machine);
	sim.stopped_until_ns[machine] = 0;
	for (int i = 0; i < sim.used; i++)
		if (sim.fibers[i].state != FREE && sim.fibers[i].machine == machine)
			give_back(&sim.fibers[i]);
}

void sim_stop_machine(int machine, int64_t until_ns)
{
	assert(sim.present->machine != machine && machine < MACHINES_MOST);
	sim.stopped_until_ns[machine] = until_ns;
}

int64_t sim_stopped_until(int machine)
{
	return machine == SIM_WORLD ? 0 : sim.stopped_until_ns[machine];
}

void sim_begin(uint64_t seed, const sim_roughness *roughness)
{
	memset(&sim, 0, sizeof sim);
	sim.random = sim_random_of(seed, 1);
	sim.roughness = *roughness;
	// start of the clock: as on a machine that has been running for a while
	sim.now_ns = 1000 * SIM_SECOND;
	sim.trace = seed;
	sim.used = 1;
	sim.present = &sim.fibers[0];
	*sim.present =
		(fiber){.id = ++sim.last_id, .state = READY, .machine = SIM_WORLD, .begun = true};
	sim_set_name(sim.present->id, "world");
}

// ---- functions that fibers call
int64_t sim_now(void)
{
	sim.now_ns += CLOCK_READ_NS;
	return sim.now_ns;
}

void sim_enter_machine(int machine)
{
	sim.present->machine = machine;
}

int sim_machine(void)
{
	return sim.present->machine;
}

uint64_t sim_self(void)
{
	return sim.present->id;
}

void sim_set_name(uint64_t id, const char *name)
{
	fiber *f = find(id);
	if (f)
		snprintf(f->name, sizeof f->name, "%s", name);
}

const char *sim_name(void)
{
	return sim.present->name;
}

bool sim_wait(const void *address, int64_t until_ns)
{
	fiber *f = sim.present;
	f->state = WAITING;
	f->waits_for = address;
	f->until_ns = until_ns;
	f->timed_out = false;
	schedule();
	f->waits_for = NULL;
	return !f->timed_out;
}

int64_t sim_wakes_early(int64_t until_ns)
{
	int64_t early_ns = sim.now_ns + sim_between(&sim.random, 1, 20 * SIM_MS);
	bool early = sim_chance(&sim.random, sim.roughness.wake_early_one_in);
	return early && early_ns < until_ns ? early_ns : until_ns;
}

void sim_sleep(int64_t ns)
{
	if (ns > 0)
		sim_wait(NULL, sim.now_ns + ns);
}

void sim_work(int64_t ns)
{
	sim.present->processor_ns += ns;
	sim_sleep(ns);
}

int64_t sim_processor_ns(void)
{
	return sim.present->processor_ns += CLOCK_READ_NS;
}

void sim_point(void)
{
	fiber *f = sim.present;
	const sim_roughness *rough = &sim.roughness;
	if (f->machine != SIM_WORLD && sim_chance(&sim.random, rough->stall_one_in))
		sim_wait(NULL, sim.now_ns + sim_between(&sim.random, 1000, rough->stall_most_ns));
	else if (sim_chance(&sim.random, rough->switch_one_in))
		schedule();
}

static bool waits_for(const fiber *f, const void *address)
{
	return f->state == WAITING && f->waits_for == address;
}

void sim_wake_all(const void *address)
{
	for (int i = 0; i < sim.used; i++)
		if (waits_for(&sim.fibers[i], address))
			sim.fibers[i].state = READY;
}

void sim_wake_one(const void *address)
{
	int count = 0, which[FIBERS_MOST];
	for (int i = 0; i < sim.used; i++)
		if (waits_for(&sim.fibers[i], address))
			which[count++] = i;
	if (count)
		sim.fibers[which[sim_draw(&sim.random) % (uint64_t)count]].state = READY;
}

void sim_on_advance(void (*watch)(int64_t))
{
	sim.watch = watch;
}

uint64_t sim_trace(void)
{
	return sim.trace;
}

void sim_note(uint64_t value)
{
	sim.trace = (sim.trace ^ value) * 1099511628211u;
}

uint64_t sim_switches(void)
{
	return sim.switches;
}

// ---- messages
void sim_fail(const char *promise, const char *format, ...)
{
	char text[1024];
	va_list arguments;
	int at = snprintf(text, sizeof text, "%.6f s, %s: ", 1e-9 * (double)sim.now_ns - 1000,
	                  sim.present ? sim.present->name : "");
	va_start(arguments, format);
	vsnprintf(text + at, sizeof text - (size_t)at, format, arguments);
	va_end(arguments);
	sim_failed(promise, text);
	abort();
}

void sim_say(const char *format, ...)
{
	va_list arguments;
	if (!sim_verbose)
		return;
	fprintf(stderr, "%11.6f %d %-15s ", 1e-9 * (double)sim.now_ns - 1000, sim.present->machine,
	        sim.present->name);
	va_start(arguments, format);
	vfprintf(stderr, format, arguments);
	va_end(arguments);
	fputc('\n', stderr);
}
