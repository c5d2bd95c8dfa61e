// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/beginnings.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

static void drop(cau_beginnings *all, int32_t at)
{
	CAU_ASSERT_INDEX(at, all->count);
	all->byte_count -= all->kept[at].byte_count;
	free(all->kept[at].scene);
	free(all->kept[at].snapshot);
	all->count--;
	memmove(&all->kept[at], &all->kept[at + 1], (size_t)(all->count - at) * sizeof *all->kept);
}

static void put_first(cau_beginnings *all, int32_t at)
{
	CAU_ASSERT_INDEX(at, all->count);
	cau_beginning first = all->kept[at];
	memmove(&all->kept[1], &all->kept[0], (size_t)at * sizeof *all->kept);
	all->kept[0] = first;
}

// Scenes are compared as they lie in memory: read by the same code into zeroed memory, the same
// text gives the same bytes. Meshes that came with a session lie elsewhere each time, so such a
// scene is nobody else's.
const cau_beginning *cau_beginnings_find(cau_beginnings *all, const cau_scene_def *scene)
{
	for (int32_t i = 0; i < all->count; i++)
		if (memcmp(all->kept[i].scene, scene, sizeof *scene) == 0) {
			put_first(all, i);
			return &all->kept[0];
		}
	return NULL;
}

static bool make(cau_beginning *made, const cau_scene_def *scene, const cau_session *core)
{
	size_t capacity = cau_session_snapshot_bytes(core);
	*made = (cau_beginning){.scene = malloc(sizeof *scene), .snapshot = malloc(capacity)};
	if (made->scene && made->snapshot &&
	    !cau_session_snapshot(core, made->snapshot, capacity, &made->byte_count, NULL)) {
		memcpy(made->scene, scene, sizeof *scene);
		void *smaller = realloc(made->snapshot, made->byte_count);
		made->snapshot = smaller ? smaller : made->snapshot;
		return true;
	}
	free(made->scene);
	free(made->snapshot);
	return false;
}

void cau_beginnings_keep(cau_beginnings *all, const cau_scene_def *scene, const cau_session *core)
{
	cau_beginning made;
	if (!cau_session_has_tension(core) || !make(&made, scene, core))
		return;
	if (all->count == CAU_BEGINNINGS_MOST)
		drop(all, all->count - 1);
	all->kept[all->count++] = made;
	all->byte_count += made.byte_count;
	put_first(all, all->count - 1);
	while (all->byte_count > CAU_BEGINNINGS_BYTES)
		drop(all, all->count - 1);
}

void cau_beginnings_drop_first(cau_beginnings *all)
{
	drop(all, 0);
}

void cau_beginnings_finish(cau_beginnings *all)
{
	while (all->count)
		drop(all, all->count - 1);
}
