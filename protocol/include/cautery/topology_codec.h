// SPDX-License-Identifier: Apache-2.0
// The topology frame has the unchanging data of a session: faces, their layers, texture coordinates
// and rest positions. It is sent once after session.join, before the first key frame. Nothing is
// allocated.
//
//     #include "cautery/topology_codec.h"
//
//     // Makes the frame for a client that has joined, to be sent before the first key frame.
//     static cau_status send_topology(const cau_stream_def *def, const cau_topology *topology,
//                                     void *scratch, void *frame, size_t capacity, size_t *bytes,
//                                     cau_error *error)
//     {
//         uint64_t epoch = 1;
//         return cau_topology_encode(def, epoch, topology, scratch, frame, capacity, bytes,
//                                    error);
//     }
#pragma once

#include "cautery/frame_codec.h"

#ifdef __cplusplus
extern "C" {
#endif

// The content of a topology frame. All pointers are borrowed.
typedef struct cau_topology {
	const int32_t *face;         // vertex indices, (face_count x 3)
	const uint8_t *face_layer;   // (face_count)
	const float *texture;        // (face_count x 3 x 2), or NULL
	const double *rest_position; // m, (vertex_count x 3)
	// A topology frame of this session that this process encoded before, or NULL. Its faces, layers
	// and texture are copied, and the arrays above are not read. Encoding them takes 8 of 9 ms for
	// 40,401 vertices.
	const void *known;
	size_t known_bytes; // size of `known`
} cau_topology;

// Returns a capacity that holds any topology frame of such a stream.
size_t cau_topology_bytes_max(const cau_stream_def *def);
// Returns the size of the working memory for such a stream.
size_t cau_topology_scratch_bytes(const cau_stream_def *def);

// Encodes a topology frame. `scratch` is working memory of cau_topology_scratch_bytes. Errors:
// CAU_LIMIT, CAU_BAD_VALUE (a face with an unknown vertex), CAU_NUMERICAL (rest positions),
// CAU_BAD_STATE (`known` is of another session), CAU_CORRUPT and CAU_LIMIT (`known`).
cau_status cau_topology_encode(const cau_stream_def *def, uint64_t epoch,
                               const cau_topology *topology, void *scratch, void *bytes,
                               size_t capacity, size_t *byte_count, cau_error *error);

// The caller's arrays for a decoded topology.
typedef struct cau_topology_arrays {
	int32_t *face;       // (face_count x 3)
	uint8_t *face_layer; // (face_count)
	float *texture;      // (face_count x 3 x 2), or zero if the frame has no texture
	int32_t *rest;       // quantised, (vertex_count x 3)
	bool has_texture;    // the frame has texture
} cau_topology_arrays;

// Fills the caller's arrays. Errors: CAU_CORRUPT, CAU_UNSUPPORTED, CAU_BAD_STATE (another session).
cau_status cau_topology_decode(const cau_stream_def *def, const void *bytes, size_t byte_count,
                               void *scratch, cau_topology_arrays *arrays, cau_error *error);

#ifdef __cplusplus
}
#endif
