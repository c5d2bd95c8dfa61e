// SPDX-License-Identifier: Apache-2.0
// A stream: its description, the sample that the server encodes at a tick, and the state that a
// client holds after decoding. protocol/README.md has the byte layouts. SI units, degrees Celsius.
//
//     #include "cautery/stream.h"
//
//     // Defines a stream with only positions, to a hundredth of a millimetre.
//     static cau_status define(int32_t vertices, int32_t faces, cau_stream_def *def,
//                              cau_error *error)
//     {
//         *def = cau_default_stream_def();
//         def->session = 1;
//         def->vertex_count = vertices;
//         def->face_count = faces;
//         def->channels = CAU_CHANNEL_POSITIONS;
//         def->step_m = 1e-5;
//         return cau_stream_def_check(def, error);
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/channels.h"
#include "cautery/energy_off.h"
#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
	CAU_STREAM_PROFILES_MAX = 4,       // largest number of profiles of a session
	CAU_STREAM_ELEMENTS_MAX = 1 << 24, // largest number of vertices or faces
	CAU_STREAM_STAGES = 8, // number of stages of a step, see CAU_STAGE_TABLE in the README
};

// Flags in a frame's header.
enum {
	CAU_FRAME_PAUSED = 1 << 0,  // the session is paused
	CAU_FRAME_FAULTED = 1 << 1, // the session is faulted
};

// The parameters that encoder and decoder must share. session.join sends them as
// stream_description.
typedef struct cau_stream_def {
	uint32_t session;      // the session's number on its daemon
	uint16_t profile;      // profile number in the session, 0 to CAU_STREAM_PROFILES_MAX - 1
	uint32_t channels;     // CAU_CHANNEL_* bits
	int32_t vertex_count;  // 1 to CAU_STREAM_ELEMENTS_MAX
	int32_t face_count;    // 0 to CAU_STREAM_ELEMENTS_MAX
	double origin_m[3];    // position = origin_m + step_m * quantised
	double step_m;         // 1e-7 to 1e-2
	double stress_step_pa; // 1e-3 to 1e9; stress saturates at 65535 steps
	// the encoder never uses meshoptimizer's codec; decoders ignore this member
	bool plain;
} cau_stream_def;

// Returns a definition with CAU_CHANNELS_BY_DEFAULT, steps of 0.05 mm and 10 Pa, and origin 0.
// Counts and numbers are zero.
cau_stream_def cau_default_stream_def(void);
// Checks every range. Errors: CAU_BAD_VALUE with the path of the member.
cau_status cau_stream_def_check(const cau_stream_def *def, cau_error *error);

// The description of a channel in cautery/channels.h.
typedef struct cau_channel_info {
	const char *name; // name in messages
	int section;      // section number in frames
	bool by_default;  // included if a client names no channels
	// CAU_SCALAR_*, or -1 for a channel with its own layout, which does not use the members below
	int scalar;
	// a transmitted number n means the value least + step * n, in `unit`; if `step` is 0, the
	// stream definition has the step
	double least, step;
	uint32_t most;              // the largest n
	const char *unit, *meaning; // unit and description for people
} cau_channel_info;

// Returns the description of a channel; it is static.
const cau_channel_info *cau_channel_describe(cau_channel_index channel);
// Returns the step of a scalar channel in a stream of this definition, in the channel's unit.
double cau_channel_step(const cau_stream_def *def, cau_channel_index channel);

// One tool as a frame shows it.
typedef struct cau_stream_tool {
	char name[CAU_NAME_BYTES]; // name of the tool
	int32_t shape;             // CAU_TOOL_*
	cau_pose pose;             // single precision in frames, as are all numbers below
	bool behind;               // tissue keeps the tool from its commanded pose
	cau_pose asked_pose;       // commanded pose; a decoder also sets it if `behind` is false
	double jaw;                // actual opening, 0 closed to 1 open
	double asked_jaw;          // commanded opening
	double jaw_force_n;        // pressing force at the tips of the jaws
	double force_n[3];         // force of the tissue on the tool, filtered, force_max_n at most
	double torque_nm[3];       // about the tip, filtered, force_max_n * tip_length_m at most
	// false if the sender does not send the next three members, which are 0 then
	bool has_raw_force;
	double raw_force_n[3];    // force of the frame's tick, without filter and bound
	double raw_torque_nm[3];  // torque of the frame's tick, without filter and bound
	double force_filter_s;    // time constant of the filter, or 0 without a filter
	double tip_temperature_c; // temperature of the hot part
	double energy_j;          // estimate of the heat that tissue took up
	// power delivered to tissue in the last step, for a tool with energy `tissue`
	double delivered_w;
	double load_ohm;           // load of the tool's generator, or 0 without current
	uint64_t sequence;         // sequence of the last applied command
	uint32_t driver;           // the driving client's number, or 0 without a driver
	bool energized;            // energy is on
	bool grasping;             // jaws commanded closed on tissue
	bool slipping;             // some of the grasped tissue slid in the last step
	bool frozen;               // the watchdog fired: the tool stays at its pose until a new command
	uint8_t energy_off;        // CAU_ENERGY_OFF_*; meaningless while energized
	uint16_t grasped_vertices; // number of grasped vertices, 65535 at most
	uint16_t contact_vertices; // number of vertices in contact, 65535 at most
	uint16_t touched_layers;   // one bit per layer
} cau_stream_tool;

// Scalars about the last step. cau_statistics of the core explains them.
typedef struct cau_stream_statistics {
	float realtime_factor;            // simulated time over wall time in the last second
	float step_cost_s;                // wall time of the last step
	float stage_s[CAU_STREAM_STAGES]; // wall time of each stage of the last step
	float residual;                   // relative residual
	float deferred_max_s;             // longest wait for a downdate, in simulated time
	uint32_t iterations;              // iterations of the last step
	uint32_t backtracks;              // refused increments
	uint32_t inverted;                // tetrahedra with negative volume
	uint32_t edges_parted;            // total since creation
	uint32_t elements_removed;        // total since creation
	uint32_t pending_downdates;       // removed elements that are still in the factor
	uint32_t refactorisations;        // total since creation
	uint32_t contacts;                // contact constraints of the last step
	uint32_t frozen_vertices;         // vertices that do not move any more
	uint32_t refused_commands;        // total since creation
	float energy_gain_j;              // 0 if the sender does not send it
	uint32_t resting; // 1 if the tissue is at rest; 0 if the sender does not send it
	// estimated error of the last step; 0 if the sender does not send it
	float error;
	uint32_t contacts_left_out;  // 0 if the sender does not send it
	uint32_t elements_torn;      // 0 if the sender does not send it
	uint32_t touching_cut_short; // 0 if the sender does not send it
} cau_stream_statistics;

// The server's state at a tick. All pointers are borrowed for the call. The array of a channel that
// the stream does not have may be NULL.
typedef struct cau_stream_sample {
	uint64_t tick;          // tick of the state
	double time_s;          // simulated time
	uint64_t published_us;  // time on the server's monotonic clock
	uint16_t flags;         // CAU_FRAME_*
	const double *position; // m, (vertex_count x 3)
	// (vertex_count), 1 for a vertex of a drawn face, else 0; NULL if all vertices are of drawn
	// faces
	const uint8_t *vertex_visible;
	const uint32_t *face_mask;               // ((face_count + 31) / 32), a set bit means not drawn
	CAU_SCALAR_MEMBERS(const float);         // (vertex_count) each, in the channel's unit
	int32_t tool_count;                      // number of tools, at most CAU_MAX_TOOLS
	const cau_stream_tool *tools;            // (tool_count)
	const cau_stream_statistics *statistics; // statistics of the last step
	int32_t vessel_count;                    // number of vessels, at most CAU_MAX_VESSELS
	const cau_vessel_state *const *vessels;  // (vessel_count)
	int32_t contact_count;                   // number of contacts, at most CAU_MAX_TOOLS
	const cau_tool_contact *contacts;        // (contact_count)
} cau_stream_sample;

// The state of a decoder; borrowed, valid until the next decode. A face is drawn if its bit in
// face_mask is clear. At the vertices of drawn faces, positions and scalars are of `tick`. At other
// vertices they are of the last frame in which a drawn face used the vertex, or of the epoch's
// first frame. In a stream without the mask they are of `tick` at every vertex.
typedef struct cau_stream_state {
	bool synced;               // if false, there is no valid state, and a key frame is needed
	uint64_t epoch;            // epoch of the last frame
	uint64_t sequence;         // sequence of the last frame
	uint64_t tick;             // tick of the last frame
	double time_s;             // simulated time
	uint64_t published_us;     // time on the server's monotonic clock
	uint16_t flags;            // CAU_FRAME_*
	const int32_t *quantised;  // steps from the origin, (vertex_count x 3)
	const uint32_t *face_mask; // ((face_count + 31) / 32)
	// (vertex_count) each, in steps from the channel's least value
	CAU_SCALAR_MEMBERS(const uint32_t);
	int32_t moved_count;              // number of vertices in the last frame
	int32_t mask_changed_count;       // number of mask words in the last frame
	int32_t tool_count;               // number of tools, at most CAU_MAX_TOOLS
	const cau_stream_tool *tools;     // (tool_count)
	cau_stream_statistics statistics; // statistics from the last frame that has them
	int32_t vessel_count;             // number of vessels, at most CAU_MAX_VESSELS
	const cau_vessel_state *vessels;  // (vessel_count), from the last frame that has vessels
	int32_t contact_count;            // number of contacts, at most CAU_MAX_TOOLS
	const cau_tool_contact *contacts; // (contact_count), from the last frame that has contacts
} cau_stream_state;

#ifdef __cplusplus
}
#endif
