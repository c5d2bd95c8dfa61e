// SPDX-License-Identifier: GPL-3.0-or-later
// Faults that can be planted, one at a time, to test that the promises detect them. The linker puts
// them around the daemon's own functions, only in this program.
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Columns: word; promise that detects the fault; seed that found the fault last; description. The
// search begins with that seed, so it is short if the seed still finds the fault.
#define FAULT_TABLE(X)                                                                             \
	X(watchdog_oversleeps, energy_silent, 14, "the watchdog looks half a second after it should")  \
	X(worker_wake_lost, energy_cut, 49, "one in three wakes of a worker is lost")                  \
	X(signal_lost, answered, 2, "one in eight signals of a condition is lost")                     \
	X(early_acknowledgement, acknowledged, 22, "answers go out before the commit")                 \
	X(commit_not_synced, acknowledged, 4, "commits are not synced to the disk")                    \
	X(row_lost, acknowledged, 1, "one in eight commands is not written to the log")                \
	X(loss_not_cut, energy_cut, 13, "a lost connection does not turn energy off")                  \
	X(hidden_page_ignored, energy_cut, 4, "a hidden page does not turn energy off")                \
	X(pause_keeps_energy, energy_cut, 4, "a pause does not turn energy off")                       \
	X(silence_not_cut, energy_silent, 1, "silence does not turn energy off")                       \
	X(others_feed, energy_silent, 2, "any client's heartbeat counts for all drivers")              \
	X(late_beats_count, energy_silent, 41,                                                         \
	  "a heartbeat counts when it comes, not when it was sent")                                    \
	X(stop_not_seen, energy_silent, 5,                                                             \
	  "what waited while the daemon was stopped counts as sent now")                               \
	X(ticks_not_counted, energy_silent, 1, "in lock-step silence is not counted")                  \
	X(store_full_ignored, energy_full, 6, "energy stays on while the store is full")               \
	X(core_ignores_off, energy_cut, 13, "one in three cuts does not reach the core")               \
	X(command_twice, once, 9, "one in thirty commands about tissue is given to the core twice")    \
	X(every_token_is_admin, allowed, 1, "every token is an administrator's")                       \
	X(sessions_unbounded, allowed, 11, "a token's sessions are not looked at")                     \
	X(quota_ignored, allowed, 69, "requests cost nothing")                                         \
	X(orders_swapped, order, 3, "two commands change places in the queue")                         \
	X(answer_twice, one_answer, 1, "one in fifty answers goes out twice")                          \
	X(answer_lost, answered, 1, "one in fifty answers is lost")                                    \
	X(resend_acts, same_answer, 1, "no stored answer is found for a request that is sent again")   \
	X(epoch_kept, stream, 65, "a rewind does not begin an epoch")                                  \
	X(frame_lost, stream, 2, "one in sixty frames is left out for a subscriber")                   \
	X(flight_unbounded, budget, 27, "bytes in flight have no bound")                               \
	X(queue_unbounded, budget, 18, "a session's queue is eight times as long as is set")           \
	X(source_serves_on, one_server, 6, "a session that has moved is served on where it was")       \
	X(session_starved, fair, 2, "a session's next slice is half a second late")

typedef enum sim_fault {
	FAULT_NONE,
#define X(code, promise, found_by, meaning) FAULT_##code,
	FAULT_TABLE(X)
#undef X
		FAULT_COUNT
} sim_fault;

extern sim_fault sim_planted;
const char *faults_word(sim_fault fault);
const char *faults_promise(sim_fault fault);
const char *faults_meaning(sim_fault fault);
int64_t faults_found_by(sim_fault fault);
void faults_begin(uint64_t seed);
// True if this fault is planted and acts now: with a probability of one in `one_in`.
bool faults_act(sim_fault fault, int64_t one_in);
