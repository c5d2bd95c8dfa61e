// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's threads and clock. Threads of the code under test are fibers of one real thread.
// One runs at a time. At each call of a lock, a condition or the clock another may go on, as the
// seed says. When all wait, the clock goes to the earliest time that one of them waits for.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define SIM_SECOND INT64_C(1000000000) // ns
#define SIM_MS INT64_C(1000000)        // ns
#define SIM_NEVER INT64_MAX

enum { SIM_WORLD = -1 }; // the machine of fibers that belong to no daemon

// ---- random numbers, from the seed
typedef struct sim_random {
	uint64_t state;
} sim_random;

sim_random sim_random_of(uint64_t seed, uint64_t purpose); // one stream for each purpose
uint64_t sim_draw(sim_random *random);
int64_t sim_between(sim_random *random, int64_t least, int64_t most); // both included
bool sim_chance(sim_random *random, int64_t one_in);                  // false where one_in is 0

// ---- fibers
// How rough the machine is; 0: never.
typedef struct sim_roughness {
	int64_t switch_one_in;     // calls after which another thread goes on
	int64_t stall_one_in;      // calls after which a thread of a daemon stands still
	int64_t stall_most_ns;     // for so long
	int64_t wake_early_one_in; // waits on a condition that end without a reason
} sim_roughness;

void sim_begin(uint64_t seed, const sim_roughness *roughness);
int64_t sim_now(void); // ns of the monotonic clock
// Fibers that are made from now on by the present one belong to this machine.
void sim_enter_machine(int machine);
int sim_machine(void); // of the present fiber
// All fibers of a machine end where they are, as threads do at `kill -9`. Not from one of them.
void sim_kill_machine(int machine);
// No fiber of the machine goes on before this time, as at SIGSTOP.
void sim_stop_machine(int machine, int64_t until_ns);
int64_t sim_stopped_until(int machine); // the end of its last stop; 0: there was none
uint64_t sim_self(void);                // number of the present fiber, from 1, never used again
bool sim_is_alive(uint64_t fiber);
void sim_set_name(uint64_t fiber, const char *name); // the first 15 bytes
const char *sim_name(void);

uint64_t sim_start(void *(*run)(void *argument), void *argument);
void *sim_join(uint64_t fiber);
void sim_let_go(uint64_t fiber); // nobody will join it
// Another fiber may go on here.
void sim_point(void);
// Waits for sim_wake_* with this address, or until the time. False: the time has come.
bool sim_wait(const void *address, int64_t until_ns);
void sim_wake_one(const void *address);
void sim_wake_all(const void *address);
// The time to which a wait on a condition goes: now and then before it is due.
int64_t sim_wakes_early(int64_t until_ns);
void sim_sleep(int64_t ns);
// Computes for so long: as sim_sleep, and the fiber's processor time advances.
void sim_work(int64_t ns);
int64_t sim_processor_ns(void);

// Called whenever the clock goes on, before it does, with the time that it goes to.
void sim_on_advance(void (*watch)(int64_t to_ns));
// Every call below counts; two runs of one seed have the same numbers.
uint64_t sim_trace(void);      // a hash of which fiber went on when
void sim_note(uint64_t value); // goes into it
uint64_t sim_switches(void);

// ---- what went wrong: ends the run
// `promise` is a word of promises.h; the rest says what was seen.
__attribute__((format(printf, 2, 3), noreturn)) void sim_fail(const char *promise,
                                                              const char *format, ...);
__attribute__((format(printf, 1, 2))) void sim_say(const char *format, ...); // with --verbose
extern bool sim_verbose;
extern void (*sim_failed)(const char *promise, const char *text); // does not return
