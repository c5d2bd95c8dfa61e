// SPDX-License-Identifier: GPL-3.0-or-later
// CRTK's operating states of a tool: operating_state and state_command. They apply to every DDS
// client that drives the tool.
#include <math.h>
#include <string.h>

#include "ros2.h"
#include "transport_dds/internal.h"

static const char *const state_names[] = {
	[OPERATING_DISABLED] = "DISABLED",
	[OPERATING_ENABLED] = "ENABLED",
	[OPERATING_PAUSED] = "PAUSED",
	[OPERATING_FAULT] = "FAULT",
};

cau_status cau_dds_check_ready(const cau_dds_session *session, const char *name, cau_error *error)
{
	const cau_dds_tool *tool = cau_dds_find_tool(session, name);
	if (!tool)
		return CAU_OK; // no operating state was ever published for the tool
	if (tool->operating.state != OPERATING_ENABLED)
		return cau_fail(error, CAU_BAD_STATE, "tool",
		                "the operating state of the tool is %s, not ENABLED",
		                state_names[tool->operating.state]);
	if (tool->operating.unhomed)
		return cau_fail(error, CAU_BAD_STATE, "tool", "the tool is not homed");
	return CAU_OK;
}

// ---- publishing the state
static void tell(cau_dds_tool *tool, cau_dds_operating_state seen)
{
	int64_t now_us = cau_wall_us();
	char frame[] = "", state[16];
	cau_dds_operating *told = &tool->operating_told;
	const cau_dds_operating now = {seen, tool->operating.unhomed};
	if (tool->operating_writer <= 0 || (told->state == now.state && told->unhomed == now.unhomed))
		return;
	snprintf(state, sizeof state, "%s", state_names[seen]);
	crtk_msgs_msg_dds__OperatingState_ sample = {
		.header_ = {{(int32_t)(now_us / 1000000), (uint32_t)(now_us % 1000000) * 1000}, frame},
		.state_ = state,
		.is_homed_ = !now.unhomed,
	};
	if (dds_write(tool->operating_writer, &sample) == DDS_RETCODE_OK)
		*told = now;
}

void cau_dds_publish_operating(cau_dds_session *session)
{
	cau_wire_session_summary summary;
	cau_hosted_summary(session->hosted, &summary);
	bool faulted = summary.state == CAU_SESSION_FAULTED;
	bool stands = summary.state == CAU_SESSION_PAUSED;
	for (int i = 0; i < CAU_MAX_TOOLS; i++) {
		cau_dds_tool *tool = &session->tools[i];
		if (!tool->used)
			continue;
		cau_dds_operating_state *state = &tool->operating.state;
		if (faulted)
			*state = OPERATING_FAULT;
		else if (*state == OPERATING_FAULT)
			// The session's fault is cleared. The client must enable the tool again.
			*state = OPERATING_DISABLED;
		tell(tool, *state == OPERATING_ENABLED && stands ? OPERATING_PAUSED : *state);
	}
}

// ---- taking commands
typedef enum word { ENABLE, DISABLE, PAUSE, RESUME, HOME, UNHOME, WORD_COUNT } word;

static bool read_word(const char *text, word *read)
{
	static const char *const words[WORD_COUNT] = {
		[ENABLE] = "enable", [DISABLE] = "disable", [PAUSE] = "pause",
		[RESUME] = "resume", [HOME] = "home",       [UNHOME] = "unhome",
	};
	for (int i = 0; i < WORD_COUNT; i++)
		if (text && strcmp(text, words[i]) == 0) {
			*read = (word)i;
			return true;
		}
	return false;
}

// Returns the state after a command. If CRTK has no transition for the command in this state, the
// state stays.
static cau_dds_operating after(cau_dds_operating now, word command)
{
	switch (command) {
	case ENABLE:
		if (now.state == OPERATING_DISABLED)
			now.state = OPERATING_ENABLED;
		break;
	case DISABLE:
		if (now.state != OPERATING_FAULT)
			now.state = OPERATING_DISABLED;
		break;
	case PAUSE:
		if (now.state == OPERATING_ENABLED)
			now.state = OPERATING_PAUSED;
		break;
	case RESUME:
		if (now.state == OPERATING_PAUSED)
			now.state = OPERATING_ENABLED;
		break;
	default:
		now.unhomed = command == UNHOME;
		break;
	}
	return now;
}

static bool is_ready(const cau_dds_operating *now)
{
	return now->state == OPERATING_ENABLED && !now->unhomed;
}

// Checks the sender of a command. Any operator may stop a tool. To start the tool again, the sender
// must be the tool's driver, or the tool must have no driver.
static cau_status check_asker(const cau_door *door, const cau_dds_writer *writer, word command,
                              cau_error *error)
{
	cau_hosted_tool tool;
	cau_status status = cau_dds_check_role(writer, error);
	if (status)
		return status;
	bool stops = command == DISABLE || command == PAUSE || command == UNHOME;
	if (stops || !cau_hosted_find_tool(door->session->hosted, door->tool, &tool) ||
	    !tool.driver.client || tool.driver.client == cau_dds_asker_of(writer)->client)
		return CAU_OK;
	return cau_fail(error, CAU_BAD_STATE, "tool", "%s drives it", tool.driver.name);
}

void cau_dds_take_state_command(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                                const void *taken)
{
	(void)dds;
	const crtk_msgs_msg_dds__StringStamped_ *sample = taken;
	cau_dds_tool *tool = cau_dds_find_tool(door->session, door->tool);
	cau_error error = {0};
	word command = DISABLE;
	cau_status status = CAU_OK;
	if (!tool)
		return;
	if (!read_word(sample->string_, &command))
		status = cau_fail(&error, CAU_BAD_VALUE, "string", "CRTK has no command `%.32s`",
		                  sample->string_ ? sample->string_ : "");
	else
		status = check_asker(door, writer, command, &error);
	if (status) {
		cau_dds_refuse(door->session, door->tool, writer, 0, &error);
		return;
	}
	bool was_ready = is_ready(&tool->operating);
	tool->operating = after(tool->operating, command);
	cau_log(CAU_LOG_INFO, cau_hosted_id(door->session->hosted), "dds_operating",
	        "tool=%s command=%s state=%s homed=%d client=\"%s\"", door->tool, sample->string_,
	        state_names[tool->operating.state], !tool->operating.unhomed, writer->asker.name);
	if (was_ready && !is_ready(&tool->operating))
		cau_dds_stop_tool(door->session, tool, cau_dds_asker_of(writer));
	else if (!was_ready && is_ready(&tool->operating))
		cau_dds_restart_tool(tool);
	cau_dds_publish_operating(door->session);
}
