// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that sessions of equal tissue have in common: most of what one is made of never changes,
// and much of the rest not before its first cut (base/image.h).
#include "cautery/assert.h"
#include "session/session_internal.h"

typedef struct parts {
	int32_t count;
	cau_pages pages[CAU_IMAGE_PARTS];
} parts;

static void list_factor(const cau_session *session, parts *list)
{
	if (session->solver.factor)
		list->count += cau_factor_pages(session->solver.factor, list->pages + list->count);
	list->pages[list->count++] = session->solver.sweep.pages;
}

static void list_fields(const cau_session *session, parts *list)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		list->pages[list->count++] = session->tool[i].grid.pages;
}

size_t cau_session_share(cau_session *session)
{
	CAU_ASSERT(!session->image, "session '%s' shares already", session->scene->name);
	parts list = {0};
	_Static_assert(CAU_FACTOR_PARTS + 1 + CAU_MAX_TOOLS < CAU_IMAGE_PARTS, "room for all");
	cau_matrix_update_await(&session->update);
	list_factor(session, &list);
	list_fields(session, &list);
	list.count +=
		cau_arena_pages(&session->arena, list.pages + list.count, CAU_IMAGE_PARTS - list.count);
	bool made = false;
	session->image = cau_image_of(cau_session_tissue_hash(session), list.pages, list.count, &made);
	return session->image ? cau_image_show(session->image, list.pages, list.count, made) : 0;
}
