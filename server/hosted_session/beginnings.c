// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/beginnings.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/scene_json.h"
#include "cautery/session.h"

static void destroy(cau_beginning *beginning)
{
	free(beginning->definition);
	free(beginning->snapshot);
	free(beginning);
}

// Returns the scene's definition as the store has it; malloc'ed, or NULL if memory runs out.
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
	return beginning && beginning->definition_bytes == byte_count &&
	       memcmp(beginning->definition, definition, byte_count) == 0;
}

void cau_beginnings_init(cau_beginnings *all)
{
	*all = (cau_beginnings){0};
	pthread_mutex_init(&all->mutex, NULL);
}

// ---- with the mutex locked
static cau_beginning **place_of(cau_beginnings *all, const char *definition, size_t byte_count)
{
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		if (is_of(all->kept[i], definition, byte_count))
			return &all->kept[i];
	return NULL;
}

// Returns an unused slot if there is one, otherwise the slot with the oldest request.
static cau_beginning **asked_for_longest_ago(cau_beginnings *all)
{
	cau_beginning **oldest = &all->kept[0];
	for (int i = 0; i < CAU_BEGINNINGS_MOST && *oldest; i++)
		if (!all->kept[i] || all->kept[i]->asked < (*oldest)->asked)
			oldest = &all->kept[i];
	return oldest;
}

static void give_up(cau_beginning *beginning)
{
	if (beginning && --beginning->holders == 0)
		destroy(beginning);
}

// ---- with the mutex unlocked
cau_beginning *cau_beginnings_hold(cau_beginnings *all, const cau_scene_def *scene)
{
	size_t byte_count = 0;
	char *definition = define(scene, &byte_count);
	if (!definition)
		return NULL;
	pthread_mutex_lock(&all->mutex);
	cau_beginning **place = place_of(all, definition, byte_count), *found = place ? *place : NULL;
	if (found) {
		found->holders++;
		found->asked = ++all->asked;
	}
	pthread_mutex_unlock(&all->mutex);
	free(definition);
	return found;
}

void cau_beginnings_let_go(cau_beginnings *all, cau_beginning *held)
{
	pthread_mutex_lock(&all->mutex);
	give_up(held);
	pthread_mutex_unlock(&all->mutex);
}

static bool take(cau_beginning *made, const cau_scene_def *scene, const cau_session *core)
{
	size_t capacity = cau_session_snapshot_bytes(core);
	made->tissue_hash = cau_session_tissue_hash(core);
	made->snapshot = malloc(capacity);
	made->definition = define(scene, &made->definition_bytes);
	if (!made->definition || !made->snapshot ||
	    cau_session_snapshot(core, made->snapshot, capacity, &made->byte_count, NULL) ||
	    made->byte_count > CAU_BEGINNING_BYTES)
		return false;
	void *smaller = realloc(made->snapshot, made->byte_count);
	made->snapshot = smaller ? smaller : made->snapshot;
	return true;
}

void cau_beginnings_keep(cau_beginnings *all, const cau_scene_def *scene, const cau_session *core)
{
	cau_beginning *made = cau_session_has_tension(core) ? calloc(1, sizeof *made) : NULL;
	if (!made)
		return;
	if (!take(made, scene, core)) {
		destroy(made);
		return;
	}
	made->holders = 1;
	pthread_mutex_lock(&all->mutex);
	cau_beginning **place = place_of(all, made->definition, made->definition_bytes);
	place = place ? place : asked_for_longest_ago(all);
	give_up(*place);
	made->asked = ++all->asked;
	*place = made;
	pthread_mutex_unlock(&all->mutex);
}

void cau_beginnings_forget(cau_beginnings *all, const cau_beginning *held)
{
	pthread_mutex_lock(&all->mutex);
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		if (all->kept[i] == held) {
			give_up(all->kept[i]);
			all->kept[i] = NULL;
		}
	pthread_mutex_unlock(&all->mutex);
}

void cau_beginnings_finish(cau_beginnings *all)
{
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++) {
		CAU_ASSERT(!all->kept[i] || all->kept[i]->holders == 1, "a beginning that %d hold",
		           all->kept[i]->holders);
		give_up(all->kept[i]);
		all->kept[i] = NULL;
	}
	pthread_mutex_destroy(&all->mutex);
}
