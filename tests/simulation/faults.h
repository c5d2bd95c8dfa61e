// SPDX-License-Identifier: GPL-3.0-or-later
// Faults that can be planted, one at a time, to see that the promises notice them. They are put
// around the daemon's own functions by the linker, in this program alone.
#pragma once

#include <stdbool.h>
#include <stdint.h>

// word, promise that notices it, what is wrong
#define FAULT_TABLE(X)                                                                             \
	X(watchdog_oversleeps, energy_silent, "the watchdog looks half a second after it should")      \
	X(worker_wake_lost, energy_cut, "one in three wakes of a worker is lost")                      \
	X(signal_lost, answered, "one in eight signals of a condition is lost")                        \
	X(early_acknowledgement, acknowledged, "answers go out before the commit")                     \
	X(commit_not_synced, acknowledged, "commits are not synced to the disk")                       \
	X(row_lost, acknowledged, "one in eight commands is not written to the log")                   \
	X(loss_not_cut, energy_cut, "a lost connection does not turn energy off")                      \
	X(hidden_page_ignored, energy_cut, "a hidden page does not turn energy off")                   \
	X(pause_keeps_energy, energy_cut, "a pause does not turn energy off")                          \
	X(silence_not_cut, energy_silent, "silence does not turn energy off")                          \
	X(others_feed, energy_silent, "any client's heartbeat counts for all drivers")                 \
	X(late_beats_count, energy_silent, "a heartbeat counts when it comes, not when it was sent")   \
	X(stop_not_seen, energy_silent, "what waited while the daemon was stopped counts as sent now") \
	X(ticks_not_counted, energy_silent, "in lock-step silence is not counted")                     \
	X(store_full_ignored, energy_full, "energy stays on while the store is full")                  \
	X(core_ignores_off, energy_cut, "one in three cuts does not reach the core")                   \
	X(command_twice, once, "one in thirty commands about tissue is given to the core twice")       \
	X(every_token_is_admin, allowed, "every token is an administrator's")                          \
	X(sessions_unbounded, allowed, "a token's sessions are not looked at")                         \
	X(quota_ignored, allowed, "requests cost nothing")                                             \
	X(orders_swapped, order, "two commands change places in the queue")                            \
	X(answer_twice, one_answer, "one in fifty answers goes out twice")                             \
	X(answer_lost, answered, "one in fifty answers is lost")                                       \
	X(resend_acts, same_answer, "no stored answer is found for a request that is sent again")      \
	X(epoch_kept, stream, "a rewind does not begin an epoch")                                      \
	X(frame_lost, stream, "one in sixty frames is left out for a subscriber")                      \
	X(flight_unbounded, budget, "bytes in flight have no bound")                                   \
	X(queue_unbounded, budget, "a session's queue is eight times as long as is set")               \
	X(source_serves_on, one_server, "a session that has moved is served on where it was")          \
	X(session_starved, fair, "a session's next slice is half a second late")

typedef enum sim_fault {
	FAULT_NONE,
#define X(code, promise, meaning) FAULT_##code,
	FAULT_TABLE(X)
#undef X
		FAULT_COUNT
} sim_fault;

extern sim_fault sim_planted;
const char *faults_word(sim_fault fault);
const char *faults_promise(sim_fault fault);
const char *faults_meaning(sim_fault fault);
void faults_begin(uint64_t seed);
// Whether this fault is planted and acts now: one time in so many.
bool faults_act(sim_fault fault, int64_t one_in);
