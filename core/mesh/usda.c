// SPDX-License-Identifier: GPL-3.0-or-later
// Reads USD as text (.usda): the prims UsdGeomTetMesh and UsdGeomMesh. Each prim is a region with
// the prim's name. If the layer has metersPerUnit, positions are scaled to metres. Transforms are
// skipped. Schema: UsdGeom.TetMesh, UsdGeom.Mesh.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "mesh/mesh_builder.h"

enum { NUMBERS_MAX = 4 * CAU_MESH_MAX_ELEMENTS };

typedef struct numbers {
	double *number; // (count)
	int32_t count, capacity;
} numbers;

typedef enum attribute { POINTS, TETRAHEDRA, COUNTS, INDICES, ATTRIBUTES } attribute;

typedef struct usda {
	cau_scan *scan;
	cau_mesh_builder *builder;
	double unit_m;
	int depth;      // number of open braces
	int prim_depth; // depth inside the prim that is being read; 0: outside all prims
	cau_word name;
	int32_t prims;
	numbers value[ATTRIBUTES];
} usda;

// ---- tokens: a word, a text in quotes, or one character of punctuation
static bool is_punctuation(unsigned char byte)
{
	return byte && strchr("()[]{}=,;", byte);
}

static void skip_blank(cau_scan *scan)
{
	while (scan->at < scan->count) {
		unsigned char byte = scan->bytes[scan->at];
		if (byte == '#')
			cau_scan_skip_line(scan);
		else if (byte == ' ' || (byte >= 9 && byte <= 13))
			scan->at++;
		else
			return;
	}
}

// Returns the position after the end of a quoted text that begins at `from`.
static size_t end_of_text(const cau_scan *scan, size_t from)
{
	unsigned char quote = scan->bytes[from];
	size_t at = from + 1;
	while (at < scan->count && scan->bytes[at] != quote)
		at += scan->bytes[at] == '\\' ? 2 : 1;
	return at < scan->count ? at + 1 : scan->count;
}

static cau_word next_token(cau_scan *scan)
{
	skip_blank(scan);
	scan->mark = scan->at;
	if (scan->status || scan->at >= scan->count)
		return (cau_word){0};
	unsigned char byte = scan->bytes[scan->at];
	if (byte == '"' || byte == '\'') {
		scan->at = end_of_text(scan, scan->at);
	} else if (is_punctuation(byte)) {
		scan->at++;
	} else {
		while (scan->at < scan->count && scan->bytes[scan->at] > ' ' &&
		       !is_punctuation(scan->bytes[scan->at]) && scan->bytes[scan->at] != '"')
			scan->at++;
		scan->at += scan->at == scan->mark; // any other byte is a token by itself
	}
	return (cau_word){(const char *)scan->bytes + scan->mark, scan->at - scan->mark};
}

static bool token_is(cau_word token, char punctuation)
{
	return token.length == 1 && token.text[0] == punctuation;
}

// ---- values
static void add_number(usda *u, numbers *to, double number)
{
	if (to->count == to->capacity) {
		int32_t capacity = to->capacity ? 2 * to->capacity : 64;
		double *grown =
			capacity <= NUMBERS_MAX ? realloc(to->number, (size_t)capacity * sizeof *grown) : NULL;
		if (!grown) {
			cau_scan_fail(u->scan, CAU_NO_MEMORY, "no memory for %d numbers", capacity);
			return;
		}
		to->number = grown;
		to->capacity = capacity;
	}
	to->number[to->count++] = number;
}

// Reads an array such as = [ (0, 0, 0), (1, 0, 0) ]. All its numbers are stored one after the
// other.
static void read_numbers(usda *u, numbers *to)
{
	if (!token_is(next_token(u->scan), '='))
		return; // the attribute has no value, or has time samples
	if (!token_is(next_token(u->scan), '['))
		cau_scan_fail(u->scan, CAU_BAD_SYNTAX, "expected [");
	to->count = 0;
	while (!u->scan->status) {
		cau_word token = next_token(u->scan);
		if (!token.length)
			cau_scan_fail(u->scan, CAU_BAD_SYNTAX, "the file ends before ]");
		else if (token_is(token, ']'))
			return;
		else if (!is_punctuation((unsigned char)token.text[0]))
			add_number(u, to, cau_scan_word_real(u->scan, token, "a number"));
	}
}

// ---- prims
// Returns the vertex of number i of an attribute. Vertices of the prim begin at `first`. Returns -1
// if there is no such vertex; the scan has then failed.
static int32_t vertex_at(usda *u, const numbers *from, int64_t i, int32_t first)
{
	double index = from->number[i];
	int32_t points = u->value[POINTS].count / 3;
	if (index >= 0 && index < points && index == floor(index))
		return first + (int32_t)index;
	cau_scan_fail(u->scan, CAU_BAD_MESH, "%.*s names point %g, but there are %d points",
	              u->name.length < 40 ? (int)u->name.length : 40, u->name.text, index, points);
	return -1;
}

static void add_tetrahedra(usda *u, int32_t first)
{
	const numbers *from = &u->value[TETRAHEDRA];
	for (int32_t i = 0; i + 4 <= from->count && !u->scan->status; i += 4) {
		int32_t vertex[4];
		for (int c = 0; c < 4; c++)
			vertex[c] = vertex_at(u, from, i + c, first);
		if (!u->scan->status)
			cau_mesh_builder_cell(u->builder, CAU_SHAPE_TETRAHEDRON, vertex, u->prims, "tetrahedra",
			                      false);
	}
}

static void add_faces(usda *u, int32_t first)
{
	const numbers *counts = &u->value[COUNTS], *indices = &u->value[INDICES];
	int32_t at = 0;
	int32_t *vertex = cau_mesh_array((size_t)indices->count, sizeof *vertex);
	if (!vertex)
		cau_scan_fail(u->scan, CAU_NO_MEMORY, "no memory for the faces");
	for (int32_t i = 0; i < counts->count && !u->scan->status; i++) {
		double corners = counts->number[i];
		if (!(corners >= 0 && corners <= indices->count - at) || corners != floor(corners)) {
			cau_scan_fail(u->scan, CAU_BAD_MESH, "a face of %g corners", corners);
			break;
		}
		for (int32_t c = 0; c < (int32_t)corners; c++)
			vertex[c] = vertex_at(u, indices, at + c, first);
		at += (int32_t)corners;
		if (!u->scan->status && corners >= 3)
			cau_mesh_builder_polygon(u->builder, vertex, (int32_t)corners, u->prims, NULL);
		else if (!u->scan->status)
			cau_mesh_builder_skip(u->builder, "faces of fewer than 3 corners", 1);
	}
	free(vertex);
}

static void end_prim(usda *u)
{
	const numbers *points = &u->value[POINTS];
	int32_t first = u->builder->mesh.vertex_count;
	for (int32_t i = 0; i + 3 <= points->count; i += 3)
		cau_mesh_builder_vertex(u->builder, points->number + i);
	if (!u->scan->status)
		add_tetrahedra(u, first);
	if (!u->scan->status)
		add_faces(u, first);
	for (int a = 0; a < ATTRIBUTES; a++)
		u->value[a].count = 0;
	u->prim_depth = 0;
}

// Begins a prim such as def TetMesh "name". The contents of its braces are read.
static void begin_prim(usda *u)
{
	cau_word type = next_token(u->scan);
	if (u->prim_depth || (!cau_word_is(type, "TetMesh") && !cau_word_is(type, "Mesh")))
		return;
	cau_word name = next_token(u->scan);
	if (!name.length || name.text[0] != '"')
		return;
	u->name = name;
	u->prim_depth = u->depth + 1;
	cau_mesh_builder_name(u->builder, 0, ++u->prims, name);
}

static void read_metres(usda *u)
{
	if (!token_is(next_token(u->scan), '='))
		return;
	u->unit_m = cau_scan_word_real(u->scan, next_token(u->scan), "metres in one unit");
	if (!u->scan->status && !(u->unit_m > 0 && u->unit_m <= 1e6))
		cau_scan_fail(u->scan, CAU_BAD_MESH, "metersPerUnit %g", u->unit_m);
}

static void read_word(usda *u, cau_word word)
{
	static const struct {
		const char *name;
		attribute to;
	} attributes[] = {{"points", POINTS},
	                  {"tetVertexIndices", TETRAHEDRA},
	                  {"faceVertexCounts", COUNTS},
	                  {"faceVertexIndices", INDICES}};
	if (cau_word_is(word, "def"))
		begin_prim(u);
	else if (cau_word_is(word, "metersPerUnit") && !u->prim_depth)
		read_metres(u);
	else if (word.length > 8 && !memcmp(word.text, "xformOp:", 8))
		cau_mesh_builder_skip(u->builder, "transforms", 1);
	for (size_t i = 0; i < sizeof attributes / sizeof *attributes && u->prim_depth; i++)
		if (u->depth == u->prim_depth && cau_word_is(word, attributes[i].name))
			read_numbers(u, &u->value[attributes[i].to]);
}

cau_status cau_mesh_read_usda(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	usda u = {.scan = scan, .builder = builder, .unit_m = 1};
	for (cau_word word = next_token(scan); word.length; word = next_token(scan)) {
		if (token_is(word, '{'))
			u.depth++;
		else if (token_is(word, '}') && u.depth-- == u.prim_depth && u.prim_depth)
			end_prim(&u);
		else if (u.depth < 0 || u.depth > 1000)
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "braces that do not match");
		else
			read_word(&u, word);
	}
	if (u.depth > 0)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file ends before }");
	for (size_t i = 0; i < 3 * (size_t)builder->mesh.vertex_count; i++)
		builder->mesh.position[i] *= u.unit_m;
	for (int a = 0; a < ATTRIBUTES; a++)
		free(u.value[a].number);
	return scan->status;
}
