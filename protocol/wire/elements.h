// SPDX-License-Identifier: Apache-2.0
// The element sections of frames. A section has some elements of an array, which a run list
// chooses. They are numbers of 1, 2 or 4 bytes, plain or in meshoptimizer's vertex codec. See
// protocol/README.md, "Elements".
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

enum {
	ELEMENTS_HEAD_BYTES = 12,
	ELEMENTS_PLAIN = 0,
	ELEMENTS_MESHOPT = 1,
};

// Differences are stored in balanced digits: byte k is signed and has the weight 256^k. Small
// numbers of either sign then have high bytes of 0, which the codec compresses well. With b = 0x80
// repeated over the width: digits = (number + b) ^ b, number = (digits ^ b) - b.
#define ELEMENTS_BALANCE UINT32_C(0x80808080)

typedef enum elements_reference {
	ELEMENTS_NONE = 0,     // numbers are values
	ELEMENTS_PREVIOUS = 1, // signed differences to the previous element
	ELEMENTS_HELD = 2,     // signed differences to the decoder's present value
} elements_reference;

// What to encode: the elements of `now` that differ from `held` (from zero if NULL), or all
// elements.
typedef struct elements_source {
	const uint32_t *now;  // (count x components)
	const uint32_t *held; // (count x components) or NULL
	size_t count;
	uint32_t components; // 1, 3 or 6
	elements_reference reference;
	bool all;
	bool plain; // never use meshoptimizer's codec
} elements_source;

// Upper bounds for an array of `count` elements.
size_t cau_elements_bytes_max(size_t count, uint32_t components);
size_t cau_elements_scratch_bytes(size_t count, uint32_t components);

// Writes the payload, a multiple of 4 bytes, to `out`, which must have cau_elements_bytes_max.
// Returns the length. *written (may be NULL) is the number of elements in the payload.
size_t cau_elements_encode(const elements_source *source, uint8_t *scratch, uint8_t *out,
                           size_t *written);

// Where to store decoded elements.
typedef struct elements_target {
	uint32_t *values; // (count x components)
	size_t count;
	uint32_t components;
	uint32_t bias, most; // most: upper limit of value + bias, modulo 2^32
	bool may_refer_to_held;
	bool all; // every element must be in the payload
} elements_target;

// Decodes a payload into `target`. Returns NULL, or the error in words; some values may then have
// changed.
const char *cau_elements_decode(const uint8_t *payload, size_t bytes, const elements_target *target,
                                uint8_t *scratch, size_t *read);
