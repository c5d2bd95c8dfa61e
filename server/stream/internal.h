// SPDX-License-Identifier: GPL-3.0-or-later
// Between the files of this room.
#pragma once

#include "clock/clock.h"
#include "log/log.h"
#include "stream/stream.h"

// ---- ring.c: what was encoded last is in the stream's scratch
// Copies it. NULL: memory ran out.
cau_buffer *cau_ring_take(const cau_stream *stream, size_t bytes);
// Take the buffer.
void cau_ring_put_delta(cau_streams *streams, cau_stream *stream, cau_buffer *buffer,
                        uint64_t sequence);
void cau_ring_put_key(cau_streams *streams, cau_stream *stream, cau_buffer *buffer,
                      uint64_t sequence);
void cau_ring_clear(cau_stream *stream); // under the mutex, where others see the stream

// ---- half_rate.c
void cau_half_publish(cau_streams *streams, cau_stream *stream); // after each of its frames
// The delta that the subscriber needs next, which may be gone; NULL: it waits for the one after.
const cau_ring_frame *cau_half_choose(const cau_stream *stream, const cau_subscriber *sub,
                                      double now_s);
void cau_half_fallen(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub);
void cau_half_steady(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub);
void cau_half_leave(cau_stream *stream, const cau_subscriber *sub);
