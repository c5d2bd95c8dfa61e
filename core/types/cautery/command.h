// SPDX-License-Identifier: Apache-2.0
// Typed commands to a session, from a driver or an operator. Core applies them at tick borders;
// protocol reads and writes them as JSON.
//
//     #include "cautery/command.h"
//     #include "cautery/defaults.h"
//
//     // Turns a tool's energy on at the next tick border.
//     static void ask_for_energy(cau_command *command, const char *tool, uint64_t sequence)
//     {
//         cau_default_command(command, CAU_COMMAND_TOOL_ENERGIZE);
//         strncpy(command->tool, tool, sizeof command->tool - 1);
//         command->sequence = sequence;
//         command->as.energized = 1;
//     }
#pragma once

#include "cautery/scene.h"

// The entries: code, JSON name. Stores keep the number of an entry, so new entries come last.
#define CAU_COMMAND_TABLE(X)                                                                       \
	X(TOOL_ADD, "tool.add")                                                                        \
	X(TOOL_REMOVE, "tool.remove")                                                                  \
	X(TOOL_CONFIGURE, "tool.configure")                                                            \
	X(TOOL_MOVE, "tool.move")                                                                      \
	X(TOOL_ENERGIZE, "tool.energize")                                                              \
	X(TOOL_GRASP, "tool.grasp")                                                                    \
	X(TOOL_RELEASE, "tool.release")                                                                \
	X(PIN, "pin")                                                                                  \
	X(UNPIN, "unpin")                                                                              \
	X(SET_MATERIAL, "material.set")                                                                \
	X(SET_GRAVITY, "gravity.set")                                                                  \
	X(SET_FORCE, "force.set")                                                                      \
	X(TOOL_HOLD, "tool.hold")

// The kind of a command: CAU_COMMAND_TABLE.
typedef enum cau_command_kind {
#define X(code, name) CAU_COMMAND_##code,
	CAU_COMMAND_TABLE(X)
#undef X
		CAU_COMMAND_COUNT
} cau_command_kind;

// One command. Only the members named beside a kind are read.
typedef struct cau_command {
	int kind;      // CAU_COMMAND_*
	uint64_t tick; // applied at the first tick border at or after this tick; 0: at the next border
	uint64_t sequence; // the driver's own number of the command; reported back once it is applied
	char tool[CAU_NAME_BYTES]; // name of the tool, for all TOOL_* except TOOL_ADD
	union {
		cau_tool_def definition; // TOOL_ADD, TOOL_CONFIGURE (its pose is ignored)
		struct {
			cau_pose pose; // commanded pose
			double jaw;    // 0 closed to 1 open
		} move;            // TOOL_MOVE
		struct {
			int32_t energized; // TOOL_ENERGIZE
			// for an enable: number of ticks after which energy goes off; 0: no limit
			int32_t ticks;
		};
		cau_selection selection; // PIN, UNPIN
		struct {
			char layer[CAU_NAME_BYTES]; // name of the layer
			int32_t kind; // CAU_LAYER_*: decides which of the next three members is read
			cau_sheet_material sheet; // FASCIA, MEMBRANE
			cau_fat_material fat;     // FAT
			cau_link_material link;   // LINKS
		} material;                   // SET_MATERIAL: replaces the layer's material for this region
		double gravity_m_s2[3];       // SET_GRAVITY
		struct {
			cau_selection selection;
			double force_n[3]; // force on each chosen vertex until the next SET_FORCE; zero ends it
		} force;               // SET_FORCE
	} as;                      // the member that belongs to `kind`
} cau_command;
