// SPDX-License-Identifier: Apache-2.0
// The channels of a stream, one table entry each. All code about channels is made from these
// entries: the words and bits by which a subscriber chooses, the sections of frames, encoder,
// thinner and decoder, the members of cau_frame, and the files that `ninja messages` prints
// (TypeScript, IDL, JSON, pages). protocol/README.md, "Adding a channel", lists what else a new
// entry needs.
//
//     OWN(X, CODE, name, section, when, meaning)
//     SCALAR(X, CODE, name, section, when, least, step, most, unit, meaning)
//
// OWN is a channel with a layout of its own. A SCALAR is one number for each vertex. In the core it
// is a float. On the wire it is the nearest whole number n of steps above `least`, saturated at 0
// and `most`.
//     X        passed on to every entry by the user of the table; may be empty
//     CODE     CAU_CHANNEL_<CODE>, its bit; the order of the entries gives the bits, so a new entry
//              is the last
//     name     the word on the wire; for a scalar also the name of its member, as in cau_frame
//     section  number of its section in frames; ascends from entry to entry. CAU_SECTION_* has the
//              numbers of other sections
//     when     BY_DEFAULT: in a stream whose subscriber names no channels. ON_REQUEST: only if the
//              subscriber names it. A new entry is ON_REQUEST: clients that do not know it must not
//              receive it
//     least    the value of n = 0, in `unit`
//     step     the value of one step, in `unit`; 0: the stream states it, as stress_step_pa
//     most     the largest n: 255 or 65535
//
// In use:
//
//     #include "cautery/channels.h"
//
//     // The word of a channel's bit on the wire, or NULL.
//     static const char *word_of(uint32_t bit)
//     {
//     #define ROW(X, CODE, name, ...) if (bit == CAU_CHANNEL_##CODE) return #name;
//         CAU_CHANNEL_ROWS(ROW, ROW, )
//     #undef ROW
//         return (const char *)0;
//     }
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/scene.h"

// clang-format off: rows of a table
#define CAU_CHANNEL_ROWS(OWN, SCALAR, X)                                                           \
	OWN(X, POSITIONS, positions, 1, BY_DEFAULT, "vertex positions")                                \
	OWN(X, MASK, mask, 2, BY_DEFAULT, "faces that are not drawn")                                  \
	SCALAR(X, EXPOSURE, exposure, 3, BY_DEFAULT, 0.0, 1.0 / 255.0, 255, "1",                       \
	       "largest heat exposure of the vertex's edges, over the exposure that parts the edge, "  \
	       "0 to 1")                                                                               \
	SCALAR(X, CHARRING, charring, 4, BY_DEFAULT, 0.0, 1.0 / 255.0, 255, "1",                       \
	       "share of the vertex's edges that have parted, 0 to 1")                                 \
	SCALAR(X, STRESS, stress, 5, ON_REQUEST, 0.0, 0.0, 65535, "Pa",                                \
	       "von Mises stress of fat, volume weighted")                                             \
	OWN(X, TOOLS, tools, 7, BY_DEFAULT, "pose, driver, force, temperature, energy of every tool")  \
	OWN(X, STATISTICS, statistics, 8, ON_REQUEST, "times, counts and errors of the last step")     \
	SCALAR(X, TEMPERATURE, temperature, 9, ON_REQUEST, -20.0, 0.25, 65535, "degC",                 \
	       "temperature of the tools' heat grids at the vertex; outside of the grids ambient_c "   \
	       "of the scene")                                                                         \
	OWN(X, VESSELS, vessels, 10, ON_REQUEST, "flags, bleeding, seal and line of every vessel")     \
	SCALAR(X, BLOOD, blood, 11, ON_REQUEST, 0.0, 2e-5, 255, "m", "depth of blood on the surface")  \
	OWN(X, TOOL_CONTACT, tool_contact, 12, ON_REQUEST,                                             \
	    "linear model of the contact of every tool, for haptic rendering")                         \
	/* a new row goes above this line */
// clang-format on

enum { CAU_ON_REQUEST, CAU_BY_DEFAULT }; // `when` of the table

// Expands to nothing. A user of the table passes it to skip the OWN or the SCALAR entries.
#define CAU_NO_ROW(...)

// ---- bits ---------------------------------------------------------------------------------------
#define ROW(X, code, ...) CAU_CHANNEL_INDEX_##code,
// The index of each channel, which is also the index of its bit.
typedef enum cau_channel_index { CAU_CHANNEL_ROWS(ROW, ROW, ) CAU_CHANNEL_COUNT } cau_channel_index;
#undef ROW
#define ROW(X, code, ...) CAU_CHANNEL_##code = 1 << CAU_CHANNEL_INDEX_##code,
// The bit of each channel, and the mask of all bits.
typedef enum cau_channel {
	CAU_CHANNEL_ROWS(ROW, ROW, ) CAU_CHANNEL_ALL = (1 << CAU_CHANNEL_COUNT) - 1 // every bit
} cau_channel;
#undef ROW
#define ROW(X, code, name, section, when, ...) | CAU_##when << CAU_CHANNEL_INDEX_##code
enum {
	// The bits of a stream that names no channels.
	CAU_CHANNELS_BY_DEFAULT = 0 CAU_CHANNEL_ROWS(ROW, ROW, )
};
#undef ROW

// ---- scalars ------------------------------------------------------------------------------------
#define ROW(X, code, ...) CAU_SCALAR_##code,
// The index of each scalar channel, counted among the scalar channels only.
typedef enum cau_scalar { CAU_CHANNEL_ROWS(CAU_NO_ROW, ROW, ) CAU_SCALAR_COUNT } cau_scalar;
#undef ROW

// Members of a struct with one array (vertex_count) of every scalar. x.stress is the same as
// x.scalar[CAU_SCALAR_STRESS].
#define CAU_SCALAR_MEMBER(type, code, name, ...) type *name;
#define CAU_SCALAR_MEMBERS(type)                                                                   \
	union {                                                                                        \
		struct {                                                                                   \
			CAU_CHANNEL_ROWS(CAU_NO_ROW, CAU_SCALAR_MEMBER, type)                                  \
		};                                                                                         \
		type *scalar[CAU_SCALAR_COUNT];                                                            \
	}

// Returns the CAU_CHANNEL_* bit of a scalar.
static inline uint32_t cau_scalar_channel(cau_scalar scalar)
{
#define ROW(X, code, ...) CAU_CHANNEL_##code,
	static const uint32_t channels[] = {CAU_CHANNEL_ROWS(CAU_NO_ROW, ROW, )};
#undef ROW
	return channels[scalar];
}

// ---- vessels ------------------------------------------------------------------------------------
// The data of each vessel in the channel `vessels`. core/vessel/README.md describes the model.
enum { CAU_VESSEL_SHOWN_POINTS = 64 }; // most points of one vessel

// Flags of a vessel.
enum {
	CAU_VESSEL_CUT = 1 << 0,         // the vessel is parted somewhere: nothing flows across
	CAU_VESSEL_PIERCED = 1 << 1,     // the vessel's wall has a hole somewhere
	CAU_VESSEL_SHUT = 1 << 2,        // the tissue around it is pressed so flat that nothing flows
	CAU_VESSEL_SEALED = 1 << 3,      // a seal withstands the pressure of the blood
	CAU_VESSEL_BLEEDS = 1 << 4,      // blood leaves the vessel
	CAU_VESSEL_FLAGS = (1 << 5) - 1, // mask of all flags
};

// One point of a vessel's middle line, in the order of the line.
typedef struct cau_vessel_point {
	float position_m[3]; // position in the world
	// open share of the lumen's area; 0: a seal holds here; negative: the vessel is parted here
	float open;
} cau_vessel_point;

// A vessel after a step.
typedef struct cau_vessel_state {
	char name[CAU_NAME_BYTES]; // name of the vessel
	uint32_t flags;            // CAU_VESSEL_*
	double radius_m;           // outer radius of the undeformed tube
	double bleeding_m3_s; // blood that left the vessel in the last step, divided by the step's time
	double shed_m3;       // blood that has left the vessel since creation
	double burst_pa;      // predicted pressure at which its best seal opens; 0: no seal
	int32_t point_count;  // at most CAU_VESSEL_SHOWN_POINTS
	cau_vessel_point point[CAU_VESSEL_SHOWN_POINTS]; // (point_count)
} cau_vessel_state;

// ---- contact of a tool --------------------------------------------------------------------------
// The data of each tool in the channel `tool_contact`: its contact, linearised at a tick. A program
// that renders force more often than once a tick computes the force from this data
// (cautery/haptics.h).
//
// Let p be the commanded position of the tool. At the tick, p is the position of asked_pose. C is
// the compliance; n_i and o_i are the normal and the offset of plane i. The force f_i >= 0 is not 0
// only if plane i touches. The tissue pushes the tool with f = sum n_i f_i, where
//
//     n_i . p - o_i + n_i . C f >= 0, complementary to f_i
//
// At the tick's p, f is the contact force without friction. Friction and the spring of a grasp are
// added to f.
enum { CAU_CONTACT_PLANES = 8 }; // most planes of one tool

// A plane in which tissue touches a tool, or is near it.
typedef struct cau_contact_plane {
	double normal[3]; // unit vector in the world: the direction in which the tissue pushes the tool
	// the plane touches if normal . p is less than this, with no other force on the tool
	double offset_m;
	double velocity_m_s; // velocity of the tissue at the plane, along the normal
} cau_contact_plane;

// The contact of a tool after a step.
typedef struct cau_tool_contact {
	char name[CAU_NAME_BYTES]; // name of the tool
	bool valid;                // false: the tick has no contact data, for example after a restore
	double time_s;             // simulated time of the tick
	cau_pose asked_pose;       // commanded pose of the tick
	cau_pose pose;             // actual pose of the tick
	double force_n[3];         // force of the tissue on the tool, without filter and limit
	int32_t plane_count;       // at most CAU_CONTACT_PLANES
	cau_contact_plane plane[CAU_CONTACT_PLANES]; // (plane_count)
	// How far the tool's commanded position moves for 1 N more force, m/N. It is the sum of the
	// compliance of the tissue, as in the contact's solve, and of the virtual coupling. The matrix
	// is symmetric: xx, yy, zz, xy, xz, yz.
	double compliance_m_n[6];
	double friction;     // Coulomb coefficient of the tool
	double damping_ns_m; // damping of the tissue that moves with the tool
	double grasp_n_m; // stiffness of the grasped tissue, as seen by the tool; 0: nothing is grasped
	double grasp_anchor_m[3]; // commanded position at which the grasped tissue pulls with 0 N
} cau_tool_contact;
