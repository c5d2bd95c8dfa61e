// SPDX-License-Identifier: Apache-2.0
#include "wire/elements.h"

#include <meshoptimizer.h>

#include "cautery/assert.h"
#include "wire/bytes.h"

enum { LENGTH_BYTES = 4 };

typedef struct section {
	uint32_t width;
	uint32_t components;
	uint32_t coding;
	uint32_t reference;
	size_t count;
	const uint8_t *runs;
	size_t run_bytes;
	const uint8_t *data;
	size_t data_bytes;
} section;

static const char *read_head(const uint8_t *payload, size_t bytes, const elements_target *target,
                             section *head)
{
	if (bytes < ELEMENTS_HEAD_BYTES)
		return "an element section is shorter than its head";
	*head = (section){.width = payload[0],
	                  .components = payload[1],
	                  .coding = payload[2],
	                  .reference = payload[3],
	                  .count = load_u32(payload + 4),
	                  .run_bytes = load_u32(payload + 8)};
	if (head->width != 1 && head->width != 2 && head->width != 4)
		return "the width of a section is not 1, 2 or 4";
	if (head->components != target->components)
		return "a section has the wrong number of components";
	if (head->coding > ELEMENTS_MESHOPT)
		return "the coding of a section is unknown";
	if (head->reference > ELEMENTS_HELD ||
	    (head->reference == ELEMENTS_HELD && !target->may_refer_to_held))
		return "the reference of a section is unknown or not allowed here";
	if (head->count > target->count || (target->all && head->count != target->count))
		return "a section has too many or too few elements";
	size_t room = bytes - ELEMENTS_HEAD_BYTES;
	if (head->run_bytes > room || round_up_4(head->run_bytes) > room)
		return "a run list is longer than its section";
	head->runs = payload + ELEMENTS_HEAD_BYTES;
	head->data = head->runs + round_up_4(head->run_bytes);
	head->data_bytes = room - round_up_4(head->run_bytes);
	return NULL;
}

// Reads one LEB128 number below 2^32. Returns the byte after it, or NULL.
static const uint8_t *load_leb128(const uint8_t *at, const uint8_t *end, size_t *value)
{
	uint64_t result = 0;
	for (int shift = 0; at < end && shift < 35; shift += 7) {
		uint8_t byte = *at++;
		result |= (uint64_t)(byte & 0x7f) << shift;
		if (!(byte & 0x80)) {
			*value = (size_t)result;
			return result <= UINT32_MAX ? at : NULL;
		}
	}
	return NULL;
}

static const char *check_runs(const section *head, size_t element_count)
{
	const uint8_t *at = head->runs, *end = at + head->run_bytes;
	size_t element = 0, total = 0;
	while (at < end) {
		size_t skip, length;
		at = load_leb128(at, end, &skip);
		at = at ? load_leb128(at, end, &length) : NULL;
		if (!at)
			return "a run list is damaged";
		if (length == 0 || skip > element_count - element ||
		    length > element_count - element - skip)
			return "a run is empty or beyond the array";
		element += skip + length;
		total += length;
	}
	return total == head->count ? NULL : "the runs of a list do not add up to its count";
}

// Unpacks the section's data. *numbers points to elements that are *stride bytes apart.
static const char *unpack(const section *head, uint8_t *scratch, const uint8_t **numbers,
                          size_t *stride)
{
	CAU_ASSERT(head->width == 1 || head->width == 2 || head->width == 4, "numbers of %u bytes",
	           head->width);
	size_t element_bytes = (size_t)head->components * head->width;
	size_t bytes = head->count * element_bytes;
	if (head->coding == ELEMENTS_PLAIN) {
		*numbers = head->data;
		*stride = element_bytes;
		return head->data_bytes == round_up_4(bytes) ? NULL : "a section has the wrong length";
	}
	*numbers = scratch;
	*stride = head->components == 1 ? element_bytes : round_up_4(element_bytes);
	size_t vertex_bytes = head->components == 1 ? 4 : *stride;
	size_t vertex_count = head->components == 1 ? round_up_4(bytes) / 4 : head->count;
	if (head->data_bytes < LENGTH_BYTES)
		return "a section has the wrong length";
	size_t length = load_u32(head->data);
	if (length > head->data_bytes || LENGTH_BYTES + round_up_4(length) != head->data_bytes)
		return "a section has the wrong length";
	if (vertex_count == 0 || meshopt_decodeVertexBuffer(scratch, vertex_count, vertex_bytes,
	                                                    head->data + LENGTH_BYTES, length) != 0)
		return "a section's data cannot be decoded";
	return NULL;
}

static uint32_t load_number(const uint8_t *at, uint32_t width, bool is_difference)
{
	CAU_ASSERT(width == 1 || width == 2 || width == 4, "a number of %u bytes", width);
	uint32_t balance = is_difference ? ELEMENTS_BALANCE >> (32 - 8 * width) : 0;
	uint32_t digits = width == 1 ? *at : width == 2 ? load_u16(at) : load_u32(at);
	return (digits ^ balance) - balance;
}

// Sets elements [begin, end) of the target from consecutive numbers.
static bool set_run(const section *head, const elements_target *target, size_t begin, size_t end,
                    const uint8_t *numbers, size_t stride, uint32_t previous[6])
{
	CAU_ASSERT(begin <= end && end <= target->count, "elements %zu to %zu of %zu", begin, end,
	           target->count);
	bool in_range = true;
	for (size_t element = begin; element < end; element++, numbers += stride) {
		for (uint32_t c = 0; c < head->components; c++) {
			uint32_t *value = &target->values[element * head->components + c];
			uint32_t number = load_number(numbers + (size_t)c * head->width, head->width,
			                              head->reference != ELEMENTS_NONE);
			uint32_t base = 0;
			if (head->reference == ELEMENTS_HELD)
				base = *value;
			else if (head->reference == ELEMENTS_PREVIOUS)
				base = previous[c];
			*value = base + number;
			previous[c] = *value;
			in_range &= *value + target->bias <= target->most;
		}
	}
	return in_range;
}

const char *cau_elements_decode(const uint8_t *payload, size_t bytes, const elements_target *target,
                                uint8_t *scratch, size_t *read)
{
	CAU_ASSERT(target->components >= 1 && target->components <= 6, "%u components",
	           target->components);
	section head;
	const uint8_t *numbers;
	size_t stride;
	const char *wrong = read_head(payload, bytes, target, &head);
	if (!wrong)
		wrong = check_runs(&head, target->count);
	if (!wrong)
		wrong = unpack(&head, scratch, &numbers, &stride);
	if (wrong)
		return wrong;
	uint32_t previous[6] = {0};
	const uint8_t *at = head.runs, *end = at + head.run_bytes;
	size_t element = 0;
	while (at < end) {
		size_t skip = 0, length = 0;
		at = load_leb128(at, end, &skip);
		at = load_leb128(at, end, &length);
		element += skip;
		CAU_ASSERT(element + length <= target->count, "elements %zu + %zu of %zu", element, length,
		           target->count);
		if (!set_run(&head, target, element, element + length, numbers, stride, previous))
			return "a value is out of its range";
		numbers += length * stride;
		element += length;
	}
	if (read)
		*read = head.count;
	return NULL;
}
