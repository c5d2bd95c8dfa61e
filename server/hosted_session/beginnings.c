// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/beginnings.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/scene_json.h"
#include "cautery/session.h"

void cau_beginning_drop(cau_beginning *beginning)
{
	free(beginning->definition);
	free(beginning->snapshot);
	*beginning = (cau_beginning){0};
}

// An empty place goes before any other.
static cau_beginning *asked_for_longest_ago(cau_beginnings *all)
{
	cau_beginning *oldest = &all->kept[0];
	for (int i = 1; i < CAU_BEGINNINGS_MOST; i++)
		if (all->kept[i].asked < oldest->asked)
			oldest = &all->kept[i];
	return oldest;
}

// The scene's definition as it is stored; malloc'ed, or NULL without memory.
static char *define(const cau_scene_def *scene, size_t *byte_count)
{
	cau_error error;
	char *text = malloc(CAU_SCENE_JSON_MAX_BYTES);
	if (text && cau_scene_to_json(scene, text, CAU_SCENE_JSON_MAX_BYTES, byte_count, &error)) {
		free(text);
		return NULL;
	}
	char *smaller = text ? realloc(text, *byte_count + 1) : NULL;
	return smaller ? smaller : text;
}

static bool is_of(const cau_beginning *beginning, const char *definition, size_t byte_count)
{
	return beginning->definition && beginning->definition_bytes == byte_count &&
	       memcmp(beginning->definition, definition, byte_count) == 0;
}

cau_beginning *cau_beginnings_find(cau_beginnings *all, const cau_scene_def *scene)
{
	size_t byte_count = 0;
	cau_beginning *found = NULL;
	char *definition = define(scene, &byte_count);
	for (int i = 0; i < CAU_BEGINNINGS_MOST && definition && !found; i++)
		if (is_of(&all->kept[i], definition, byte_count))
			found = &all->kept[i];
	if (found)
		found->asked = ++all->asked;
	free(definition);
	return found;
}

static bool take(cau_beginning *made, const cau_scene_def *scene, const cau_session *core)
{
	size_t capacity = cau_session_snapshot_bytes(core);
	*made =
		(cau_beginning){.snapshot = malloc(capacity), .tissue_hash = cau_session_tissue_hash(core)};
	made->definition = define(scene, &made->definition_bytes);
	if (made->definition && made->snapshot &&
	    !cau_session_snapshot(core, made->snapshot, capacity, &made->byte_count, NULL) &&
	    made->byte_count <= CAU_BEGINNING_BYTES) {
		void *smaller = realloc(made->snapshot, made->byte_count);
		made->snapshot = smaller ? smaller : made->snapshot;
		return true;
	}
	cau_beginning_drop(made);
	return false;
}

void cau_beginnings_keep(cau_beginnings *all, const cau_scene_def *scene, const cau_session *core)
{
	cau_beginning made;
	if (!cau_session_has_tension(core) || !take(&made, scene, core))
		return;
	cau_beginning *place = asked_for_longest_ago(all);
	cau_beginning_drop(place);
	made.asked = ++all->asked;
	*place = made;
}

void cau_beginnings_finish(cau_beginnings *all)
{
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		cau_beginning_drop(&all->kept[i]);
}
