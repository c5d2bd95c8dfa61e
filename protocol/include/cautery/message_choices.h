// SPDX-License-Identifier: Apache-2.0
// Words that messages choose from. Each table is X(code, wire name). The words of scenes, channels
// and reasons for energy off are defined with their types.
//
//     #include "cautery/message_choices.h"
//
//     static const char *role_word(cau_role role)
//     {
//     #define X(code, word) word,
//         static const char *const words[] = {CAU_ROLE_TABLE(X)};
//     #undef X
//         return words[role];
//     }
//
//     // Each role includes the roles before it.
//     static bool may_operate(cau_role role)
//     {
//         return role >= CAU_ROLE_OPERATE;
//     }
#pragma once

#include "cautery/energy_off.h"
#include "cautery/scene.h"
#include "cautery/status.h"
#include "cautery/stream.h"

#define CAU_ROLE_TABLE(X) /* each role includes the roles before it */                             \
	X(VIEW, "view")                                                                                \
	X(OPERATE, "operate")                                                                          \
	X(ADMIN, "admin")

#define CAU_SESSION_STATE_TABLE(X)                                                                 \
	X(STARTING, "starting")                                                                        \
	X(RUNNING, "running")                                                                          \
	X(PAUSED, "paused")                                                                            \
	X(FAULTED, "faulted")

#define CAU_CHANGE_TABLE(X) /* the reason for session.changed */                                   \
	X(CREATED, "created")                                                                          \
	X(DESTROYED, "destroyed")                                                                      \
	X(PAUSED, "paused")                                                                            \
	X(RESUMED, "resumed")                                                                          \
	X(STEPPED, "stepped")                                                                          \
	X(SPEED, "speed")                                                                              \
	X(RESET, "reset")                                                                              \
	X(REWOUND, "rewound")                                                                          \
	X(RESTORED, "restored")                                                                        \
	X(RESTARTED, "restarted")                                                                      \
	X(MOVED, "moved")                                                                              \
	X(TOOLS, "tools")                                                                              \
	X(TISSUE, "tissue")

#define CAU_EVENT_TABLE(X)                                                                         \
	X(CREATED, "created")                                                                          \
	X(CUT, "cut")                                                                                  \
	X(TEAR, "tear")                                                                                \
	X(INVERTED, "inverted")       /* tetrahedra of a layer stay inverted */                        \
	X(ENERGY_GAIN, "energy_gain") /* steps added energy without a source */                        \
	X(BLEEDING, "bleeding")       /* blood begins to leave a vessel */                             \
	X(BLEEDING_STOPPED, "bleeding_stopped")                                                        \
	X(SEALED, "sealed") /* a seal withstands the vessel's pressure */                              \
	X(ENERGY_ON, "energy_on")                                                                      \
	X(ENERGY_OFF, "energy_off")                                                                    \
	X(WATCHDOG, "watchdog")                                                                        \
	X(DRIVER, "driver")                                                                            \
	X(TOOL_ADDED, "tool_added")                                                                    \
	X(TOOL_REMOVED, "tool_removed")                                                                \
	X(REFUSED, "refused")                                                                          \
	X(FAULT, "fault")                                                                              \
	X(REWIND, "rewind")                                                                            \
	X(RESET, "reset")                                                                              \
	X(SNAPSHOT, "snapshot")                                                                        \
	X(RESTORE, "restore")

#define CAU_EXPORT_TABLE(X)                                                                        \
	X(VTU, "vtu") /* remaining tetrahedra and triangles with fields, for ParaView */               \
	X(OBJ, "obj") /* drawn faces */

#define CAU_LOOK_STAGE_TABLE(X)                                                                    \
	X(BUILDING, "building") /* the view's own core is made */                                      \
	X(READING, "reading")                                                                          \
	X(RESTORING, "restoring")                                                                      \
	X(REPLAYING, "replaying")

// Commands that session.advance may contain: the commands of a tool's driver.
#define CAU_ADVANCE_METHOD_TABLE(X)                                                                \
	X(TOOL_MOVE, "tool.move")                                                                      \
	X(TOOL_ENERGIZE, "tool.energize")                                                              \
	X(TOOL_GRASP, "tool.grasp")                                                                    \
	X(TOOL_RELEASE, "tool.release")                                                                \
	X(TOOL_HOLD, "tool.hold")

#define CAU_CAPABILITY_TABLE(X)                                                                    \
	X(UPLOAD, "upload")                                                                            \
	X(EXPORT, "export")                                                                            \
	X(DDS, "dds")                                                                                  \
	X(STORE, "store")

#define CAU_CHANNEL_WORD(X, code, name, ...) X(code, #name)
#define CAU_CHANNEL_TABLE(X) CAU_CHANNEL_ROWS(CAU_CHANNEL_WORD, CAU_CHANNEL_WORD, X)

// All choices that a message can have. CHOICE_TABLE(id, table)
#define CAU_CHOICE_LIST(CHOICE_TABLE)                                                              \
	CHOICE_TABLE(role, CAU_ROLE_TABLE)                                                             \
	CHOICE_TABLE(session_state, CAU_SESSION_STATE_TABLE)                                           \
	CHOICE_TABLE(change, CAU_CHANGE_TABLE)                                                         \
	CHOICE_TABLE(event_kind, CAU_EVENT_TABLE)                                                      \
	CHOICE_TABLE(export_format, CAU_EXPORT_TABLE)                                                  \
	CHOICE_TABLE(look_stage, CAU_LOOK_STAGE_TABLE)                                                 \
	CHOICE_TABLE(advance_method, CAU_ADVANCE_METHOD_TABLE)                                         \
	CHOICE_TABLE(capability, CAU_CAPABILITY_TABLE)                                                 \
	CHOICE_TABLE(channel, CAU_CHANNEL_TABLE)                                                       \
	CHOICE_TABLE(energy_off, CAU_ENERGY_OFF_TABLE)                                                 \
	CHOICE_TABLE(layer_kind, CAU_LAYER_TABLE)

#define X(code, name) CAU_ROLE_##code,
// The rights of a client. Each role includes the roles before it.
typedef enum cau_role { CAU_ROLE_TABLE(X) CAU_ROLE_COUNT } cau_role;
#undef X
#define X(code, name) CAU_SESSION_##code,
// The state of a session.
typedef enum cau_session_state {
	CAU_SESSION_STATE_TABLE(X) CAU_SESSION_STATE_COUNT
} cau_session_state;
#undef X
#define X(code, name) CAU_CHANGE_##code,
// The reason for session.changed.
typedef enum cau_change { CAU_CHANGE_TABLE(X) CAU_CHANGE_COUNT } cau_change;
#undef X
#define X(code, name) CAU_EVENT_##code,
// The kind of an event in the timeline.
typedef enum cau_event_kind { CAU_EVENT_TABLE(X) CAU_EVENT_COUNT } cau_event_kind;
#undef X
#define X(code, name) CAU_EXPORT_##code,
// The format of an exported file.
typedef enum cau_export_format { CAU_EXPORT_TABLE(X) CAU_EXPORT_COUNT } cau_export_format;
#undef X
#define X(code, name) CAU_LOOK_##code,
// The progress of a past view.
typedef enum cau_look_stage { CAU_LOOK_STAGE_TABLE(X) CAU_LOOK_STAGE_COUNT } cau_look_stage;
#undef X
#define X(code, name) CAU_ADVANCE_##code,
// The method that a command of session.advance calls.
typedef enum cau_advance_method {
	CAU_ADVANCE_METHOD_TABLE(X) CAU_ADVANCE_METHOD_COUNT
} cau_advance_method;
#undef X
#define X(code, name) CAU_CAPABILITY_##code,
// A feature of the server. The value is a bit number in hello_result.capabilities.
typedef enum cau_capability { CAU_CAPABILITY_TABLE(X) CAU_CAPABILITY_COUNT } cau_capability;
#undef X
