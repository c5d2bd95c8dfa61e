// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/snapshot_bytes.h"

#include <endian.h>
#include <string.h>

#include "cautery/assert.h"

void cau_snapshot_refuse(snapshot_archive *archive, const char *what)
{
	if (!archive->wrong)
		archive->wrong = what;
}

// Returns the position of the next `count` numbers of `size` bytes. NULL if there is nothing to
// write, or nothing left to read.
static unsigned char *take(snapshot_archive *archive, const char *what, size_t count, size_t size)
{
	if (archive->wrong)
		return NULL;
	if (archive->mode != SNAPSHOT_COUNT && count > (archive->capacity - archive->at) / size) {
		CAU_ASSERT(archive->mode == SNAPSHOT_READ, "no room to write %zu numbers of %s", count,
		           what);
		cau_snapshot_refuse(archive, what);
		return NULL;
	}
	size_t at = archive->at;
	archive->at += count * size;
	return archive->mode == SNAPSHOT_COUNT ? NULL : archive->bytes + at;
}

// For each width: functions that write a number to bytes and read it from bytes.
#define PASS_WORD(bits)                                                                            \
	static void put##bits(unsigned char *to, uint##bits##_t word)                                  \
	{                                                                                              \
		word = htole##bits(word);                                                                  \
		memcpy(to, &word, sizeof word);                                                            \
	}                                                                                              \
	static uint##bits##_t get##bits(const unsigned char *from)                                     \
	{                                                                                              \
		uint##bits##_t word;                                                                       \
		memcpy(&word, from, sizeof word);                                                          \
		return le##bits##toh(word);                                                                \
	}
PASS_WORD(64)
PASS_WORD(32)
PASS_WORD(16)

static void put_double(unsigned char *to, double value)
{
	uint64_t word;
	memcpy(&word, &value, sizeof word);
	put64(to, word);
}

static double get_double(const unsigned char *from)
{
	uint64_t word = get64(from);
	double value;
	memcpy(&value, &word, sizeof value);
	return value;
}

static void put_float(unsigned char *to, float value)
{
	uint32_t word;
	memcpy(&word, &value, sizeof word);
	put32(to, word);
}

static float get_float(const unsigned char *from)
{
	uint32_t word = get32(from);
	float value;
	memcpy(&value, &word, sizeof value);
	return value;
}

static void put_octet(unsigned char *to, uint8_t value)
{
	*to = value;
}

static uint8_t get_octet(const unsigned char *from)
{
	return *from;
}

static void put_int(unsigned char *to, int32_t value)
{
	put32(to, (uint32_t)value);
}

static int32_t get_int(const unsigned char *from)
{
	return (int32_t)get32(from);
}

static void put_long(unsigned char *to, int64_t value)
{
	put64(to, (uint64_t)value);
}

static int64_t get_long(const unsigned char *from)
{
	return (int64_t)get64(from);
}

// Passes the numbers i = 0 to count - 1, each at `place`. When reading, a number for which
// `allowed` is false is refused.
#define PASS_NUMBERS(type, put, get, place, allowed)                                               \
	unsigned char *bytes = take(archive, what, count, sizeof(type));                               \
	if (!bytes)                                                                                    \
		return;                                                                                    \
	for (size_t i = 0; i < count; i++) {                                                           \
		if (archive->mode == SNAPSHOT_WRITE) {                                                     \
			put(bytes + i * sizeof(type), place);                                                  \
			continue;                                                                              \
		}                                                                                          \
		type number = get(bytes + i * sizeof(type));                                               \
		if (!(allowed)) {                                                                          \
			cau_snapshot_refuse(archive, what);                                                    \
			return;                                                                                \
		}                                                                                          \
		place = number;                                                                            \
	}

void cau_snapshot_doubles(snapshot_archive *archive, const char *what, double *value, size_t count,
                          double least, double most)
{
	PASS_NUMBERS(double, put_double, get_double, value[i], number >= least && number <= most)
}

void cau_snapshot_floats(snapshot_archive *archive, const char *what, float *value, size_t count,
                         double least, double most)
{
	PASS_NUMBERS(float, put_float, get_float, value[i],
	             (double)number >= least && (double)number <= most)
}

void cau_snapshot_ints(snapshot_archive *archive, const char *what, int32_t *value, size_t count,
                       int64_t least, int64_t most)
{
	PASS_NUMBERS(int32_t, put_int, get_int, value[i], number >= least && number <= most)
}

void cau_snapshot_longs(snapshot_archive *archive, const char *what, int64_t *value, size_t count,
                        int64_t least, int64_t most)
{
	PASS_NUMBERS(int64_t, put_long, get_long, value[i], number >= least && number <= most)
}

void cau_snapshot_words(snapshot_archive *archive, const char *what, uint64_t *value, size_t count,
                        uint64_t most)
{
	PASS_NUMBERS(uint64_t, put64, get64, value[i], number <= most)
}

void cau_snapshot_shorts(snapshot_archive *archive, const char *what, uint16_t *value, size_t count,
                         uint16_t most)
{
	PASS_NUMBERS(uint16_t, put16, get16, value[i], number <= most)
}

void cau_snapshot_octets(snapshot_archive *archive, const char *what, uint8_t *value, size_t count,
                         uint8_t most)
{
	PASS_NUMBERS(uint8_t, put_octet, get_octet, value[i], number <= most)
}

void cau_snapshot_bool(snapshot_archive *archive, const char *what, bool *value)
{
	uint8_t octet = archive->mode == SNAPSHOT_WRITE && *value;
	cau_snapshot_octets(archive, what, &octet, 1, 1);
	if (archive->mode == SNAPSHOT_READ && !archive->wrong)
		*value = octet;
}

static void pass_float_slots(snapshot_archive *archive, const char *what, float *array,
                             const int32_t *slot_of, size_t count, double least, double most)
{
	PASS_NUMBERS(float, put_float, get_float, array[slot_of[i]],
	             (double)number >= least && (double)number <= most)
}

static void pass_double_slots(snapshot_archive *archive, const char *what, double *array,
                              const int32_t *slot_of, size_t count, double least, double most)
{
	PASS_NUMBERS(double, put_double, get_double, array[slot_of[i]],
	             number >= least && number <= most)
}

void cau_snapshot_slots(snapshot_archive *archive, const char *what, void *array, bool single,
                        const int32_t *slot_of, size_t count, double least, double most)
{
	if (single)
		pass_float_slots(archive, what, array, slot_of, count, least, most);
	else
		pass_double_slots(archive, what, array, slot_of, count, least, most);
}

void cau_snapshot_reals(snapshot_archive *archive, const char *what, void *array, bool single,
                        size_t count)
{
	if (single)
		cau_snapshot_floats(archive, what, array, count, -SNAPSHOT_ANY, SNAPSHOT_ANY);
	else
		cau_snapshot_doubles(archive, what, array, count, -SNAPSHOT_ANY, SNAPSHOT_ANY);
}

void cau_snapshot_text(snapshot_archive *archive, const char *what, char *text, size_t size)
{
	unsigned char *bytes = take(archive, what, size, 1);
	if (!bytes)
		return;
	if (archive->mode == SNAPSHOT_WRITE) {
		size_t length = strnlen(text, size);
		CAU_ASSERT(length < size, "a text of %zu bytes without an end", size);
		memcpy(bytes, text, length);
		memset(bytes + length, 0, size - length);
		return;
	}
	if (!memchr(bytes, 0, size))
		cau_snapshot_refuse(archive, what);
	else
		memcpy(text, bytes, size);
}
