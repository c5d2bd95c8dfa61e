// SPDX-License-Identifier: Apache-2.0
#include "json/value.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/json_text.h"
#include "cautery/name.h"
#include "cautery/nearest.h"

cau_status cau_value_parse(const char *text, size_t bytes, size_t bytes_max, cJSON **value,
                           cau_error *error)
{
	*value = NULL;
	cau_status status = cau_json_scan(text, bytes, bytes_max, error);
	if (status)
		return status;
	const char *end = NULL;
	*value = cJSON_ParseWithLengthOpts(text, bytes, &end, 0);
	if (!*value)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to parse %zu bytes", bytes);
	return CAU_OK;
}

// ---- the reader's path --------------------------------------------------------------------------

void cau_reader_begin(cau_reader *reader, const char *path, cau_error *error)
{
	reader->status = CAU_OK;
	reader->error = error;
	snprintf(reader->path, sizeof reader->path, "%s", path ? path : "");
}

size_t cau_reader_enter(cau_reader *reader, const char *key, int32_t index)
{
	CAU_ASSERT(key || index >= 0, "element %d", index);
	size_t mark = strlen(reader->path);
	size_t room = sizeof reader->path - mark;
	CAU_ASSERT(mark < sizeof reader->path, "a path of %zu bytes", mark);
	if (key)
		snprintf(reader->path + mark, room, "%s%s", mark ? "." : "", key);
	else
		snprintf(reader->path + mark, room, "[%d]", index);
	return mark;
}

void cau_reader_leave(cau_reader *reader, size_t mark)
{
	CAU_ASSERT(mark <= strlen(reader->path), "left at byte %zu of \"%s\"", mark, reader->path);
	reader->path[mark] = 0;
}

cau_status cau_reader_fail(cau_reader *reader, cau_status status, const char *key,
                           const char *format, ...)
{
	CAU_ASSERT(status != CAU_OK, "a failure that is none at \"%s\"", reader->path);
	if (reader->status)
		return reader->status;
	reader->status = status;
	char reason[sizeof reader->error->reason];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(reason, sizeof reason, format, arguments);
	va_end(arguments);
	size_t mark = strlen(reader->path);
	if (key)
		mark = cau_reader_enter(reader, key, 0);
	cau_fail(reader->error, status, reader->path, "%s", reason);
	cau_reader_leave(reader, mark);
	return status;
}

const cJSON *cau_value_member(const cJSON *object, const char *key)
{
	return cJSON_GetObjectItemCaseSensitive(object, key);
}

const char *cau_value_describe(const cJSON *value, char *buffer, size_t bytes)
{
	CAU_ASSERT(bytes >= 16, "a value described in %zu bytes", bytes);
	if (!value)
		return "nothing";
	if (cJSON_IsNull(value))
		return "null";
	if (cJSON_IsBool(value))
		return cJSON_IsTrue(value) ? "true" : "false";
	if (cJSON_IsArray(value))
		snprintf(buffer, bytes, "an array of %d", cJSON_GetArraySize(value));
	else if (cJSON_IsObject(value))
		return "an object";
	else if (cJSON_IsNumber(value))
		snprintf(buffer, bytes, "%.9g", value->valuedouble);
	else
		snprintf(buffer, bytes, "\"%.40s\"", value->valuestring);
	return buffer;
}

static void fail_type(cau_reader *reader, const cJSON *value, const char *wanted)
{
	char found[64];
	if (!value)
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "missing: %s is needed", wanted);
	else
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "%s is needed, not %s", wanted,
		                cau_value_describe(value, found, sizeof found));
}

// ---- values -------------------------------------------------------------------------------------

bool cau_read_object(cau_reader *reader, const cJSON *value)
{
	if (cJSON_IsObject(value))
		return true;
	fail_type(reader, value, "an object");
	return false;
}

bool cau_read_array(cau_reader *reader, const cJSON *value, int32_t least, int32_t most)
{
	CAU_ASSERT(least >= 0 && least <= most, "an array of %d to %d", least, most);
	char wanted[48];
	int32_t count = cJSON_IsArray(value) ? (int32_t)cJSON_GetArraySize(value) : -1;
	if (count >= least && count <= most)
		return true;
	if (least == most)
		snprintf(wanted, sizeof wanted, "an array of %d", most);
	else
		snprintf(wanted, sizeof wanted, "an array of %d to %d", least, most);
	fail_type(reader, value, wanted);
	return false;
}

double cau_read_number(cau_reader *reader, const cJSON *value, double least, double most,
                       const char *unit)
{
	CAU_ASSERT(least <= most && unit, "a number from %g to %g", least, most);
	if (!cJSON_IsNumber(value)) {
		fail_type(reader, value, "a number");
		return least;
	}
	double number = value->valuedouble;
	if (!(number >= least && number <= most)) {
		bool bare = !*unit || strcmp(unit, "1") == 0;
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "%.9g is outside %.9g to %.9g%s%s", number,
		                least, most, bare ? "" : " ", bare ? "" : unit);
		return least;
	}
	return number;
}

int64_t cau_read_integer(cau_reader *reader, const cJSON *value, int64_t least, int64_t most)
{
	CAU_ASSERT(least <= most, "an integer from %lld to %lld", (long long)least, (long long)most);
	if (!cJSON_IsNumber(value) || value->valuedouble != trunc(value->valuedouble)) {
		fail_type(reader, value, "an integer");
		return least;
	}
	double number = value->valuedouble;
	if (!(number >= (double)least && number <= (double)most)) {
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "%.0f is outside %lld to %lld", number,
		                (long long)least, (long long)most);
		return least;
	}
	return (int64_t)number;
}

bool cau_read_bool(cau_reader *reader, const cJSON *value)
{
	if (!cJSON_IsBool(value))
		fail_type(reader, value, "true or false");
	return cJSON_IsTrue(value);
}

void cau_read_text(cau_reader *reader, const cJSON *value, char *text, size_t bytes)
{
	CAU_ASSERT(bytes > 0, "text in %zu bytes", bytes);
	text[0] = 0;
	if (!cJSON_IsString(value)) {
		fail_type(reader, value, "a string");
		return;
	}
	size_t length = strlen(value->valuestring);
	if (length >= bytes) {
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "%zu bytes of text, at most %zu are allowed",
		                length, bytes - 1);
		return;
	}
	memset(text, 0, bytes);
	memcpy(text, value->valuestring, length);
}

void cau_read_name(cau_reader *reader, const cJSON *value, char *text)
{
	cau_read_text(reader, value, text, CAU_NAME_BYTES);
	if (!reader->status && !cau_name_is_valid(text))
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "\"%s\" is not a name: %s", text,
		                CAU_NAME_RULE);
}

int cau_read_choice(cau_reader *reader, const cJSON *value, const char *const *names, int count)
{
	CAU_ASSERT(count > 0, "one of %d words", count);
	if (!cJSON_IsString(value)) {
		fail_type(reader, value, "a string");
		return -1;
	}
	for (int i = 0; i < count; i++)
		if (strcmp(names[i], value->valuestring) == 0)
			return i;
	char list[256];
	size_t used = 0;
	list[0] = 0;
	for (int i = 0; i < count && used < sizeof list; i++)
		used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", names[i]);
	const char *nearest = cau_nearest(value->valuestring, names, (size_t)count);
	cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "\"%.40s\" is none of %s%s%s%s",
	                value->valuestring, list, nearest ? "; did you mean \"" : "",
	                nearest ? nearest : "", nearest ? "\"?" : "");
	return -1;
}

void cau_read_rotation(cau_reader *reader, const cJSON *value, double rotation[4])
{
	double read[4], square = 0.0;
	if (!cau_read_array(reader, value, 4, 4))
		return;
	for (int i = 0; i < 4; i++) {
		size_t mark = cau_reader_enter(reader, NULL, i);
		read[i] = cau_read_number(reader, cJSON_GetArrayItem(value, i), -1 - CAU_UNIT_TOLERANCE,
		                          1 + CAU_UNIT_TOLERANCE, "");
		square += read[i] * read[i];
		cau_reader_leave(reader, mark);
	}
	if (reader->status)
		return;
	double length = sqrt(square);
	if (fabs(length - 1.0) > CAU_UNIT_TOLERANCE) {
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL,
		                "a quaternion of length %.6g, not within %g of 1", length,
		                CAU_UNIT_TOLERANCE);
		return;
	}
	// A rotation within rounding of unit length is not changed, so that writing and reading keep
	// all bits.
	bool unit = fabs(square - 1.0) < 1e-15;
	for (int i = 0; i < 4; i++)
		rotation[i] = unit ? read[i] : read[i] / length;
}

void cau_read_no_others(cau_reader *reader, const cJSON *object, const char *const *names,
                        int count)
{
	CAU_ASSERT(count >= 0 && (names || !count), "%d names", count);
	for (const cJSON *member = object ? object->child : NULL; member; member = member->next) {
		bool known = false;
		for (int i = 0; i < count && !known; i++)
			known = strcmp(member->string, names[i]) == 0;
		if (known)
			continue;
		const char *nearest = cau_nearest(member->string, names, (size_t)count);
		cau_reader_fail(reader, CAU_BAD_VALUE, member->string, "unknown%s%s%s",
		                nearest ? ": did you mean \"" : "", nearest ? nearest : "",
		                nearest ? "\"?" : "");
		return;
	}
}
