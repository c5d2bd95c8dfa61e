// SPDX-License-Identifier: GPL-3.0-or-later
// What etcd answers to the few requests that are made of it, by its JSON gateway (v3): pure
// functions over bytes from outside. Members that are not known are skipped; what is known must be
// as etcd writes it: numbers as text, keys and values in base64. `text` ends with a zero behind its
// bytes.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

enum {
	CAU_ETCD_ANSWER_BYTES = 16384, // the answers that are waited for are a tenth of it
	CAU_ETCD_VALUE_BYTES = 256,
};

typedef struct cau_etcd_lease {
	int64_t id;
	double ttl_s; // 0: there is no such lease any more
} cau_etcd_lease;

// Of lease/grant ({"ID": "..", "TTL": ".."}) and lease/keepalive (the same in "result"). An answer
// to keepalive without a TTL is one for a lease that is gone. Errors: CAU_CORRUPT.
cau_status cau_etcd_read_lease(const char *text, size_t bytes, cau_etcd_lease *lease,
                               cau_error *error);

typedef struct cau_etcd_value {
	bool is_there;
	int64_t revision; // of its last change; 0: it is not there
	int64_t lease;    // 0: none
	size_t bytes;
	char text[CAU_ETCD_VALUE_BYTES];
} cau_etcd_value;

// Of kv/range: the value of each of `count` keys, which are plain text. Errors: CAU_CORRUPT.
cau_status cau_etcd_read_values(const char *text, size_t bytes, const char *const *keys,
                                cau_etcd_value *values, size_t count, cau_error *error);

// Of kv/txn: whether its conditions held. Errors: CAU_CORRUPT.
cau_status cau_etcd_read_success(const char *text, size_t bytes, bool *success, cau_error *error);
