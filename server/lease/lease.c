// SPDX-License-Identifier: GPL-3.0-or-later
#include "lease/lease.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "cautery/assert.h"
#include "lease/etcd.h"
#include "log/log.h"

static const double wait_s = 0.25;     // time between checks of a label that another daemon holds
static const double give_back_s = 0.5; // time limit for giving the label back to etcd

struct cau_lease {
	cau_lease_def def;
	char label[64];
	cau_etcd *etcd;
	cau_etcd_keys keys;
	cau_lease_rules rules;
	cau_lease_logic logic; // used by the lease's thread
	cau_generation held, next;
	bool has_next; // `next` was made by this start, and etcd does not know it yet
	int64_t id;    // id of the lease in etcd
	char holder[96];
	// file: inode of the database now; stored_file: inode that the database has stored, 0: no inode
	uintmax_t file, stored_file;
	_Atomic int64_t held_until_us; // the logic's held_until_s, for other threads
	int ending;                    // eventfd that ends the thread
	pthread_t thread;
	bool started;
};

// Returns the time of a clock that continues while the machine sleeps, as etcd's does.
static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_BOOTTIME, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool wait_for_end(const cau_lease *lease, double seconds)
{
	struct pollfd ending = {.fd = lease->ending, .events = POLLIN};
	return poll(&ending, 1, (int)ceil(1000 * fmax(0, seconds))) > 0;
}

// ---- the holder's name
// Names this boot of this machine's kernel. If the boot id cannot be read, the name is random. The
// machine id is not used, because copies of a disk share it.
static cau_status name_kernel(char name[40], cau_error *error)
{
	uint64_t random[2];
	FILE *stream = fopen("/proc/sys/kernel/random/boot_id", "re");
	bool read = stream && fgets(name, 40, stream) && strspn(name, "0123456789abcdef-") == 36;
	if (stream)
		fclose(stream);
	if (read)
		return CAU_OK;
	if (getrandom(random, sizeof random, 0) != sizeof random)
		return cau_fail(error, CAU_IO, NULL, "the system gives no random bytes");
	snprintf(name, 40, "%016" PRIx64 "-%016" PRIx64, random[0], random[1]);
	return CAU_OK;
}

// Names the holder by the kernel and the database's file. Only one process at a time can lock that
// file, and this process has the lock now. So an earlier holder with the same name has ended.
static cau_status name_holder(cau_lease *lease, cau_error *error)
{
	char kernel[40];
	struct stat file;
	if (stat(lease->def.store, &file))
		return cau_fail(error, CAU_IO, "store", "%s", strerrordesc_np(errno));
	cau_status status = name_kernel(kernel, error);
	if (status)
		return status;
	lease->file = file.st_ino;
	snprintf(lease->holder, sizeof lease->holder, "%.36s %" PRIuMAX ":%" PRIuMAX, kernel,
	         (uintmax_t)file.st_dev, (uintmax_t)file.st_ino);
	return CAU_OK;
}

// ---- generations in the store
static cau_status read_stored(cau_lease *lease, cau_error *error)
{
	const char *text = lease->def.stored, *first = strchr(text, ' ');
	const char *second = first ? strchr(first + 1, ' ') : NULL;
	if (!*text)
		return CAU_OK;
	char *end = NULL;
	if (second && cau_generation_read(text, (size_t)(first - text), &lease->held) &&
	    cau_generation_read(first + 1, (size_t)(second - first - 1), &lease->next))
		lease->stored_file = strtoumax(second + 1, &end, 10);
	if (end && end > second + 1 && *end == 0)
		return CAU_OK;
	return cau_fail(error, CAU_CORRUPT, "store", "`%.60s` in the store is not a generation", text);
}

static cau_status store(const cau_lease *lease, cau_error *error)
{
	char held[CAU_GENERATION_BYTES], next[CAU_GENERATION_BYTES], text[CAU_LEASE_STORED_BYTES];
	cau_generation_write(lease->held, held);
	cau_generation_write(lease->next, next);
	snprintf(text, sizeof text, "%s %s %" PRIuMAX, held, next, lease->file);
	return lease->def.store_generation(lease->def.user, text, error);
}

// ---- taking the label
// Makes one attempt. CAU_BAD_STATE with *again: another daemon holds the label, or was faster.
static cau_status judge(cau_lease *lease, cau_etcd_value *generation, cau_etcd_value *holder,
                        bool *again, cau_error *error)
{
	cau_claim claim = {.held = lease->held,
	                   .next = lease->next,
	                   .is_copy = lease->stored_file != 0 && lease->stored_file != lease->file,
	                   .take_label = lease->def.take_label};
	cau_status status =
		cau_etcd_read(lease->etcd, &lease->keys, lease->rules.limit_s, generation, holder, error);
	*again = status != CAU_OK;
	if (status)
		return status;
	if (generation->is_there &&
	    (!cau_generation_read(generation->text, generation->bytes, &claim.known) ||
	     claim.known.number == 0))
		return cau_fail(error, CAU_CORRUPT, "etcd",
		                "the value of %.80s in etcd is not a generation", lease->keys.generation);
	claim.is_held = holder->is_there;
	claim.is_held_here = holder->bytes == strlen(lease->holder) &&
	                     memcmp(holder->text, lease->holder, holder->bytes) == 0;
	cau_verdict verdict = cau_lease_judge(&claim, error);
	*again = verdict == CAU_VERDICT_WAIT;
	if (verdict == CAU_VERDICT_WAIT)
		return cau_fail(error, CAU_BAD_STATE, "etcd",
		                "another daemon serves the label %.60s: %.80s", lease->label, holder->text);
	if (verdict == CAU_VERDICT_REFUSE)
		return error->status;
	uint64_t mark = 0;
	if (getrandom(&mark, sizeof mark, 0) != sizeof mark)
		return cau_fail(error, CAU_IO, NULL, "the system gives no random bytes");
	cau_lease_choose(&claim, &lease->has_next, mark);
	lease->held = claim.held;
	lease->next = claim.next;
	return CAU_OK;
}

// Makes one attempt to take the label. If the answer to a claim is lost, the next attempt finds the
// claim in etcd, with our name.
static cau_status try_to_take(cau_lease *lease, bool *again, cau_error *error)
{
	char next[CAU_GENERATION_BYTES];
	cau_etcd_value generation, holder;
	cau_etcd_lease granted;
	bool taken = false;
	cau_status status = judge(lease, &generation, &holder, again, error);
	if (!status)
		status = store(lease, error);
	if (status)
		return status;
	*again = true;
	double sent_s = now_s();
	status = cau_etcd_grant(lease->etcd, lease->rules.ttl_s, lease->rules.limit_s, &granted, error);
	if (!status && granted.ttl_s < 1)
		status =
			cau_fail(error, CAU_CORRUPT, "etcd", "etcd granted a lease without a time to live");
	cau_generation_write(lease->next, next);
	if (!status)
		status = cau_etcd_claim(lease->etcd, &lease->keys, &generation, &holder, next,
		                        lease->holder, granted.id, lease->rules.limit_s, &taken, error);
	if (!status && !taken)
		status = cau_fail(error, CAU_BAD_STATE, "etcd",
		                  "another daemon took the label %.60s at the same moment", lease->label);
	if (status)
		return status;
	*again = false;
	lease->id = granted.id;
	lease->held = lease->next;
	cau_lease_begin(&lease->logic, &lease->rules, sent_s, granted.ttl_s);
	return store(lease, error);
}

static cau_status take(cau_lease *lease, cau_error *error)
{
	bool again, told = false;
	double until_s = now_s() + 2 * lease->rules.ttl_s;
	for (;;) {
		cau_status status = try_to_take(lease, &again, error);
		if (!status || !again || now_s() >= until_s)
			return status;
		if (!told)
			cau_log(CAU_LOG_NOTICE, NULL, "label_awaited", "label=%s reason=\"%s\"", lease->label,
			        error->reason);
		told = true;
		wait_for_end(lease, wait_s);
	}
}

// ---- renewing the lease
static void publish(cau_lease *lease)
{
	atomic_store(&lease->held_until_us, (int64_t)(1e6 * lease->logic.held_until_s));
}

static void renew(cau_lease *lease, double limit_s)
{
	cau_error error = {0};
	cau_etcd_lease answer = {0};
	double sent_s = now_s();
	cau_status status = cau_etcd_renew(lease->etcd, lease->id, limit_s, &answer, &error);
	cau_renewal renewal = status              ? CAU_RENEWAL_UNKNOWN
	                      : answer.ttl_s == 0 ? CAU_RENEWAL_GONE
	                                          : CAU_RENEWED;
	cau_lease_answer(&lease->logic, renewal, sent_s, answer.ttl_s, now_s());
	publish(lease);
	if (status)
		cau_log(CAU_LOG_WARNING, NULL, "label_not_renewed", "label=%s left_s=%.1f reason=\"%s\"",
		        lease->label, lease->logic.held_until_s - now_s(), error.reason);
}

static void *keep(void *argument)
{
	cau_lease *lease = argument;
	pthread_setname_np(pthread_self(), "cautery-lease");
	for (;;) {
		cau_lease_step step = cau_lease_next(&lease->logic, now_s());
		if (step.kind == CAU_LEASE_END)
			lease->def.lost(lease->def.user, "etcd did not renew the lease");
		if (step.kind == CAU_LEASE_RENEW)
			renew(lease, step.seconds);
		else if (wait_for_end(lease, step.seconds))
			return NULL;
	}
}

double cau_lease_check(cau_lease *lease)
{
	double left_s = 1e-6 * (double)atomic_load(&lease->held_until_us) - now_s();
	if (left_s <= 0)
		lease->def.lost(lease->def.user, "etcd did not renew the lease in time");
	return left_s;
}

int64_t cau_lease_generation(const cau_lease *lease)
{
	return lease->held.number;
}

// ---- creating and destroying
static void destroy(cau_lease *lease)
{
	cau_etcd_destroy(lease->etcd);
	if (lease->ending >= 0)
		close(lease->ending);
	free(lease);
}

static cau_status start_thread(cau_lease *lease, cau_error *error)
{
	publish(lease);
	int code = pthread_create(&lease->thread, NULL, keep, lease);
	lease->started = code == 0;
	return code ? cau_fail(error, CAU_NO_MEMORY, NULL,
	                       "cannot start the lease's thread: %s (its limit: ulimit -u)",
	                       strerrordesc_np(code))
	            : CAU_OK;
}

cau_status cau_lease_take(cau_lease **made, const cau_lease_def *def, cau_error *error)
{
	*made = NULL;
	cau_lease *lease = calloc(1, sizeof *lease);
	if (!lease)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the lease");
	lease->def = *def;
	snprintf(lease->label, sizeof lease->label, "%s", def->label);
	cau_etcd_name_keys(lease->label, &lease->keys);
	lease->rules = cau_lease_rules_of(def->ttl_s);
	lease->ending = eventfd(0, EFD_CLOEXEC);
	cau_status status = lease->ending < 0
	                        ? cau_fail(error, CAU_IO, NULL, "cannot create the lease's eventfd: %s",
	                                   strerrordesc_np(errno))
	                        : cau_etcd_create(&lease->etcd, def->addresses, error);
	if (!status)
		status = read_stored(lease, error);
	if (!status)
		status = name_holder(lease, error);
	if (!status)
		status = take(lease, error);
	if (!status)
		status = start_thread(lease, error);
	if (status) {
		destroy(lease);
		return status;
	}
	cau_log(CAU_LOG_NOTICE, NULL, "label_taken", "label=%s generation=%" PRId64 " ttl_s=%g",
	        lease->label, lease->held.number, lease->rules.ttl_s);
	*made = lease;
	return CAU_OK;
}

void cau_lease_give_back(cau_lease *lease)
{
	if (!lease)
		return;
	eventfd_write(lease->ending, 1);
	pthread_join(lease->thread, NULL);
	cau_etcd_revoke(lease->etcd, lease->id, give_back_s, NULL);
	destroy(lease);
}
