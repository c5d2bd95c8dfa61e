// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "mesh/mesh_builder.h"

enum { MAX_REGIONS = 256, MAX_CORNERS = 1 << 20 };

typedef struct obj {
	cau_scan *scan;
	cau_mesh_builder *builder;
	double *texture; // UV of each vt line, (texture_count x 2)
	int32_t texture_count;
	int32_t texture_capacity;
	bool bare; // a corner without texture was read
	const char *region_keyword;
	cau_word region_name[MAX_REGIONS];
	int32_t region_count;
	int32_t region;         // region of the next faces
	int32_t *corner_vertex; // corners of the face being read, (corner_capacity)
	double *corner_texture; // UV of the corners of the face being read, (corner_capacity x 2)
	int32_t corner_capacity;
} obj;

typedef struct corner {
	int32_t vertex;
	double texture[2];
} corner;

static void read_vertex(obj *o)
{
	double position[3];
	for (int c = 0; c < 3; c++)
		position[c] = cau_scan_word_real(o->scan, cau_scan_word_of_line(o->scan), "a coordinate");
	cau_mesh_builder_vertex(o->builder, position);
}

static void read_texture(obj *o)
{
	double u = cau_scan_word_real(o->scan, cau_scan_word_of_line(o->scan), "a texture coordinate");
	cau_word word = cau_scan_word_of_line(o->scan); // the coordinate v may be missing
	double v = word.length ? cau_scan_word_real(o->scan, word, "a texture coordinate") : 0;
	if (o->texture_count == o->texture_capacity) {
		int32_t capacity = o->texture_capacity ? 2 * o->texture_capacity : 64;
		void *grown = capacity <= 3 * CAU_MESH_MAX_ELEMENTS
		                  ? realloc(o->texture, 2 * (size_t)capacity * sizeof *o->texture)
		                  : NULL;
		if (!grown) {
			cau_scan_fail(o->scan, CAU_NO_MEMORY, "no memory for %d texture coordinates", capacity);
			return;
		}
		o->texture = grown;
		o->texture_capacity = capacity;
	}
	o->texture[2 * (size_t)o->texture_count] = u;
	o->texture[2 * (size_t)o->texture_count + 1] = v;
	o->texture_count++;
}

// Removes the part before the next '/' from a word and returns that part.
static cau_word cut_part(cau_word *word)
{
	const char *slash = word->length ? memchr(word->text, '/', word->length) : NULL;
	cau_word part = {word->text, slash ? (size_t)(slash - word->text) : word->length};
	size_t used = part.length + (slash ? 1 : 0);
	*word = (cau_word){word->text + used, word->length - used};
	return part;
}

// Reads an index into the `count` items read so far, and returns it counted from 0. Positive
// indices count from 1, negative ones from the last item backwards. Returns -1 after a failure.
static int32_t read_index(obj *o, cau_word word, const char *what, int32_t count)
{
	CAU_ASSERT(count >= 0, "%s among %d", what, count);
	int64_t number = cau_scan_word_integer(o->scan, word, what, INT32_MIN, INT32_MAX);
	int64_t index = number < 0 ? count + number : number - 1;
	if (!o->scan->status && (index < 0 || index >= count))
		cau_scan_fail(o->scan, CAU_BAD_MESH, "%lld as %s: the file has only %d so far",
		              (long long)number, what, count);
	return o->scan->status ? -1 : (int32_t)index;
}

static corner read_corner(obj *o, cau_word word)
{
	corner read = {0};
	read.vertex = read_index(o, cut_part(&word), "a vertex number", o->builder->mesh.vertex_count);
	cau_word texture = cut_part(&word);
	if (!texture.length) {
		o->bare = true;
		return read;
	}
	int32_t index = read_index(o, texture, "a texture number", o->texture_count);
	if (index >= 0)
		memcpy(read.texture, o->texture + 2 * (size_t)index, sizeof read.texture);
	return read;
}

// Grows the arrays for one more corner of a face. Returns false if that is impossible; the scan has
// then failed.
static bool reserve_corner(obj *o, int32_t count)
{
	if (count < o->corner_capacity)
		return true;
	if (count == MAX_CORNERS) {
		cau_scan_fail(o->scan, CAU_LIMIT, "a face has more than %d corners", MAX_CORNERS);
		return false;
	}
	int32_t capacity = o->corner_capacity ? 2 * o->corner_capacity : 16;
	int32_t *vertex = realloc(o->corner_vertex, (size_t)capacity * sizeof *vertex);
	o->corner_vertex = vertex ? vertex : o->corner_vertex;
	double *texture = realloc(o->corner_texture, 2 * (size_t)capacity * sizeof *texture);
	o->corner_texture = texture ? texture : o->corner_texture;
	if (vertex && texture)
		o->corner_capacity = capacity;
	else
		cau_scan_fail(o->scan, CAU_NO_MEMORY, "no memory for a face of %d corners", count + 1);
	return vertex && texture;
}

static void read_face(obj *o)
{
	size_t line = o->scan->mark;
	int32_t count = 0;
	for (;;) {
		cau_word word = cau_scan_word_of_line(o->scan);
		if (!word.length || word.text[0] == '#' || !reserve_corner(o, count))
			break;
		corner read = read_corner(o, word);
		o->corner_vertex[count] = read.vertex;
		memcpy(o->corner_texture + 2 * (size_t)count++, read.texture, sizeof read.texture);
	}
	o->scan->mark = line;
	if (o->scan->status)
		return;
	if (count < 3)
		cau_mesh_builder_skip(o->builder, "faces of fewer than 3 corners", 1);
	else
		cau_mesh_builder_polygon(o->builder, o->corner_vertex, count, o->region, o->corner_texture);
}

// Reads the rest of the line as the name of a region. Later faces belong to that region.
static void read_region(obj *o)
{
	cau_word name = cau_scan_word_of_line(o->scan), word = name;
	while (word.length) {
		name.length = (size_t)(word.text - name.text) + word.length;
		word = cau_scan_word_of_line(o->scan);
	}
	for (int32_t i = 0; i < o->region_count; i++)
		if (o->region_name[i].length == name.length &&
		    (name.length == 0 || !memcmp(o->region_name[i].text, name.text, name.length))) {
			o->region = i + 1;
			return;
		}
	if (o->region_count == MAX_REGIONS) {
		cau_scan_fail(o->scan, CAU_LIMIT, "more than %d names of materials or groups", MAX_REGIONS);
		return;
	}
	o->region_name[o->region_count++] = name;
	o->region = o->region_count;
	cau_mesh_builder_name(o->builder, 2, o->region, name);
}

static void read_line(obj *o)
{
	cau_word keyword = cau_scan_word_of_line(o->scan);
	if (cau_word_is(keyword, "v"))
		read_vertex(o);
	else if (cau_word_is(keyword, "vt"))
		read_texture(o);
	else if (cau_word_is(keyword, "f"))
		read_face(o);
	else if (cau_word_is(keyword, "l") || cau_word_is(keyword, "p"))
		cau_mesh_builder_skip(o->builder, cau_word_is(keyword, "l") ? "lines" : "points", 1);
	else if (cau_word_is(keyword, "curv") || cau_word_is(keyword, "surf"))
		cau_mesh_builder_skip(o->builder, "free-form curves and surfaces", 1);
	else if (cau_word_is(keyword, o->region_keyword))
		read_region(o);
	cau_scan_skip_line(o->scan);
}

static bool has_keyword(cau_scan scan, const char *keyword)
{
	while (cau_scan_left(&scan)) {
		if (cau_word_is(cau_scan_word_of_line(&scan), keyword))
			return true;
		cau_scan_skip_line(&scan);
	}
	return false;
}

cau_status cau_mesh_read_obj(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	obj o = {.scan = scan, .builder = builder};
	o.region_keyword = has_keyword(*scan, "usemtl") ? "usemtl" : "g";
	builder->texture = true;
	while (cau_scan_left(scan) && !scan->status)
		read_line(&o);
	free(o.texture);
	free(o.corner_vertex);
	free(o.corner_texture);
	if (o.bare && o.texture_count)
		cau_mesh_builder_skip(builder, "texture points (some corners have none)", o.texture_count);
	if (o.bare) {
		free(builder->mesh.texture);
		builder->mesh.texture = NULL;
	}
	return scan->status;
}
