// SPDX-License-Identifier: GPL-3.0-or-later
// A strict scan checks the form first, so the functions below only have to find members and values.
#include "lease/etcd.h"

#include <openssl/evp.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/json_text.h"

static cau_status refuse(cau_error *error, const char *what)
{
	return cau_fail(error, CAU_CORRUPT, "etcd", "unexpected answer of etcd: %s", what);
}

// ---- moving in the text
static const char *skip_space(const char *at)
{
	return at + strspn(at, " \t\r\n");
}

// Returns the position behind the closing quote.
static const char *skip_text(const char *at)
{
	for (at++; *at != '"'; at++)
		at += *at == '\\';
	return at + 1;
}

static const char *skip_value(const char *at)
{
	int depth = 0;
	do {
		if (*at == '"') {
			at = skip_text(at);
		} else if (strchr("{[", *at)) {
			depth++;
			at++;
		} else if (strchr("}]", *at)) {
			depth--;
			at++;
		} else {
			at += strcspn(at, ",:{}[]\" \t\r\n");
			if (depth > 0 && strchr(",:", *at))
				at++;
		}
		if (depth > 0)
			at = skip_space(at);
	} while (depth > 0);
	return at;
}

// Returns the value of an object's member. NULL: `object` is not an object, or has no member of
// that name.
static const char *find(const char *object, const char *name)
{
	size_t bytes = strlen(name);
	if (!object || *object != '{')
		return NULL;
	for (const char *at = skip_space(object + 1); *at == '"';) {
		bool found = strncmp(at + 1, name, bytes) == 0 && at[1 + bytes] == '"';
		at = skip_space(skip_space(skip_text(at)) + 1); // behind the colon
		if (found)
			return at;
		at = skip_space(skip_value(at));
		at = *at == ',' ? skip_space(at + 1) : at;
	}
	return NULL;
}

static const char *first_element(const char *array)
{
	if (!array || *array != '[')
		return NULL;
	array = skip_space(array + 1);
	return *array == ']' ? NULL : array;
}

static const char *next_element(const char *element)
{
	element = skip_space(skip_value(element));
	return *element == ',' ? skip_space(element + 1) : NULL;
}

// ---- values
// Reads an integer that is written as text, as the gateway writes 64 bits. Returns false if there
// is none.
static bool read_number(const char *at, int64_t *number)
{
	char digits[24];
	if (!at || *at != '"')
		return false;
	size_t bytes = strspn(at + 1, "-0123456789");
	if (bytes == 0 || bytes >= 20 ||
	    at[1 + bytes] != '"') // at most 19 characters, with a sign if there is one
		return false;
	memcpy(digits, at + 1, bytes);
	digits[bytes] = 0;
	char *end;
	*number = strtoll(digits, &end, 10);
	return *end == 0;
}

// Reads a number; an absent one is 0, because the gateway omits zeros.
static bool read_count(const char *at, int64_t *number)
{
	*number = 0;
	return !at || read_number(at, number);
}

static bool read_base64(const char *at, char text[CAU_ETCD_VALUE_BYTES], size_t *bytes)
{
	static const char letters[] =
		"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	unsigned char decoded[CAU_ETCD_VALUE_BYTES + 4];
	*bytes = 0;
	// The gateway omits an empty value.
	if (!at)
		return true;
	if (*at != '"')
		return false;
	size_t plain = strspn(at + 1, letters), padding = strspn(at + 1 + plain, "=");
	size_t length = plain + padding;
	if (at[1 + length] != '"' || padding > 2 || length % 4 != 0 ||
	    length / 4 * 3 >= CAU_ETCD_VALUE_BYTES)
		return false;
	int got = length ? EVP_DecodeBlock(decoded, (const unsigned char *)at + 1, (int)length) : 0;
	if (got < (int)padding)
		return false;
	*bytes = (size_t)got - padding;
	memcpy(text, decoded, *bytes);
	return true;
}

// ---- answers
static cau_status open_answer(const char *text, size_t bytes, const char **object, cau_error *error)
{
	CAU_ASSERT(text[bytes] == 0, "an answer of %zu bytes without an end", bytes);
	cau_error scanned = {0};
	if (cau_json_scan(text, bytes, CAU_ETCD_ANSWER_BYTES, &scanned))
		return cau_fail(error, CAU_CORRUPT, "etcd", "etcd's answer: %.200s", scanned.reason);
	*object = skip_space(text);
	return **object == '{' ? CAU_OK : refuse(error, "not a JSON object");
}

cau_status cau_etcd_read_lease(const char *text, size_t bytes, cau_etcd_lease *lease,
                               cau_error *error)
{
	const char *object = NULL;
	int64_t ttl = 0;
	*lease = (cau_etcd_lease){0};
	cau_status status = open_answer(text, bytes, &object, error);
	if (status)
		return status;
	const char *result = find(object, "result");
	object = result ? result : object;
	if (!read_number(find(object, "ID"), &lease->id) || lease->id <= 0)
		return refuse(error, "the lease is missing");
	if (!read_count(find(object, "TTL"), &ttl))
		return refuse(error, "the time to live is missing");
	lease->ttl_s = ttl > 0 ? (double)ttl : 0;
	return CAU_OK;
}

static cau_status read_value(const char *pair, cau_etcd_value *value, cau_error *error)
{
	if (value->is_there)
		return refuse(error, "a key comes twice");
	if (!read_number(find(pair, "mod_revision"), &value->revision) || value->revision <= 0)
		return refuse(error, "the revision of a key is missing");
	if (!read_count(find(pair, "lease"), &value->lease))
		return refuse(error, "the lease of a key is missing");
	if (!read_base64(find(pair, "value"), value->text, &value->bytes))
		return refuse(error, "the value of a key is missing");
	value->is_there = true;
	return CAU_OK;
}

cau_status cau_etcd_read_values(const char *text, size_t bytes, const char *const *keys,
                                cau_etcd_value *values, size_t count, cau_error *error)
{
	const char *object = NULL;
	cau_status status = open_answer(text, bytes, &object, error);
	memset(values, 0, count * sizeof *values);
	if (status)
		return status;
	const char *pairs = find(object, "kvs");
	if (pairs && *pairs != '[')
		return refuse(error, "the list of keys is missing");
	if (!find(object, "header"))
		return refuse(error, "the header is missing");
	for (const char *pair = first_element(pairs); pair && !status; pair = next_element(pair)) {
		char key[CAU_ETCD_VALUE_BYTES];
		size_t key_bytes;
		if (!read_base64(find(pair, "key"), key, &key_bytes) || key_bytes == 0)
			return refuse(error, "the key is missing");
		for (size_t i = 0; i < count && !status; i++)
			if (strlen(keys[i]) == key_bytes && memcmp(keys[i], key, key_bytes) == 0)
				status = read_value(pair, &values[i], error);
	}
	return status;
}

cau_status cau_etcd_read_success(const char *text, size_t bytes, bool *success, cau_error *error)
{
	const char *object = NULL;
	*success = false;
	cau_status status = open_answer(text, bytes, &object, error);
	if (status)
		return status;
	const char *succeeded = find(object, "succeeded");
	if (!find(object, "header"))
		return refuse(error, "the header is missing");
	if (succeeded && strncmp(succeeded, "true", 4) != 0 && strncmp(succeeded, "false", 5) != 0)
		return refuse(error, "the outcome is missing");
	*success = succeeded && *succeeded == 't';
	return CAU_OK;
}
