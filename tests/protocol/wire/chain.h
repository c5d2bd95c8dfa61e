// SPDX-License-Identifier: GPL-3.0-or-later
// An encoder and a decoder over a make-believe tissue. Every step asserts that it goes well.
#pragma once

#include "cautery/frame_codec.h"
#include "protocol/wire/tissue.h"

enum { CHAIN_EPOCH = 0x5eed };

typedef struct chain {
	tissue tissue;
	cau_stream_def def;
	cau_frame_encoder *encoder;
	cau_frame_decoder *decoder;
	uint8_t *bytes;
	size_t capacity;
	size_t byte_count;
} chain;

// Buffers have exactly the sizes asked for, so that sanitizers see one byte too many.
void chain_init(chain *made, int32_t columns, int32_t rows);
void chain_finish(chain *made);
cau_frame_decoder *chain_new_decoder(const cau_stream_def *def); // free() it

// Encodes the tissue's present state into `bytes`; chain_pass decodes it too.
void chain_encode(chain *of);
void chain_pass(chain *of);

// What the decoder holds is the sample, to half a step; hidden vertices are not looked at.
void chain_assert_holds(const cau_frame_decoder *decoder, const tissue *shown);
void chain_assert_same(const cau_frame_decoder *a, const cau_frame_decoder *b);
