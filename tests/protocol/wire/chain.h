// SPDX-License-Identifier: GPL-3.0-or-later
// An encoder and a decoder for an artificial tissue. Every call asserts its success.
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

// Creates a chain. The chain's buffers have exactly the requested sizes, so that sanitizers detect
// an access one byte beyond.
void chain_init(chain *made, int32_t columns, int32_t rows);
void chain_finish(chain *made);
cau_frame_decoder *chain_new_decoder(const cau_stream_def *def); // free it with free()

// chain_encode encodes the tissue's present state into `bytes`; chain_pass also decodes it.
void chain_encode(chain *of);
void chain_pass(chain *of);

// Asserts that the decoder's state is the tissue's, to half a step. Hidden vertices are not
// checked.
void chain_assert_holds(const cau_frame_decoder *decoder, const tissue *shown);
void chain_assert_same(const cau_frame_decoder *a, const cau_frame_decoder *b);
