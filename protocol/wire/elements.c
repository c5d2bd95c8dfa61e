// SPDX-License-Identifier: Apache-2.0
// Encodes and decodes the element sections of frames.
#include "wire/elements.h"

#include <meshoptimizer.h>

#include "cautery/assert.h"
#include "wire/bytes.h"

// ---- encoding
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

// ---- decoding
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
	if (head->count > target->count)
		return "a section has more elements than the topology";
	if (target->all && head->count != target->count)
		return "a section of all elements has fewer elements than the topology";
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
