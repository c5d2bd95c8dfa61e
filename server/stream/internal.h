// SPDX-License-Identifier: GPL-3.0-or-later
// Shared declarations of stream.
#pragma once

#include "clock/clock.h"
#include "log/log.h"
#include "stream/stream.h"

// ---- ring.c: the frames that were encoded last
// Copies the encoded frame from the stream's scratch memory. Returns NULL if memory ran out.
cau_buffer *cau_ring_take(const cau_stream *stream, size_t bytes);
// Put a frame into the ring. They take the buffer.
void cau_ring_put_delta(cau_streams *streams, cau_stream *stream, cau_buffer *buffer,
                        uint64_t sequence);
void cau_ring_put_key(cau_streams *streams, cau_stream *stream, cau_buffer *buffer,
                      uint64_t sequence);
void cau_ring_clear(cau_stream *stream); // hold the mutex if other threads can see the stream

// ---- ring.c: half rate
// Makes the delta over two frames if it is due. Called after each frame of the stream.
void cau_half_publish(cau_streams *streams, cau_stream *stream);
// Returns the delta that the subscriber needs next, even if it has left the ring. NULL: the
// subscriber waits for the next delta over two frames.
const cau_ring_frame *cau_half_choose(const cau_stream *stream, const cau_subscriber *sub,
                                      double now_s);
void cau_half_fallen(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub);
void cau_half_steady(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub);
void cau_half_leave(cau_stream *stream, const cau_subscriber *sub);
