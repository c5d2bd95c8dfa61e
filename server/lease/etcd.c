// SPDX-License-Identifier: GPL-3.0-or-later
#include "lease/etcd.h"

#include <curl/curl.h>
#include <inttypes.h>
#include <math.h>
#include <openssl/evp.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

enum { ADDRESSES_MAX = 9, ADDRESS_BYTES = 256, REQUEST_BYTES = 4096 };

struct cau_etcd {
	CURL *curl;
	struct curl_slist *headers;
	char address[ADDRESSES_MAX][ADDRESS_BYTES];
	int address_count, address_in_use;
	size_t answer_bytes;
	char answer[CAU_ETCD_ANSWER_BYTES + 1];
	char trouble[CURL_ERROR_SIZE];
};

// ---- creating and destroying
static void start_library(void)
{
	curl_global_init(CURL_GLOBAL_DEFAULT);
}

static bool is_address(const char *text)
{
	return strncmp(text, "http://", 7) == 0 || strncmp(text, "https://", 8) == 0;
}

static cau_status read_addresses(cau_etcd *etcd, const char *text, cau_error *error)
{
	for (const char *at = text; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
		size_t bytes = strcspn(at, ",");
		if (bytes >= ADDRESS_BYTES || etcd->address_count == ADDRESSES_MAX)
			return cau_fail(error, CAU_BAD_VALUE, "etcd",
			                "at most %d addresses of at most %d bytes each are allowed",
			                ADDRESSES_MAX, ADDRESS_BYTES - 1);
		char *address = etcd->address[etcd->address_count++];
		memcpy(address, at, bytes);
		while (bytes > 0 && address[bytes - 1] == '/')
			bytes--;
		address[bytes] = 0;
		if (!is_address(address))
			return cau_fail(error, CAU_BAD_VALUE, "etcd",
			                "`%.100s` is no address as in http://10.0.0.21:2379", address);
	}
	return CAU_OK;
}

cau_status cau_etcd_create(cau_etcd **made, const char *addresses, cau_error *error)
{
	static pthread_once_t started = PTHREAD_ONCE_INIT;
	*made = NULL;
	cau_etcd *etcd = calloc(1, sizeof *etcd);
	if (!etcd)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to ask etcd");
	pthread_once(&started, start_library);
	etcd->curl = curl_easy_init();
	etcd->headers = curl_slist_append(NULL, "Content-Type: application/json");
	cau_status status = !etcd->curl || !etcd->headers
	                        ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to ask etcd")
	                        : read_addresses(etcd, addresses, error);
	if (status)
		cau_etcd_destroy(etcd);
	else
		*made = etcd;
	return status;
}

void cau_etcd_destroy(cau_etcd *etcd)
{
	if (!etcd)
		return;
	curl_easy_cleanup(etcd->curl);
	curl_slist_free_all(etcd->headers);
	free(etcd);
}

// ---- one request
static size_t take(char *bytes, size_t size, size_t count, void *user)
{
	cau_etcd *etcd = user;
	if (size * count > CAU_ETCD_ANSWER_BYTES - etcd->answer_bytes)
		return 0; // ends the request with an error
	memcpy(etcd->answer + etcd->answer_bytes, bytes, size * count);
	etcd->answer_bytes += size * count;
	etcd->answer[etcd->answer_bytes] = 0;
	return size * count;
}

// Sets up a request. The library uses no signals, because other threads handle signals. It uses no
// proxy from the environment, because etcd is near. It uses only http and https, even after a
// redirect.
static void prepare(cau_etcd *etcd, const char *url, const char *request, double limit_s)
{
	CURL *curl = etcd->curl;
	long limit_ms = (long)fmax(1, ceil(1000 * limit_s));
	curl_easy_reset(curl);
	curl_easy_setopt(curl, CURLOPT_URL, url);
	curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
	curl_easy_setopt(curl, CURLOPT_PROXY, "");
	curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
	curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, limit_ms);
	curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, limit_ms);
	curl_easy_setopt(curl, CURLOPT_HTTPHEADER, etcd->headers);
	curl_easy_setopt(curl, CURLOPT_POSTFIELDS, request);
	curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, take);
	curl_easy_setopt(curl, CURLOPT_WRITEDATA, etcd);
	curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, etcd->trouble);
}

static cau_status ask_once(cau_etcd *etcd, const char *path, const char *request, double limit_s,
                           cau_error *error)
{
	char url[ADDRESS_BYTES + 40];
	const char *address = etcd->address[etcd->address_in_use];
	snprintf(url, sizeof url, "%s/v3/%s", address, path);
	etcd->answer_bytes = 0;
	*etcd->answer = *etcd->trouble = 0;
	prepare(etcd, url, request, limit_s);
	long http_status = 0;
	CURLcode code = curl_easy_perform(etcd->curl);
	curl_easy_getinfo(etcd->curl, CURLINFO_RESPONSE_CODE, &http_status);
	if (code)
		return cau_fail(error, CAU_IO, "etcd", "%.100s: %.150s", address,
		                *etcd->trouble ? etcd->trouble : curl_easy_strerror(code));
	if (http_status != 200)
		return cau_fail(error, CAU_IO, "etcd", "%.100s answered HTTP %ld: %.120s", address,
		                http_status, etcd->answer);
	return CAU_OK;
}

static cau_status after(cau_etcd *etcd, cau_status status)
{
	if (status)
		etcd->address_in_use = (etcd->address_in_use + 1) % etcd->address_count;
	return status;
}

// Requests about leases. If a lease is gone, keepalive answers with a TTL of 0.
cau_status cau_etcd_grant(cau_etcd *etcd, double ttl_s, double limit_s, cau_etcd_lease *lease,
                          cau_error *error)
{
	char request[REQUEST_BYTES];
	snprintf(request, sizeof request, "{\"TTL\": \"%.0f\"}", ttl_s);
	cau_status status = ask_once(etcd, "lease/grant", request, limit_s, error);
	if (!status)
		status = cau_etcd_read_lease(etcd->answer, etcd->answer_bytes, lease, error);
	return after(etcd, status);
}

cau_status cau_etcd_renew(cau_etcd *etcd, int64_t id, double limit_s, cau_etcd_lease *lease,
                          cau_error *error)
{
	char request[REQUEST_BYTES];
	snprintf(request, sizeof request, "{\"ID\": \"%" PRId64 "\"}", id);
	cau_status status = ask_once(etcd, "lease/keepalive", request, limit_s, error);
	if (!status)
		status = cau_etcd_read_lease(etcd->answer, etcd->answer_bytes, lease, error);
	if (!status && lease->id != id)
		status = cau_fail(error, CAU_CORRUPT, "etcd", "an answer for another lease");
	return after(etcd, status);
}

cau_status cau_etcd_revoke(cau_etcd *etcd, int64_t id, double limit_s, cau_error *error)
{
	char request[REQUEST_BYTES];
	snprintf(request, sizeof request, "{\"ID\": \"%" PRId64 "\"}", id);
	return after(etcd, ask_once(etcd, "lease/revoke", request, limit_s, error));
}

// ---- keys
typedef struct encoded {
	char text[(CAU_ETCD_VALUE_BYTES + 2) / 3 * 4 + 1];
} encoded;

static encoded encode(const char *text)
{
	encoded out = {{0}};
	size_t bytes = strlen(text);
	CAU_ASSERT(bytes < CAU_ETCD_VALUE_BYTES, "%zu bytes for etcd", bytes);
	EVP_EncodeBlock((unsigned char *)out.text, (const unsigned char *)text, (int)bytes);
	return out;
}

void cau_etcd_name_keys(const char *label, cau_etcd_keys *keys)
{
	snprintf(keys->generation, sizeof keys->generation, "cautery/%.60s/generation", label);
	snprintf(keys->holder, sizeof keys->holder, "cautery/%.60s/holder", label);
}

// Reads both keys with one range, which begins at the first key and ends just behind the second.
// The second key comes after the first in etcd's order.
cau_status cau_etcd_read(cau_etcd *etcd, const cau_etcd_keys *keys, double limit_s,
                         cau_etcd_value *generation, cau_etcd_value *holder, cau_error *error)
{
	char request[REQUEST_BYTES], end[CAU_ETCD_KEY_BYTES + 1];
	const char *names[] = {keys->generation, keys->holder};
	cau_etcd_value values[2];
	snprintf(end, sizeof end, "%s~", keys->holder);
	snprintf(request, sizeof request, "{\"key\": \"%s\", \"range_end\": \"%s\", \"limit\": \"8\"}",
	         encode(keys->generation).text, encode(end).text);
	cau_status status = ask_once(etcd, "kv/range", request, limit_s, error);
	if (!status)
		status = cau_etcd_read_values(etcd->answer, etcd->answer_bytes, names, values, 2, error);
	if (!status) {
		*generation = values[0];
		*holder = values[1];
	}
	return after(etcd, status);
}

cau_status cau_etcd_claim(cau_etcd *etcd, const cau_etcd_keys *keys,
                          const cau_etcd_value *generation, const cau_etcd_value *holder,
                          const char *new_generation, const char *new_holder, int64_t lease,
                          double limit_s, bool *taken, cau_error *error)
{
	char request[REQUEST_BYTES];
	encoded first = encode(keys->generation), second = encode(keys->holder);
	snprintf(request, sizeof request,
	         "{\"compare\": [{\"key\": \"%s\", \"target\": \"MOD\", \"mod_revision\": \"%" PRId64
	         "\"}, {\"key\": \"%s\", \"target\": \"MOD\", \"mod_revision\": \"%" PRId64
	         "\"}], \"success\": [{\"request_put\": {\"key\": \"%s\", \"value\": \"%s\"}}, "
	         "{\"request_put\": {\"key\": \"%s\", \"value\": \"%s\", \"lease\": \"%" PRId64
	         "\"}}]}",
	         first.text, generation->revision, second.text, holder->revision, first.text,
	         encode(new_generation).text, second.text, encode(new_holder).text, lease);
	cau_status status = ask_once(etcd, "kv/txn", request, limit_s, error);
	*taken = false;
	if (!status)
		status = cau_etcd_read_success(etcd->answer, etcd->answer_bytes, taken, error);
	return after(etcd, status);
}
