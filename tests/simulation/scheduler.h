// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's threads and clock. Threads of the code under test are fibers of one real thread,
// and one fiber runs at a time. At each call of a lock, a condition or the clock the seed decides
// which fiber continues. When all fibers wait, the clock advances to the earliest time that one of
// them waits for.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define SIM_SECOND INT64_C(1000000000) // ns
#define SIM_MS INT64_C(1000000)        // ns
#define SIM_NEVER INT64_MAX

enum { SIM_WORLD = -1 }; // machine of the fibers that belong to no daemon

// ---- random numbers, from the seed
typedef struct sim_random {
	uint64_t state;
} sim_random;

sim_random sim_random_of(uint64_t seed, uint64_t purpose); // each purpose has its own sequence
uint64_t sim_draw(sim_random *random);
int64_t sim_between(sim_random *random, int64_t least, int64_t most); // both limits included
bool sim_chance(sim_random *random, int64_t one_in); // returns false if one_in is 0

// ---- fibers
// How often the simulated machine disturbs threads. A value of 0 means never.
typedef struct sim_roughness {
	int64_t switch_one_in;     // one in this many calls switches to another thread
	int64_t stall_one_in;      // one in this many calls stalls a daemon's thread
	int64_t stall_most_ns;     // longest stall
	int64_t wake_early_one_in; // one in this many waits on a condition ends without a reason
} sim_roughness;

void sim_begin(uint64_t seed, const sim_roughness *roughness);
int64_t sim_now(void); // ns of the monotonic clock
// Sets the machine of all fibers that the present fiber starts from now on.
void sim_enter_machine(int machine);
int sim_machine(void); // machine of the present fiber
// Ends all fibers of a machine at once, as `kill -9` does. The caller must be a fiber of another
// machine.
void sim_kill_machine(int machine);
// Stops the machine, as SIGSTOP does: no fiber of the machine continues before this time.
void sim_stop_machine(int machine, int64_t until_ns);
int64_t sim_stopped_until(int machine); // end of the machine's last stop; 0: no stop
// Returns the number of the present fiber, which is counted from 1 and never reused.
uint64_t sim_self(void);
bool sim_is_alive(uint64_t fiber);
void sim_set_name(uint64_t fiber, const char *name); // keeps the first 15 bytes
const char *sim_name(void);

uint64_t sim_start(void *(*run)(void *argument), void *argument);
void *sim_join(uint64_t fiber);
void sim_let_go(uint64_t fiber); // detaches the fiber
// Lets the scheduler choose the fiber that continues.
void sim_point(void);
// Waits for sim_wake_* with this address, or until the time. Returns false if the wait ended by
// time.
bool sim_wait(const void *address, int64_t until_ns);
void sim_wake_one(const void *address);
void sim_wake_all(const void *address);
// Returns the time at which a wait on a condition ends; now and then this is before `until_ns`.
int64_t sim_wakes_early(int64_t until_ns);
void sim_sleep(int64_t ns);
// Computes for `ns`: like sim_sleep, and the fiber's processor time advances.
void sim_work(int64_t ns);
int64_t sim_processor_ns(void);

// Sets the function that is called before each advance of the clock, with the new time.
void sim_on_advance(void (*watch)(int64_t to_ns));
// The trace is a hash. Two runs of one seed make the same calls and have the same trace.
uint64_t sim_trace(void);      // returns the hash of the order in which fibers continued
void sim_note(uint64_t value); // adds a value to the trace
uint64_t sim_switches(void);

// ---- failures, which end the run
// Ends the run as failed. `promise` is a word of promises.h. The rest describes the observation.
__attribute__((format(printf, 2, 3), noreturn)) void sim_fail(const char *promise,
                                                              const char *format, ...);
// Prints a line if --verbose is given.
__attribute__((format(printf, 1, 2))) void sim_say(const char *format, ...);
extern bool sim_verbose;
extern void (*sim_failed)(const char *promise, const char *text); // must not return
