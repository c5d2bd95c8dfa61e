// SPDX-License-Identifier: GPL-3.0-or-later
// What etcd's answers mean for a daemon's label: whether a store may be served, and until when.
// Pure: no socket, no clock, no store. All times are seconds on one clock that never goes back.
//
// Each opening of a store makes a new generation, a number and a random mark, in three moves: the
// store notes it as its next; etcd takes it, if etcd still knows the one before; the store notes it
// as the one that it has. A crash between any two leaves a store whose present or next generation
// is the one that etcd knows. Any other store of the label (a copy from before, or one that lost
// the race for the same step) has neither, and is refused. So is a copy that was not opened since,
// which lacks what came after it: its file is another one.
//
// A lease goes with it. Its end is counted from when the last renewal that succeeded was sent, so
// it comes here before it comes in etcd, however long the answer took.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

// ---- generations
typedef struct cau_generation {
	int64_t number; // 0: none
	uint64_t mark;  // random
} cau_generation;

enum { CAU_GENERATION_BYTES = 48 }; // of its text, closing zero included

bool cau_generation_same(cau_generation a, cau_generation b);
// "17:00c0ffee00c0ffee"; none is "".
void cau_generation_write(cau_generation generation, char text[CAU_GENERATION_BYTES]);
// Exactly what is written, of `bytes`. False: it is none.
bool cau_generation_read(const char *text, size_t bytes, cau_generation *generation);

// ---- may this store be served?
typedef struct cau_claim {
	cau_generation held, next; // of the store
	cau_generation known;      // of etcd
	bool is_held;              // etcd knows a holder whose lease has not ended
	bool is_held_here; // and it was a process on this very file, which is gone: its lock is ours
	bool is_copy;      // the store's file is another than the one that was opened last
	bool take_label;   // the operator says that this store is the one
} cau_claim;

typedef enum cau_verdict { CAU_VERDICT_CLAIM, CAU_VERDICT_WAIT, CAU_VERDICT_REFUSE } cau_verdict;

// WAIT: another holds the label until its lease ends. REFUSE fills *error (CAU_BAD_STATE).
cau_verdict cau_lease_judge(const cau_claim *claim, cau_error *error);
// Chooses claim->next, the generation after all that are known, for the store to note before etcd
// is asked to take it; `mark` is random. A store that had not heard that etcd took its last one has
// it as the one held. *has_next, false at the start of a process: all attempts of a start have the
// same, since a request that was given up may still arrive, and each start has its own, since what
// was copied after a start that failed is no copy of the newest.
void cau_lease_choose(cau_claim *claim, bool *has_next, uint64_t mark);

// ---- until when?
typedef struct cau_lease_rules {
	double ttl_s;    // asked of etcd
	double margin_s; // the end comes so much earlier here: clocks, and what is under way
	double renew_s;  // from one renewal to the next
	double limit_s;  // for one answer
	double retry_s;  // after a renewal that failed
} cau_lease_rules;

// Shares of the time to live that leave room for three addresses that do not answer.
cau_lease_rules cau_lease_rules_of(double ttl_s);

typedef struct cau_lease_logic {
	cau_lease_rules rules;
	double held_until_s;
	double ask_at_s;
	bool lost; // for good
} cau_lease_logic;

typedef enum cau_renewal {
	CAU_RENEWED,
	CAU_RENEWAL_GONE,   // etcd says that there is no such lease
	CAU_RENEWAL_UNKNOWN // no answer, or none that can be read
} cau_renewal;

// The lease was granted for `ttl_s` by a request that was sent at `sent_s`.
void cau_lease_begin(cau_lease_logic *logic, const cau_lease_rules *rules, double sent_s,
                     double ttl_s);
// What came of a renewal that was sent at `sent_s`.
void cau_lease_answer(cau_lease_logic *logic, cau_renewal renewal, double sent_s, double ttl_s,
                      double now_s);

typedef struct cau_lease_step {
	enum { CAU_LEASE_WAIT, CAU_LEASE_RENEW, CAU_LEASE_END } kind;
	double seconds; // to wait; or the answer's limit
} cau_lease_step;
cau_lease_step cau_lease_next(cau_lease_logic *logic, double now_s);
