// SPDX-License-Identifier: Apache-2.0
#include "wire/elements.h"

#include <meshoptimizer.h>

#include "cautery/assert.h"
#include "wire/bytes.h"

enum {
	// Largest number of unchanged elements between two changed elements that are written within one
	// run. A new run costs two bytes or more, an unchanged element about half a byte.
	MERGED_GAP = 3,
	RUN_BYTES_MAX = 10, // largest size of a run's head: two LEB128 numbers of 32 bits
	LENGTH_BYTES = 4,   // size of the length field before meshoptimizer's output
};

static size_t stride_bytes(uint32_t components, uint32_t width)
{
	return components == 1 ? width : round_up_4((size_t)components * width);
}

size_t cau_elements_bytes_max(size_t count, uint32_t components)
{
	size_t runs = count / (MERGED_GAP + 2) + 1;
	return ELEMENTS_HEAD_BYTES + round_up_4(runs * RUN_BYTES_MAX) + LENGTH_BYTES +
	       round_up_4(count * components * 4);
}

size_t cau_elements_scratch_bytes(size_t count, uint32_t components)
{
	return round_up_4(count * components * 4);
}

static uint8_t *store_leb128(uint8_t *at, size_t value)
{
	for (; value >= 0x80; value >>= 7)
		*at++ = (uint8_t)(value | 0x80);
	*at++ = (uint8_t)value;
	return at;
}

static bool differs(const elements_source *source, size_t element)
{
	uint32_t difference = 0;
	size_t first = element * source->components;
	for (size_t i = first; i < first + source->components; i++)
		difference |= source->now[i] ^ (source->held ? source->held[i] : 0);
	return difference != 0;
}

static size_t next_changed(const elements_source *source, size_t element)
{
	while (element < source->count && !source->all && !differs(source, element))
		element++;
	return element;
}

// Returns the index after the last element of the run that starts at `element`.
static size_t run_end(const elements_source *source, size_t element)
{
	CAU_RULE(element < source->count, "a run from %zu of %zu", element, source->count);
	if (source->all)
		return source->count;
	size_t end = element + 1;
	for (size_t i = end; i < source->count && i - end <= MERGED_GAP; i++) {
		if (differs(source, i))
			end = i + 1;
	}
	return end;
}

// Returns the encoded number of component `i` of the array. `previous` is the index of the same
// component in the section's previous element, or SIZE_MAX.
static uint32_t number_of(const elements_source *source, size_t i, size_t previous)
{
	CAU_RULE(previous == SIZE_MAX || previous < i, "element %zu is told from %zu", i, previous);
	switch (source->reference) {
	case ELEMENTS_HELD:
		return source->now[i] - (source->held ? source->held[i] : 0);
	case ELEMENTS_PREVIOUS:
		return source->now[i] - (previous == SIZE_MAX ? 0 : source->now[previous]);
	default:
		return source->now[i];
	}
}

// Returns the bytes that a number needs. Differences are stored in balanced digits.
static uint32_t width_of(uint32_t number, bool is_difference)
{
	if (number + (is_difference ? ELEMENTS_BALANCE & UINT8_MAX : 0) <= UINT8_MAX)
		return 1;
	return number + (is_difference ? ELEMENTS_BALANCE & UINT16_MAX : 0) <= UINT16_MAX ? 2 : 4;
}

// Writes the numbers of elements [begin, end) into `numbers`, 4 bytes each without gaps. Returns
// the width of the widest number.
static uint32_t gather(const elements_source *source, size_t begin, size_t end, size_t *last,
                       uint32_t *numbers)
{
	CAU_RULE(begin < end && end <= source->count, "elements %zu to %zu of %zu", begin, end,
	         source->count);
	uint32_t widest = 1;
	for (size_t element = begin; element < end; element++) {
		for (uint32_t c = 0; c < source->components; c++) {
			size_t i = element * source->components + c;
			size_t previous = *last == SIZE_MAX ? SIZE_MAX : *last * source->components + c;
			uint32_t number = number_of(source, i, previous);
			*numbers++ = number;
			uint32_t width = width_of(number, source->reference != ELEMENTS_NONE);
			widest = width > widest ? width : widest;
		}
		*last = element;
	}
	return widest;
}

static void store_number(uint8_t *at, uint32_t number, uint32_t width, bool is_difference)
{
	CAU_RULE(width == 1 || width == 2 || width == 4, "a number of %u bytes", width);
	uint32_t balance = is_difference ? ELEMENTS_BALANCE >> (32 - 8 * width) : 0;
	uint32_t digits = (number + balance) ^ balance;
	if (width == 1)
		*at = (uint8_t)digits;
	else if (width == 2)
		store_u16(at, (uint16_t)digits);
	else
		store_u32(at, digits);
}

// Narrows numbers in place, from the first to the last. A stride of width x components leaves no
// gaps.
static void narrow(uint8_t *scratch, size_t count, size_t components, uint32_t width, size_t stride,
                   bool is_difference)
{
	size_t element_bytes = components * width;
	CAU_RULE(element_bytes <= stride && stride <= 4 * components,
	         "elements of %zu bytes, %zu apart", element_bytes, stride);
	for (size_t element = 0; element < count; element++) {
		uint8_t *to = scratch + element * stride;
		for (size_t c = 0; c < components; c++) {
			uint32_t number;
			memcpy(&number, scratch + (element * components + c) * 4, sizeof number);
			store_number(to + c * width, number, width, is_difference);
		}
		memset(to + element_bytes, 0, stride - element_bytes);
	}
}

// Removes the padding between elements of `stride` bytes.
static void pack(uint8_t *out, const uint8_t *scratch, size_t count, size_t element_bytes,
                 size_t stride)
{
	CAU_RULE(element_bytes <= stride, "elements of %zu bytes, %zu apart", element_bytes, stride);
	for (size_t element = 0; element < count; element++)
		memcpy(out + element * element_bytes, scratch + element * stride, element_bytes);
	size_t bytes = count * element_bytes;
	memset(out + bytes, 0, round_up_4(bytes) - bytes);
}

static size_t try_meshopt(const uint8_t *scratch, size_t bytes, size_t stride, size_t plain_bytes,
                          uint8_t *out)
{
	if (plain_bytes <= LENGTH_BYTES)
		return 0;
	size_t length = meshopt_encodeVertexBuffer(out + LENGTH_BYTES, plain_bytes - LENGTH_BYTES,
	                                           scratch, bytes / stride, stride);
	if (length == 0 || round_up_4(length) + LENGTH_BYTES >= plain_bytes)
		return 0;
	store_u32(out, (uint32_t)length);
	memset(out + LENGTH_BYTES + length, 0, round_up_4(length) - length);
	return LENGTH_BYTES + round_up_4(length);
}

static size_t write_data(const elements_source *source, uint8_t *scratch, size_t count,
                         uint32_t width, uint8_t *out, uint8_t *coding)
{
	CAU_RULE(count <= source->count, "%zu of %zu elements", count, source->count);
	size_t element_bytes = (size_t)source->components * width;
	size_t stride = stride_bytes(source->components, width);
	narrow(scratch, count, source->components, width, stride, source->reference != ELEMENTS_NONE);
	size_t bytes = count * stride;
	memset(scratch + bytes, 0, round_up_4(bytes) - bytes);
	size_t plain_bytes = round_up_4(count * element_bytes);
	size_t length = 0;
	if (!source->plain)
		length = try_meshopt(scratch, round_up_4(bytes), source->components == 1 ? 4 : stride,
		                     plain_bytes, out);
	*coding = length ? ELEMENTS_MESHOPT : ELEMENTS_PLAIN;
	if (length)
		return length;
	pack(out, scratch, count, element_bytes, stride);
	return plain_bytes;
}

size_t cau_elements_encode(const elements_source *source, uint8_t *scratch, uint8_t *out,
                           size_t *written)
{
	CAU_RULE(source->components >= 1 && source->components <= 6, "%u components",
	         source->components);
	uint8_t *run = out + ELEMENTS_HEAD_BYTES;
	size_t count = 0;
	size_t behind = 0; // index after the last run
	size_t last = SIZE_MAX;
	uint32_t width = 1;
	for (size_t begin = next_changed(source, 0); begin < source->count;
	     begin = next_changed(source, behind)) {
		size_t end = run_end(source, begin);
		run = store_leb128(run, begin - behind);
		run = store_leb128(run, end - begin);
		uint32_t *numbers = (uint32_t *)(void *)(scratch + count * source->components * 4);
		uint32_t widest = gather(source, begin, end, &last, numbers);
		width = widest > width ? widest : width;
		count += end - begin;
		behind = end;
		CAU_RULE(count <= source->count, "%zu of %zu elements", count, source->count);
	}
	size_t run_bytes = (size_t)(run - out) - ELEMENTS_HEAD_BYTES;
	CAU_RULE(run_bytes + ELEMENTS_HEAD_BYTES <=
	             cau_elements_bytes_max(source->count, source->components),
	         "%zu bytes of runs", run_bytes);
	for (; (run - out) % 4; run++)
		*run = 0;
	out[0] = (uint8_t)width;
	out[1] = (uint8_t)source->components;
	out[3] = (uint8_t)source->reference;
	store_u32(out + 4, (uint32_t)count);
	store_u32(out + 8, (uint32_t)run_bytes);
	if (written)
		*written = count;
	return (size_t)(run - out) + write_data(source, scratch, count, width, run, &out[2]);
}
