// SPDX-License-Identifier: GPL-3.0-or-later
// Asking etcd, by its JSON gateway over HTTP: one request, one answer, within a time limit, from
// one of several addresses. Whoever calls waits; so only the start of the daemon and the lease's
// own thread do.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"
#include "lease/answer.h"

typedef struct cau_etcd cau_etcd;

// `addresses`: "http://10.0.0.21:2379,http://10.0.0.22:2379". Copied. One thread at a time uses it.
// Errors: CAU_BAD_VALUE, CAU_NO_MEMORY.
cau_status cau_etcd_create(cau_etcd **etcd, const char *addresses, cau_error *error);
void cau_etcd_destroy(cau_etcd *etcd); // takes NULL

// Each asks the address that answered last. One that does not answer within `limit_s`, or answers
// with an error, is CAU_IO, and the next request asks the next address. CAU_CORRUPT: an answer that
// cannot be read, likewise.
cau_status cau_etcd_grant(cau_etcd *etcd, double ttl_s, double limit_s, cau_etcd_lease *lease,
                          cau_error *error);
cau_status cau_etcd_renew(cau_etcd *etcd, int64_t id, double limit_s, cau_etcd_lease *lease,
                          cau_error *error);
cau_status cau_etcd_revoke(cau_etcd *etcd, int64_t id, double limit_s, cau_error *error);

// The keys are `prefix` with each of two names behind it, as in read.
enum { CAU_ETCD_KEY_BYTES = 96 };
typedef struct cau_etcd_keys {
	char generation[CAU_ETCD_KEY_BYTES], holder[CAU_ETCD_KEY_BYTES];
} cau_etcd_keys;
// "cautery/d1/generation" and "cautery/d1/holder".
void cau_etcd_name_keys(const char *label, cau_etcd_keys *keys);

cau_status cau_etcd_read(cau_etcd *etcd, const cau_etcd_keys *keys, double limit_s,
                         cau_etcd_value *generation, cau_etcd_value *holder, cau_error *error);
// Writes both, the holder for as long as the lease lives, if neither has changed since it was read.
// *taken says whether.
cau_status cau_etcd_claim(cau_etcd *etcd, const cau_etcd_keys *keys,
                          const cau_etcd_value *generation, const cau_etcd_value *holder,
                          const char *new_generation, const char *new_holder, int64_t lease,
                          double limit_s, bool *taken, cau_error *error);
