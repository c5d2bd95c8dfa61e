// SPDX-License-Identifier: GPL-3.0-or-later
// Memory shared by sessions of equal tissue. Most of a session's memory never changes, and much of
// the rest does not change before the first cut (base/image.c).
#include "cautery/assert.h"
#include "session/session_internal.h"

int32_t cau_session_pages(const cau_session *session, cau_pages pages[CAU_IMAGE_PARTS])
{
	_Static_assert(CAU_FACTOR_PARTS + 1 + CAU_MAX_TOOLS < CAU_IMAGE_PARTS, "room for all");
	int32_t count = 0;
	if (session->solver.factor)
		count += cau_factor_pages(session->solver.factor, pages);
	pages[count++] = session->solver.sweep.pages;
	for (int32_t i = 0; i < session->tool_count; i++)
		pages[count++] = session->tool[i].grid.pages;
	return count + cau_arena_pages(&session->memory.arena, pages + count, CAU_IMAGE_PARTS - count);
}

size_t cau_session_share(cau_session *session)
{
	CAU_ASSERT(!session->memory.image, "session '%s' shares already", session->scene->name);
	cau_pages pages[CAU_IMAGE_PARTS];
	bool made = false;
	cau_matrix_update_await(&session->update);
	int32_t count = cau_session_pages(session, pages);
	session->memory.image = cau_image_of(cau_session_tissue_hash(session), pages, count, &made);
	return session->memory.image ? cau_image_show(session->memory.image, pages, count, made) : 0;
}
