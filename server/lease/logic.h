// SPDX-License-Identifier: GPL-3.0-or-later
// Decides from etcd's answers whether a store may be served under its daemon's label, and until
// when. Pure: no socket, no clock, no store. All times are seconds on one clock that never goes
// backwards.
//
// Each opening of a store makes a new generation, a number and a random mark, in three moves. First
// the store notes the new generation as its next one. Then etcd takes the new generation, if etcd
// still has the generation of this store. Last the store notes the new generation as the held one.
// After a crash between two moves, the generation in etcd is either the held or the next one of the
// store. Any other store of the label has neither and is refused: an old copy, or a store that lost
// the race for the same move. A copy that was made after the last opening has the same generations,
// but may lack newer data. It is refused too, because its file is not the one that was opened.
//
// A lease belongs to the generation. Its end is counted from the time when the last successful
// renewal was sent. So the lease ends for the daemon before it ends in etcd, however long the
// answer took.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

// ---- generations
typedef struct cau_generation {
	int64_t number; // 0 if there is none
	uint64_t mark;  // random
} cau_generation;

enum { CAU_GENERATION_BYTES = 48 }; // length of a generation's text, with the zero at the end

bool cau_generation_same(cau_generation a, cau_generation b);
// Writes a generation as "17:00c0ffee00c0ffee"; as "" if there is none.
void cau_generation_write(cau_generation generation, char text[CAU_GENERATION_BYTES]);
// Reads a text of `bytes` bytes that is exactly what cau_generation_write writes. Returns false if
// it is not a generation.
bool cau_generation_read(const char *text, size_t bytes, cau_generation *generation);

// ---- whether this store may be served
typedef struct cau_claim {
	cau_generation held, next; // generations in the store
	cau_generation known;      // generation in etcd
	bool is_held;              // etcd has a holder whose lease has not ended
	// the holder was a process with this store file. That process has ended, because this process
	// has the file's lock
	bool is_held_here;
	bool is_copy;    // the store's file is not the file that was opened last
	bool take_label; // the operator says that this store is the right one
} cau_claim;

typedef enum cau_verdict { CAU_VERDICT_CLAIM, CAU_VERDICT_WAIT, CAU_VERDICT_REFUSE } cau_verdict;

// Judges whether the store may take the label. WAIT: another daemon holds the label until its lease
// ends. REFUSE fills *error (CAU_BAD_STATE).
cau_verdict cau_lease_judge(const cau_claim *claim, cau_error *error);
// Chooses claim->next, a generation after all known ones. The store notes it before etcd is asked
// to take it; `mark` is random. If etcd has the present claim->next, which an earlier start noted,
// that generation first becomes claim->held. *has_next must be false at the start of the process.
// All attempts of one start use the same next generation, because an abandoned request may still
// arrive. Each start makes a new one, so that a copy of the store from after a failed start is not
// taken for the newest store.
void cau_lease_choose(cau_claim *claim, bool *has_next, uint64_t mark);

// ---- the end of the lease
typedef struct cau_lease_rules {
	double ttl_s; // time to live that etcd is asked for
	// the lease ends this much earlier here, for clock errors and requests on their way
	double margin_s;
	double renew_s; // time from one renewal to the next
	double limit_s; // time limit for one answer
	double retry_s; // time to the next attempt after a failed renewal
} cau_lease_rules;

// Returns the times for this time to live. They leave time for three addresses that do not answer.
cau_lease_rules cau_lease_rules_of(double ttl_s);

typedef struct cau_lease_logic {
	cau_lease_rules rules;
	double held_until_s;
	double ask_at_s;
	bool lost; // lost for good
} cau_lease_logic;

typedef enum cau_renewal {
	CAU_RENEWED,
	CAU_RENEWAL_GONE,   // etcd says that there is no such lease
	CAU_RENEWAL_UNKNOWN // no answer, or an unreadable one
} cau_renewal;

// Begins a lease, granted for `ttl_s` by a request that was sent at `sent_s`.
void cau_lease_begin(cau_lease_logic *logic, const cau_lease_rules *rules, double sent_s,
                     double ttl_s);
// Notes the result of a renewal that was sent at `sent_s`.
void cau_lease_answer(cau_lease_logic *logic, cau_renewal renewal, double sent_s, double ttl_s,
                      double now_s);

typedef struct cau_lease_step {
	enum { CAU_LEASE_WAIT, CAU_LEASE_RENEW, CAU_LEASE_END } kind;
	double seconds; // time to wait, or the time limit for the answer
} cau_lease_step;
cau_lease_step cau_lease_next(cau_lease_logic *logic, double now_s);
