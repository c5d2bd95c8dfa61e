// SPDX-License-Identifier: GPL-3.0-or-later
// Runs seeds: each simulates the whole daemon.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cautery/options.h"
#include "simulation/run.h"
#include "simulation/shrink.h"

enum {
	LONG_S = 3600,
	// number of seeds that the suite runs; the suite must find each fault in one of them
	FAULT_SEEDS = 100,
};

typedef struct asked {
	int64_t seed;
	int32_t seeds, jobs;
	double seconds;
	const char *steps, *fault;
	bool help, replay, twice, each_fault, faults, long_form;
} asked;

static const cau_option rows[] = {
	{"seed", "N", CAU_OPTION_LONG, offsetof(asked, seed), 0, 9e15, .meaning = "the first seed; 1"},
	{"seeds", "N", CAU_OPTION_WHOLE, offsetof(asked, seeds), 1, 1e9, .meaning = "so many at most"},
	{"seconds", "S", CAU_OPTION_NUMBER, offsetof(asked, seconds), 0.1, 1e6,
     .meaning = "no new seed after so long; 10"},
	{"jobs", "N", CAU_OPTION_WHOLE, offsetof(asked, jobs), 1, RUNS_MOST,
     .meaning = "so many seeds at once; one for each processor"},
	{"long", NULL, CAU_OPTION_FLAG, offsetof(asked, long_form), .meaning = "an hour"},
	{"replay", NULL, CAU_OPTION_FLAG, offsetof(asked, replay),
     .meaning = "one seed, with its steps and everything that is sent and logged"},
	{"steps", "LIST", CAU_OPTION_TEXT, offsetof(asked, steps),
     .meaning = "of the seed's steps these alone: 0-3,7"},
	{"twice", NULL, CAU_OPTION_FLAG, offsetof(asked, twice),
     .meaning = "each seed twice: both runs are to be the same"},
	{"fault", "WORD", CAU_OPTION_TEXT, offsetof(asked, fault),
     .meaning = "with this fault planted"},
	{"each-fault", NULL, CAU_OPTION_FLAG, offsetof(asked, each_fault),
     .meaning = "each fault in turn: seeds must find it, by the promise that is named for it"},
	{"faults", NULL, CAU_OPTION_FLAG, offsetof(asked, faults), .meaning = "lists the faults"},
	{"help", NULL, CAU_OPTION_HELP, offsetof(asked, help), .meaning = "this text"},
};

static const cau_command_line line = {
	.program = "cautery_simulation",
	.summary =
		"Runs the daemon's code with a simulated clock, network, disk and core, from seeds, and\n"
		"checks what protocol/README.md promises.\n",
	.closing = "Ends 0 if every promise was kept, 1 if not, 2 for bad arguments.\n",
	.rows = rows,
	.row_count = sizeof rows / sizeof *rows};

typedef struct totals {
	uint64_t seeds, switches;
	double simulated_s, began_s;
	promise_counts counts;
	disk_counts disk;
} totals;

static void add(totals *t, const run_result *r)
{
	t->seeds++;
	t->switches += r->switches;
	t->simulated_s += 1e-9 * (double)r->simulated_ns;
	t->counts.ticks += r->counts.ticks;
	t->counts.energized_ticks += r->counts.energized_ticks;
	t->counts.answers += r->counts.answers;
	t->counts.acknowledged += r->counts.acknowledged;
	t->counts.restarts += r->counts.restarts;
	t->counts.frames += r->counts.frames;
	t->counts.moves += r->counts.moves;
	t->disk.lost_sectors += r->disk.lost_sectors;
	t->disk.failed += r->disk.failed;
	t->disk.syncs += r->disk.syncs;
}

static void print_totals(const totals *t)
{
	double took_s = real_s() - t->began_s;
	printf(
		"%llu seeds, %.0f s simulated in %.1f s (%.0f times as fast), %llu switches of threads\n",
		(unsigned long long)t->seeds, t->simulated_s, took_s, t->simulated_s / took_s,
		(unsigned long long)t->switches);
	printf("%llu ticks, %llu of a tool with energy on, %llu answers, %llu acknowledged marks, "
	       "%llu starts, %llu frames, %llu moves\n",
	       (unsigned long long)t->counts.ticks, (unsigned long long)t->counts.energized_ticks,
	       (unsigned long long)t->counts.answers, (unsigned long long)t->counts.acknowledged,
	       (unsigned long long)t->counts.restarts, (unsigned long long)t->counts.frames,
	       (unsigned long long)t->counts.moves);
	printf("%llu syncs, %llu sectors lost, %llu failed calls of the disk\n",
	       (unsigned long long)t->disk.syncs, (unsigned long long)t->disk.lost_sectors,
	       (unsigned long long)t->disk.failed);
}

// ---- a failed seed
static void report(uint64_t seed, workload *work, run_result *result)
{
	printf("seed %llu breaks a promise: %s (%s)\n  %s\n", (unsigned long long)seed, result->promise,
	       promises_meaning(result->promise), result->text);
	shrink(seed, work, result);
	printf("with the fewest steps that still break it:\n  %s\n", result->text);
	workload_print(work);
	printf("replay it:\n  cautery_simulation --replay --seed %llu", (unsigned long long)seed);
	if (sim_planted)
		printf(" --fault %s", faults_word(sim_planted));
	printf(" --steps ");
	shrink_print(work);
	printf("\n");
}

static bool differs(uint64_t seed, const workload *work, const run_result *first)
{
	run_result second;
	run_seed(seed, work, &second);
	if (second.trace == first->trace && second.switches == first->switches)
		return false;
	printf("seed %llu runs otherwise the second time: %llu switches, then %llu\n",
	       (unsigned long long)seed, (unsigned long long)first->switches,
	       (unsigned long long)second.switches);
	return true;
}

static bool make_work(const asked *a, uint64_t seed, workload *work)
{
	sim_profile profile = sim_profile_of(seed);
	workload_make(work, seed, &profile);
	return shrink_choose(work, a->steps);
}

// Takes the result of a run. Returns false if the other runs need not be started.
static bool take(const asked *a, uint64_t seed, run_result *result, totals *t)
{
	static workload work;
	make_work(a, seed, &work);
	if (result->failed) {
		report(seed, &work, result);
		return false;
	}
	if (a->twice && differs(seed, &work, result))
		return false;
	add(t, result);
	return true;
}

static int run_all(const asked *a)
{
	static workload work;
	static run_child children[RUNS_MOST];
	run_result result;
	totals t = {.began_s = real_s()};
	int64_t begun = 0;
	int count = 0;
	bool kept = true;
	for (;;) {
		for (; kept && count < a->jobs && begun < a->seeds && real_s() - t.began_s < a->seconds;
		     begun++, count++) {
			if (!make_work(a, (uint64_t)(a->seed + begun), &work))
				return 2;
			run_begin((uint64_t)(a->seed + begun), &work, &children[count]);
		}
		if (!count)
			break;
		int ended = run_end(children, count, &result);
		uint64_t seed = children[ended].seed;
		children[ended] = children[--count];
		kept = take(a, seed, &result, &t) && kept;
	}
	if (kept)
		print_totals(&t);
	return kept ? 0 : 1;
}

static int replay(const asked *a)
{
	static workload work;
	if (!make_work(a, (uint64_t)a->seed, &work))
		return 2;
	workload_print(&work);
	fflush(stdout);
	sim_verbose = true;
	run_here((uint64_t)a->seed, &work);
	printf("every promise was kept\n");
	return 0;
}

// ---- planted faults
typedef struct hunt {
	sim_fault fault;
	char others[256]; // other promises that were broken instead of the named one
} hunt;

// True if this seed breaks the promise that is named for the fault.
static bool finds(hunt *h, uint64_t seed)
{
	static workload work;
	run_result result;
	sim_profile profile = sim_profile_of(seed);
	workload_make(&work, seed, &profile);
	run_seed(seed, &work, &result);
	if (result.failed && strcmp(result.promise, faults_promise(h->fault)) == 0) {
		printf("%-22s %-15s seed %llu%s: %s\n", faults_word(h->fault), result.promise,
		       (unsigned long long)seed, h->others, result.text);
		return true;
	}
	size_t at = strlen(h->others);
	if (result.failed && !strstr(h->others, result.promise) && at + 40 < sizeof h->others)
		snprintf(h->others + at, sizeof h->others - at, "%s%s", at ? ", " : ", before it ",
		         result.promise);
	return false;
}

// Searches for a seed that breaks the named promise. Most faults break several promises, and a run
// ends at the first broken promise. The search begins with the seed that found the fault last, if
// the suite has this seed.
static bool find_fault(const asked *a, sim_fault fault)
{
	hunt h = {.fault = fault};
	int64_t last = faults_found_by(fault) - a->seed;
	sim_planted = fault;
	if (last >= 0 && last < FAULT_SEEDS && finds(&h, (uint64_t)(a->seed + last)))
		return true;
	for (int64_t i = 0; i < FAULT_SEEDS; i++)
		if (i != last && finds(&h, (uint64_t)(a->seed + i)))
			return true;
	printf("%-22s %-15s NOT broken by %d seeds%s\n", faults_word(fault), faults_promise(fault),
	       FAULT_SEEDS, h.others);
	return false;
}

static int find_each(const asked *a)
{
	int found = 0, count = FAULT_COUNT - 1;
	for (int fault = 1; fault < FAULT_COUNT; fault++)
		found += find_fault(a, (sim_fault)fault);
	printf("%d of %d faults found\n", found, count);
	return found == count ? 0 : 1;
}

static bool plant(const char *word)
{
	for (int fault = 1; word && fault < FAULT_COUNT; fault++)
		if (strcmp(faults_word((sim_fault)fault), word) == 0)
			sim_planted = (sim_fault)fault;
	if (word && !sim_planted)
		fprintf(stderr, "cautery_simulation: no fault `%s`: --faults lists them\n", word);
	return !word || sim_planted;
}

int main(int argument_count, char **arguments)
{
	asked a = {.seed = 1, .seeds = INT32_MAX, .seconds = 10};
	a.jobs = (int32_t)fmin((double)sysconf(_SC_NPROCESSORS_ONLN), RUNS_MOST);
	if (!cau_options_read(&line, argument_count, arguments, &a, NULL, stderr))
		return 2;
	if (a.help) {
		cau_options_help(&line, stdout);
		return 0;
	}
	for (int fault = 1; a.faults && fault < FAULT_COUNT; fault++)
		printf("%-24s %-15s %s\n", faults_word((sim_fault)fault), faults_promise((sim_fault)fault),
		       faults_meaning((sim_fault)fault));
	if (a.faults)
		return 0;
	if (!plant(a.fault))
		return 2;
	if (a.long_form)
		a.seconds = LONG_S;
	return a.each_fault ? find_each(&a) : a.replay ? replay(&a) : run_all(&a);
}
