// SPDX-License-Identifier: Apache-2.0
// Binary frames with the positions, face mask, scalars and tools of one session. A key frame has
// the whole state. A delta has the difference to a state that the decoder holds. The functions use
// only the caller's buffers and allocate nothing.
//
//     #include "cautery/frame_codec.h"
//
//     // Encodes a tick: a delta for all clients, and a key frame if a client has just joined.
//     static cau_status publish(cau_frame_encoder *encoder, const cau_stream_sample *sample,
//                               bool came, void *frame, void *key, size_t capacity,
//                               size_t bytes[2], cau_error *error)
//     {
//         cau_status status = cau_frame_encode(encoder, sample, frame, capacity, &bytes[0], error);
//         if (!status && came)
//             status = cau_frame_encode_key(encoder, key, capacity, &bytes[1], error);
//         return status;
//     }
//
//     // Decodes a frame. Returns false if the client must request a key frame.
//     static bool follow(cau_frame_decoder *decoder, const void *frame, size_t bytes)
//     {
//         return !cau_frame_decode(decoder, frame, bytes, NULL) &&
//                cau_frame_decoder_state(decoder)->synced;
//     }
//
// The encoder keeps the state of every decoder that has all frames, in whole steps. So rounding
// errors never add up: the key frame at n gives the same state as the chain of deltas up to n.
#pragma once

#include "cautery/status.h"
#include "cautery/stream.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
	CAU_FRAME_VERSION = 1,       // version of the layout
	CAU_FRAME_HEADER_BYTES = 72, // size of the header before the first section
	CAU_FRAME_SECTION_BYTES = 8, // size of the head before each section's payload
};

// X(code, number, wire name)
#define CAU_FRAME_KIND_TABLE(X)                                                                    \
	X(KEY, 1, "key")                                                                               \
	X(DELTA, 2, "delta")                                                                           \
	X(TOPOLOGY, 3, "topology")
// The kind of a frame.
typedef enum cau_frame_kind {
#define X(code, number, name) CAU_FRAME_##code = (number),
	CAU_FRAME_KIND_TABLE(X)
#undef X
} cau_frame_kind;

// The sections that do not have the name of a channel. Each channel also has a section with the
// channel's own name and number (cautery/channels.h). X(code, number, wire name)
#define CAU_OTHER_SECTION_TABLE(X)                                                                 \
	X(TOOL_NAMES, 6, "tool_names") /* part of the channel `tools` */                               \
	X(FACES, 16, "faces")          /* from here to REST: in topology frames */                     \
	X(FACE_LAYERS, 17, "face_layers")                                                              \
	X(TEXTURE, 18, "texture")                                                                      \
	X(REST, 19, "rest")                                                                            \
	X(TOOLS_ASKED, 32, "tools_asked") /* part of the channel `tools` */                            \
	X(TOOL_JAWS, 33, "tool_jaws")     /* part of the channel `tools` */                            \
	X(TOOL_POWER, 34, "tool_power")   /* part of the channel `tools` */                            \
	X(TOOL_FORCE, 35, "tool_force")   /* part of the channel `tools` */
#define ROW(X, code, name, section, ...) CAU_SECTION_##code = (section),
#define X(code, number, name) CAU_SECTION_##code = (number),
// The number of a section.
typedef enum cau_section { CAU_CHANNEL_ROWS(ROW, ROW, ) CAU_OTHER_SECTION_TABLE(X) } cau_section;
#undef ROW
#undef X

// The header at the start of every frame.
typedef struct cau_frame_header {
	uint8_t version;     // CAU_FRAME_VERSION
	uint8_t kind;        // CAU_FRAME_*
	uint16_t flags;      // CAU_FRAME_PAUSED, CAU_FRAME_FAULTED
	uint32_t byte_count; // size of the whole frame
	uint32_t session;    // the session's number on its daemon
	uint64_t epoch;      // a new number after rewind, reset, restore and restart
	uint64_t sequence;   // number of the frame in its epoch, from 1
	// sequence of the state that the frame builds on; in a key frame its own sequence
	uint64_t base_sequence;
	uint64_t tick;          // tick of the state
	double time_s;          // simulated time of the state
	uint64_t published_us;  // time on the server's monotonic clock
	uint16_t profile;       // profile number in the session
	uint16_t section_count; // number of sections that follow
} cau_frame_header;

// Reads and checks only the header, for routing. Errors: CAU_CORRUPT (too short, not a Cautery
// frame, wrong length), CAU_UNSUPPORTED (another version).
cau_status cau_frame_header_read(const void *bytes, size_t byte_count, cau_frame_header *header,
                                 cau_error *error);

// Returns a capacity that holds any key or delta frame of such a stream.
size_t cau_frame_bytes_max(const cau_stream_def *def);

// ---- encoder ------------------------------------------------------------------------------------
typedef struct cau_frame_encoder cau_frame_encoder;

// Returns the storage size for an encoder of such a stream. The storage needs malloc's alignment.
size_t cau_frame_encoder_bytes(const cau_stream_def *def);

// Makes an encoder in `storage`, which must stay valid. `epoch` is random and not 0. Errors:
// CAU_BAD_VALUE (the definition), CAU_LIMIT (storage too small).
cau_status cau_frame_encoder_init(void *storage, size_t storage_bytes, const cau_stream_def *def,
                                  uint64_t epoch, cau_frame_encoder **encoder, cau_error *error);

// Discards the state and starts `epoch`. Call it after rewind, reset, restore and restart. The next
// frame is a key frame with sequence 1.
void cau_frame_encoder_restart(cau_frame_encoder *encoder, uint64_t epoch);

// Advances the chain to `sample` and writes the frame for this step: a key frame if it is the
// epoch's first, else a delta. An error leaves the chain unchanged. Errors: CAU_LIMIT (capacity
// below cau_frame_bytes_max), CAU_NUMERICAL (a position that is not finite or more than 2^30 steps
// from the origin), CAU_BAD_VALUE (an array of a wanted channel is NULL, too many tools).
cau_status cau_frame_encode(cau_frame_encoder *encoder, const cau_stream_sample *sample,
                            void *bytes, size_t capacity, size_t *byte_count, cau_error *error);

// Writes a key frame of the present state, with the sequence of the last cau_frame_encode. Errors:
// CAU_BAD_STATE before the first cau_frame_encode, CAU_LIMIT.
cau_status cau_frame_encode_key(const cau_frame_encoder *encoder, void *bytes, size_t capacity,
                                size_t *byte_count, cau_error *error);

// Returns the present epoch.
uint64_t cau_frame_encoder_epoch(const cau_frame_encoder *encoder);
// Returns the sequence of the last frame, or 0 before the first frame.
uint64_t cau_frame_encoder_sequence(const cau_frame_encoder *encoder);

// ---- half rate ----------------------------------------------------------------------------------
// A thinner halves the frame rate of an encoder: it makes deltas that span two of the encoder's
// frames. Both kinds of delta belong to the same chain. At any frame of even sequence a decoder may
// change from one kind to the other and holds the same state.
typedef struct cau_frame_thinner cau_frame_thinner;
enum { CAU_FRAME_THINNING = 2 }; // number of the encoder's frames for each frame of the thinner

// Returns the storage size for a thinner of such a stream. The storage needs malloc's alignment.
size_t cau_frame_thinner_bytes(const cau_stream_def *def);
// Makes a thinner in `storage`. The storage and the encoder must stay valid. Errors: CAU_LIMIT
// (storage too small).
cau_status cau_frame_thinner_init(void *storage, size_t storage_bytes,
                                  const cau_frame_encoder *encoder, cau_frame_thinner **thinner,
                                  cau_error *error);

// Writes the delta from the state two sequences earlier to the present state. Call it after each
// cau_frame_encode. *byte_count is 0 if there is no delta: at an odd sequence, and at the first
// even sequence of an epoch or after skipped calls. At such an even sequence the thinner only keeps
// the state for the next delta. Errors: CAU_LIMIT (capacity below cau_frame_bytes_max).
cau_status cau_frame_thin(cau_frame_thinner *thinner, void *bytes, size_t capacity,
                          size_t *byte_count, cau_error *error);

// ---- decoder ------------------------------------------------------------------------------------
typedef struct cau_frame_decoder cau_frame_decoder;

// Returns the storage size for a decoder of such a stream. The storage needs malloc's alignment.
size_t cau_frame_decoder_bytes(const cau_stream_def *def);
// Makes a decoder in `storage`, which must stay valid. Errors: CAU_BAD_VALUE (the definition),
// CAU_LIMIT (storage too small).
cau_status cau_frame_decoder_init(void *storage, size_t storage_bytes, const cau_stream_def *def,
                                  cau_frame_decoder **decoder, cau_error *error);

// Takes one key or delta frame. Errors:
//   CAU_BAD_STATE    another session, profile or epoch, another base than the present state, or an
//                    older frame (path names the field). The state is unchanged.
//   CAU_UNSUPPORTED  another version. The state is unchanged.
//   CAU_CORRUPT      truncated, indices out of range, damaged sections. If the header was valid,
//                    the state is lost (synced is false) until the next key frame.
cau_status cau_frame_decode(cau_frame_decoder *decoder, const void *bytes, size_t byte_count,
                            cau_error *error);

// Returns the decoder's state; borrowed, valid until the next decode.
const cau_stream_state *cau_frame_decoder_state(const cau_frame_decoder *decoder);
// Returns the definition that the decoder was made with; borrowed.
const cau_stream_def *cau_frame_decoder_def(const cau_frame_decoder *decoder);

// Writes the positions in metres, (vertex_count x 3), into the caller's array.
void cau_frame_decoder_position(const cau_frame_decoder *decoder, double *position);

#ifdef __cplusplus
}
#endif
