// SPDX-License-Identifier: GPL-3.0-or-later
#include "lease/logic.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

// ---- generations
bool cau_generation_same(cau_generation a, cau_generation b)
{
	return a.number == b.number && a.mark == b.mark;
}

void cau_generation_write(cau_generation generation, char text[CAU_GENERATION_BYTES])
{
	*text = 0;
	if (generation.number > 0)
		snprintf(text, CAU_GENERATION_BYTES, "%" PRId64 ":%016" PRIx64, generation.number,
		         generation.mark);
}

// Largest number of a generation that is read. It is below INT64_MAX, so that there are numbers
// left for later generations.
static const int64_t number_most = 999999999999999999;

// Reads a generation. The text must be exactly what cau_generation_write writes, so that each
// generation has one text.
bool cau_generation_read(const char *text, size_t bytes, cau_generation *generation)
{
	char copy[CAU_GENERATION_BYTES], again[CAU_GENERATION_BYTES];
	*generation = (cau_generation){0};
	if (bytes >= sizeof copy)
		return false;
	memcpy(copy, text, bytes);
	copy[bytes] = 0;
	char *colon = copy, *end = copy;
	cau_generation found = {.number = strtoll(copy, &colon, 10)};
	if (bytes > 0 && *colon == ':')
		found.mark = strtoull(colon + 1, &end, 16);
	if (found.number < 0 || found.number > number_most || *end)
		return false;
	cau_generation_write(found, again);
	if (strlen(again) != bytes || memcmp(again, copy, bytes) != 0)
		return false;
	*generation = found;
	return true;
}

// ---- whether this store may be served
static bool is_the_newest(const cau_claim *claim)
{
	if (claim->is_copy)
		return false;
	// etcd does not know the label yet, and the store has no generation yet
	if (claim->known.number == 0)
		return claim->held.number == 0;
	return cau_generation_same(claim->known, claim->held) ||
	       cau_generation_same(claim->known, claim->next);
}

static void explain(const cau_claim *claim, cau_error *error)
{
	if (claim->is_copy)
		cau_fail(
			error, CAU_BAD_STATE, "etcd",
			"this file is a copy of the store that was opened last. The original may have newer "
			"data: start that one, or give --take-label once");
	else if (claim->known.number == 0)
		cau_fail(error, CAU_BAD_STATE, "etcd",
		         "etcd has no generation of this label, but the store has generation %" PRId64
		         ". This is another etcd, or etcd has lost its data. To serve the store all the "
		         "same, give --take-label once",
		         claim->held.number);
	else
		cau_fail(error, CAU_BAD_STATE, "etcd",
		         "this store is an older copy: it has generation %" PRId64 ", etcd has %" PRId64
		         " from another store of this label. Start the newer store, or give --take-label "
		         "once, which abandons the newer data",
		         claim->held.number, claim->known.number);
}

// Judges the claim. A valid lease of another daemon is never taken away, whatever the operator
// says: it must end by itself.
cau_verdict cau_lease_judge(const cau_claim *claim, cau_error *error)
{
	if (!is_the_newest(claim) && !claim->take_label) {
		explain(claim, error);
		return CAU_VERDICT_REFUSE;
	}
	return claim->is_held && !claim->is_held_here ? CAU_VERDICT_WAIT : CAU_VERDICT_CLAIM;
}

static cau_generation after_all(const cau_claim *claim, uint64_t mark)
{
	int64_t most = claim->known.number;
	most = claim->held.number > most ? claim->held.number : most;
	most = claim->next.number > most ? claim->next.number : most;
	return (cau_generation){most + 1, mark};
}

void cau_lease_choose(cau_claim *claim, bool *has_next, uint64_t mark)
{
	if (claim->known.number > 0 && cau_generation_same(claim->known, claim->next)) {
		claim->held = claim->next;
		*has_next = false;
	}
	if (!*has_next)
		claim->next = after_all(claim, mark);
	*has_next = true;
}

// ---- the end of the lease
cau_lease_rules cau_lease_rules_of(double ttl_s)
{
	CAU_ASSERT(ttl_s >= 2, "a time to live of %g s", ttl_s);
	return (cau_lease_rules){
		.ttl_s = ttl_s,
		// The margin exceeds clock errors: at 200 ppm, two clocks differ by 12 ms after a minute.
		.margin_s = fmax(0.5, 0.1 * ttl_s),
		.renew_s = ttl_s / 4,
		.limit_s = ttl_s / 6,
		.retry_s = fmin(0.25, ttl_s / 40),
	};
}

static double end_of(const cau_lease_logic *logic, double sent_s, double ttl_s)
{
	return sent_s + fmin(ttl_s, logic->rules.ttl_s) - logic->rules.margin_s;
}

void cau_lease_begin(cau_lease_logic *logic, const cau_lease_rules *rules, double sent_s,
                     double ttl_s)
{
	*logic = (cau_lease_logic){.rules = *rules};
	logic->held_until_s = end_of(logic, sent_s, ttl_s);
	logic->ask_at_s = sent_s + rules->renew_s;
}

void cau_lease_answer(cau_lease_logic *logic, cau_renewal renewal, double sent_s, double ttl_s,
                      double now_s)
{
	CAU_ASSERT(sent_s <= now_s, "an answer at %g s to what was sent at %g s", now_s, sent_s);
	// An answer that comes after the end cannot revive the lease, because the daemon has already
	// acted on the end.
	if (now_s >= logic->held_until_s || renewal == CAU_RENEWAL_GONE)
		logic->lost = true;
	if (logic->lost)
		return;
	logic->ask_at_s = now_s + logic->rules.retry_s;
	if (renewal == CAU_RENEWED) {
		logic->held_until_s = fmax(logic->held_until_s, end_of(logic, sent_s, ttl_s));
		logic->ask_at_s = sent_s + logic->rules.renew_s;
	}
}

cau_lease_step cau_lease_next(cau_lease_logic *logic, double now_s)
{
	double left_s = logic->held_until_s - now_s;
	logic->lost = logic->lost || left_s <= 0;
	if (logic->lost)
		return (cau_lease_step){.kind = CAU_LEASE_END};
	if (now_s >= logic->ask_at_s)
		return (cau_lease_step){CAU_LEASE_RENEW, fmin(logic->rules.limit_s, left_s)};
	return (cau_lease_step){CAU_LEASE_WAIT, fmin(logic->ask_at_s, logic->held_until_s) - now_s};
}
