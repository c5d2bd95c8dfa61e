// SPDX-License-Identifier: GPL-3.0-or-later
// Follows the hub's sessions and their tools. Opens and closes the DDS readers and writers of each.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "transport_dds/internal.h"

// Longest time between checks of a session, s. Samples that readers drop do not wake the thread.
#define LOOK_EVERY_S 1
#define UNREAD_LOOK_S 0.1 // time between checks of sessions that had a slice and have no readers

static cau_dds_session *find_session(cau_dds *dds, const cau_hosted *hosted)
{
	cau_dds_session *session = dds->sessions;
	while (session && session->hosted != hosted)
		session = session->next;
	return session;
}

static void ros_name(char name[CAU_NAME_BYTES], const char *from)
{
	snprintf(name, CAU_NAME_BYTES, "%s", from);
	for (char *c = name; *c; c++)
		if (*c == '-')
			*c = '_';
}

static bool name_taken(const cau_dds *dds, const char *name)
{
	for (const cau_dds_session *s = dds->sessions; s; s = s->next)
		if (s->has_ros_name && strcmp(s->ros_name, name) == 0)
			return true;
	return false;
}

// Adds a new session of the hub to the list, without opening it yet. The hub's visitor.
static void note_session(void *user, cau_hosted *hosted)
{
	cau_dds *dds = user;
	cau_dds_session *session = find_session(dds, hosted);
	if (!session && (session = calloc(1, sizeof *session))) {
		session->hosted = cau_hosted_share(hosted);
		cau_dds_keys_init(&session->keys, cau_hosted_id(hosted));
		ros_name(session->ros_name, cau_hosted_id(hosted));
		session->has_ros_name = !name_taken(dds, session->ros_name);
		session->next = dds->sessions;
		dds->sessions = session;
	}
	if (session)
		session->seen = true;
}

static void forget_session(cau_dds *dds, cau_dds_session *session)
{
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		cau_dds_drop_hands(&session->tools[i]);
	cau_dds_close_session(dds, session);
	cau_dds_keys_finish(&session->keys);
	cau_hosted_release(session->hosted);
	free(session);
}

static void add_tool(cau_dds *dds, cau_dds_session *session, const char name[CAU_NAME_BYTES])
{
	for (int i = 0; i < CAU_MAX_TOOLS; i++) {
		cau_dds_tool *tool = &session->tools[i];
		if (tool->used)
			continue;
		*tool =
			(cau_dds_tool){.used = true, .seen = true, .operating = {.state = OPERATING_ENABLED}};
		memcpy(tool->name, name, sizeof tool->name);
		cau_dds_open_tool(dds, session, tool);
		return;
	}
}

static void let_tools_in(cau_dds_session *session)
{
	const char *names[CAU_MAX_TOOLS];
	int count = 0;
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		if (session->tools[i].used)
			names[count++] = session->tools[i].name;
	cau_dds_keys_set_tools(&session->keys, names, count);
}

static void follow_tools(cau_dds *dds, cau_dds_session *session, const cau_hosted_tool *tools,
                         int32_t count)
{
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		session->tools[i].seen = false;
	for (int32_t i = 0; i < count; i++) {
		cau_dds_tool *known = cau_dds_find_tool(session, tools[i].state.name);
		if (known)
			known->seen = true;
	}
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		if (session->tools[i].used && !session->tools[i].seen) {
			cau_dds_drop_hands(&session->tools[i]);
			cau_dds_unpublish(session, session->tools[i].name);
			cau_dds_close_tool(dds, &session->tools[i]);
		}
	for (int32_t i = 0; i < count; i++)
		if (!cau_dds_find_tool(session, tools[i].state.name))
			add_tool(dds, session, tools[i].state.name);
	for (int32_t i = 0; i < count; i++) {
		cau_dds_tool *known = cau_dds_find_tool(session, tools[i].state.name);
		if (known)
			cau_dds_follow_jaws(dds, session, known, cau_dds_has_jaws(&tools[i].state));
	}
	let_tools_in(session);
}

static void follow_session(cau_dds *dds, cau_dds_session *session, double now_s)
{
	cau_hosted_tool tools[CAU_MAX_TOOLS];
	uint64_t tick;
	double time_s;
	int32_t count = cau_hosted_tools(session->hosted, tools, &tick, &time_s);
	follow_tools(dds, session, tools, count);
	cau_dds_publish(session, tools, count, tick, time_s, now_s);
	cau_dds_publish_operating(session);
}

void cau_dds_list_sessions(cau_dds *dds)
{
	for (cau_dds_session *s = dds->sessions; s; s = s->next)
		s->seen = false;
	cau_hub_each(dds->hub, note_session, dds);
	for (cau_dds_session **link = &dds->sessions; *link;) {
		cau_dds_session *session = *link;
		if (session->seen) {
			if (!session->subscriber)
				cau_dds_open_session(dds, session);
			link = &session->next;
		} else {
			*link = session->next;
			forget_session(dds, session);
		}
	}
}

static void deliver(cau_dds *dds, cau_dds_post *post)
{
	for (cau_dds_session *s = dds->sessions; s; s = s->next)
		if (s->stream.ticket == post->ticket) { // tickets are never 0
			cau_dds_joined(s, post);
			s->look_s = 0;
		}
	cau_dds_reply_post(dds, post);
}

static bool is_session_read(const cau_dds_session *session)
{
	const cau_dds_stream *stream = &session->stream;
	bool any = cau_dds_is_read(&session->state) || cau_dds_is_read(&session->grasp) ||
	           cau_dds_is_read(&session->power) || cau_dds_is_read(&session->force) ||
	           cau_dds_is_read(&stream->topology) || cau_dds_is_read(&stream->key) ||
	           cau_dds_is_read(&stream->delta);
	for (int i = 0; i < CAU_MAX_TOOLS && !any; i++) {
		const cau_dds_tool *tool = &session->tools[i];
		any = cau_dds_is_read(&tool->pose) || cau_dds_is_read(&tool->asked) ||
		      cau_dds_is_read(&tool->force) || cau_dds_is_read(&tool->raw_force) ||
		      cau_dds_is_read(&tool->jaw) || cau_dds_is_read(&tool->asked_jaw);
	}
	return any;
}

// Serves one session. Returns when to check it again.
static double serve_session(cau_dds *dds, cau_dds_session *session, double now_s)
{
	follow_session(dds, session, now_s);
	cau_dds_count_dropped(session);
	double look_s = fmin(now_s + LOOK_EVERY_S, cau_dds_states_due(session));
	look_s = fmin(look_s, cau_dds_publish_status(session, now_s));
	return fmin(look_s, cau_dds_serve_frames(dds, session, now_s));
}

// Notes which sessions have readers. A slice of such a session wakes the thread at once; a slice of
// another session does not.
static void note_read(cau_dds *dds)
{
	cau_dds_bits read = {0};
	for (const cau_dds_session *s = dds->sessions; s; s = s->next)
		if (is_session_read(s))
			cau_dds_set_bit(&read, cau_hosted_number(s->hosted));
	for (int i = 0; i < BITS_WORDS; i++)
		atomic_store(&dds->wakeup.read.words[i], read.words[i]);
}

double cau_dds_serve(cau_dds *dds)
{
	double now_s = cau_monotonic_s(), look_s = now_s + UNREAD_LOOK_S;
	cau_dds_bits marked;
	for (cau_dds_post *post; (post = cau_dds_next_post(&dds->mailbox));) {
		deliver(dds, post);
		cau_dds_post_free(post);
	}
	// This comes before the marks are taken, so that no slice is missed: a slice that does not wake
	// the thread leaves a mark.
	note_read(dds);
	cau_dds_take_bits(&dds->wakeup.marked, &marked);
	for (cau_dds_session *s = dds->sessions; s; s = s->next) {
		// list the sessions again at once, even if no other notice comes
		if (cau_hosted_ended(s->hosted))
			cau_dds_wake(&dds->wakeup, &dds->wakeup.sessions_changed);
		if (!s->subscriber)
			continue;
		if (now_s >= s->look_s || cau_dds_has_bit(&marked, cau_hosted_number(s->hosted)))
			s->look_s = serve_session(dds, s, now_s);
		look_s = fmin(look_s, s->look_s);
	}
	return fmin(look_s, cau_dds_end_farewells(&dds->farewells, now_s));
}

void cau_dds_close_sessions(cau_dds *dds)
{
	cau_dds_prune(dds, 0, true);
	for (cau_dds_session *next; dds->sessions; dds->sessions = next) {
		next = dds->sessions->next;
		forget_session(dds, dds->sessions);
	}
	cau_dds_await_farewells(&dds->farewells);
}
