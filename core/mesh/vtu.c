// SPDX-License-Identifier: GPL-3.0-or-later
// Reads VTK's XML files: unstructured grids (.vtu) and surfaces (.vtp), with all their pieces.
// Format: "VTK File Formats", XML formats. Only the XML of these files is supported: tags with
// attributes.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "mesh/mesh_builder.h"
#include "mesh/vtk.h"

typedef struct tag {
	cau_word name;   // with a leading '/' in a closing tag
	cau_word inside; // the attributes
} tag;

typedef enum section { OTHER, POINTS, CELLS, CELL_DATA, POLYS, STRIPS } section;
typedef enum part { POSITION, CORNER, OFFSET, TYPE, REGION, PARTS } part;

typedef struct vtu {
	cau_scan *scan;
	cau_mesh_builder *builder;
	cau_vtu_coding coding;
	section in;
	cau_vtu_array array[PARTS]; // arrays of the piece: positions, regions, and cells or POLYS
	cau_vtu_array strip[PARTS];
	int32_t *cell_region; // (cell_count)
	int32_t cell_count, cell_capacity;
	int64_t lead; // points and lines of the piece; their data come before the data of surfaces
} vtu;

// ---- XML
// Returns the value of an attribute; empty if the tag does not have the attribute.
static cau_word value_of(const tag *in, const char *name)
{
	const char *at = in->inside.text, *end = at + in->inside.length;
	size_t length = strlen(name);
	while (at < end) {
		while (at < end && (*at == ' ' || (*at >= 9 && *at <= 13)))
			at++;
		const char *start = at;
		while (at < end && *at != '=' && *at > ' ')
			at++;
		bool is_this = (size_t)(at - start) == length && !memcmp(start, name, length);
		while (at < end && *at != '"' && *at != '\'')
			at++;
		const char *close = at < end ? memchr(at + 1, *at, (size_t)(end - at - 1)) : NULL;
		if (!close)
			break;
		if (is_this)
			return (cau_word){at + 1, (size_t)(close - at - 1)};
		at = close + 1;
	}
	return (cau_word){0};
}

// Reads the next tag and moves past its end. Returns false if there is none.
static bool next_tag(cau_scan *scan, tag *found)
{
	const unsigned char *from = scan->bytes + scan->at;
	const unsigned char *open = memchr(from, '<', cau_scan_left(scan));
	const unsigned char *close =
		open ? memchr(open, '>', scan->count - (size_t)(open - scan->bytes)) : NULL;
	if (!close || scan->status)
		return false;
	scan->mark = (size_t)(open - scan->bytes);
	scan->at = (size_t)(close - scan->bytes) + 1;
	const char *name = (const char *)open + 1, *at = name;
	while (at<(const char *)close && * at> ' ')
		at++;
	found->name = (cau_word){name, (size_t)(at - name)};
	found->inside = (cau_word){at, (size_t)((const char *)close - at)};
	return true;
}

// ---- the file's head
static void find_appended(vtu *v)
{
	static const char start[] = "<AppendedData";
	cau_scan scan = *v->scan;
	tag found;
	const unsigned char *at = memmem(scan.bytes, scan.count, start, sizeof start - 1);
	if (!at)
		return;
	scan.at = (size_t)(at - scan.bytes);
	if (!next_tag(&scan, &found))
		return;
	const unsigned char *mark = memchr(scan.bytes + scan.at, '_', cau_scan_left(&scan));
	if (!mark)
		return;
	v->coding.appended = mark + 1;
	v->coding.appended_bytes = scan.count - (size_t)(mark + 1 - scan.bytes);
	v->coding.appended_base64 = cau_word_is(value_of(&found, "encoding"), "base64");
}

static void read_head(vtu *v, const tag *head)
{
	cau_word type = value_of(head, "type"), compressor = value_of(head, "compressor");
	bool big = cau_word_is(value_of(head, "byte_order"), "BigEndian");
	v->coding.swap = big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
	v->coding.header_bytes = cau_word_is(value_of(head, "header_type"), "UInt64") ? 8 : 4;
	v->coding.zlib = cau_word_is(compressor, "vtkZLibDataCompressor");
	if (compressor.length && !v->coding.zlib)
		cau_scan_fail(v->scan, CAU_UNSUPPORTED,
		              "%.*s is not read: save the file with zlib or uncompressed",
		              compressor.length < 40 ? (int)compressor.length : 40, compressor.text);
	if (!cau_word_is(type, "UnstructuredGrid") && !cau_word_is(type, "PolyData"))
		cau_scan_fail(v->scan, CAU_UNSUPPORTED,
		              "a VTK file of type %.*s: save it as an unstructured grid (.vtu)",
		              type.length < 40 ? (int)type.length : 40, type.length ? type.text : "");
	snprintf(v->builder->report.format, sizeof v->builder->report.format, "VTK XML %.*s",
	         type.length < 16 ? (int)type.length : 16, type.length ? type.text : "");
}

// ---- arrays
static void read_array(vtu *v, const tag *in)
{
	cau_word name = value_of(in, "Name"), offset = value_of(in, "offset");
	cau_vtu_array made = {.type = value_of(in, "type"), .format = value_of(in, "format")};
	if (!made.format.length)
		made.format = (cau_word){"ascii", 5};
	if (offset.length)
		made.offset = cau_scan_word_integer(v->scan, offset, "an offset", 0, INT64_MAX);
	made.text = v->scan->bytes + v->scan->at;
	bool closed = in->inside.length && in->inside.text[in->inside.length - 1] == '/';
	const unsigned char *end = closed ? NULL : memchr(made.text, '<', cau_scan_left(v->scan));
	made.text_bytes = end ? (size_t)(end - made.text) : 0;
	cau_vtu_array *to = v->in == STRIPS ? v->strip : v->array;
	if (v->in == POINTS)
		v->array[POSITION] = made;
	else if (v->in == CELL_DATA && cau_vtk_is_region_name(name))
		v->array[REGION] = made;
	else if (v->in >= CELLS && v->in != CELL_DATA && cau_word_is(name, "connectivity"))
		to[CORNER] = made;
	else if (v->in >= CELLS && v->in != CELL_DATA && cau_word_is(name, "offsets"))
		to[OFFSET] = made;
	else if (v->in == CELLS && cau_word_is(name, "types"))
		v->array[TYPE] = made;
}

static double *numbers_of(vtu *v, const cau_vtu_array *array, int64_t *count)
{
	*count = 0;
	return array->format.length ? cau_vtu_numbers(&v->coding, array, count) : NULL;
}

static void add_points(vtu *v)
{
	int64_t count;
	double *number = numbers_of(v, &v->array[POSITION], &count);
	for (int64_t i = 0; i + 3 <= count && !v->scan->status; i += 3)
		cau_mesh_builder_vertex(v->builder, number + i);
	free(number);
}

// ---- cells
static bool grow_regions(vtu *v)
{
	if (v->cell_count < v->cell_capacity)
		return true;
	int32_t capacity = v->cell_capacity ? 2 * v->cell_capacity : 64;
	int32_t *grown = v->cell_capacity <= CAU_MESH_MAX_ELEMENTS
	                     ? realloc(v->cell_region, (size_t)capacity * sizeof *grown)
	                     : NULL;
	if (!grown) {
		cau_scan_fail(v->scan, CAU_LIMIT, "more cells than a mesh may have");
		return false;
	}
	v->cell_region = grown;
	v->cell_capacity = capacity;
	return true;
}

// Adds one cell of `corners` numbers of the connectivity. Points of the piece begin at `first`.
static void add_cell(vtu *v, int64_t type, const double *corner, int64_t corners, int64_t first,
                     double region)
{
	int64_t *point = cau_mesh_array((size_t)corners, sizeof *point);
	if (!point)
		cau_scan_fail(v->scan, CAU_NO_MEMORY, "no memory for a cell");
	else if (grow_regions(v)) {
		for (int64_t c = 0; c < corners; c++) // a number that cannot be a point becomes -1
			point[c] = corner[c] >= 0 && corner[c] <= INT32_MAX ? first + (int64_t)corner[c] : -1;
		v->cell_region[v->cell_count] = fabs(region) <= INT32_MAX ? (int32_t)region : 0;
		cau_vtk_add_cell(v->builder, type, point, corners, v->cell_count++);
	}
	free(point);
}

// Adds the cells of one section. If `type` is 0, each cell has its own type in the array of types.
static void add_cells(vtu *v, const cau_vtu_array *array, int64_t type, int64_t first,
                      const double *region, int64_t region_count)
{
	int64_t corner_count, offset_count, type_count;
	double *corner = numbers_of(v, &array[CORNER], &corner_count);
	double *offset = numbers_of(v, &array[OFFSET], &offset_count);
	double *types = numbers_of(v, &array[TYPE], &type_count);
	double from = 0;
	for (int64_t i = 0; i < offset_count && !v->scan->status; i++) {
		if (!(offset[i] >= from && offset[i] <= (double)corner_count)) {
			cau_scan_fail(v->scan, CAU_BAD_SYNTAX, "the offsets do not ascend, at cell %lld",
			              (long long)i);
			break;
		}
		if (!type && i >= type_count) {
			cau_scan_fail(v->scan, CAU_BAD_SYNTAX, "cell %lld has no type", (long long)i);
			break;
		}
		bool known = type || (types[i] >= 0 && types[i] <= 255);
		add_cell(v,
		         type    ? type
		         : known ? (int64_t)types[i]
		                 : 255,
		         corner ? corner + (int64_t)from : NULL, (int64_t)offset[i] - (int64_t)from, first,
		         i < region_count ? region[i] : 0);
		from = floor(offset[i]);
	}
	free(corner);
	free(offset);
	free(types);
}

static void end_piece(vtu *v, bool surface)
{
	int64_t first = v->builder->mesh.vertex_count, region_count = 0;
	add_points(v);
	double *region = numbers_of(v, &v->array[REGION], &region_count);
	int64_t lead = v->lead < region_count ? v->lead : region_count;
	add_cells(v, v->array, surface ? CAU_VTK_POLYGON : 0, first, region ? region + lead : NULL,
	          region_count - lead);
	add_cells(v, v->strip, CAU_VTK_STRIP, first, NULL, 0);
	free(region);
	v->lead = 0;
	memset(v->array, 0, sizeof v->array);
	memset(v->strip, 0, sizeof v->strip);
}

// ---- the loop over all tags
static void read_tag(vtu *v, const tag *at, bool *surface)
{
	static const struct {
		const char *name;
		section in;
	} sections[] = {{"Points", POINTS}, {"Cells", CELLS},   {"CellData", CELL_DATA},
	                {"Polys", POLYS},   {"Strips", STRIPS}, {"PointData", OTHER},
	                {"Verts", OTHER},   {"Lines", OTHER}};
	if (cau_word_is(at->name, "VTKFile"))
		read_head(v, at);
	else if (cau_word_is(at->name, "PolyData"))
		*surface = true;
	else if (cau_word_is(at->name, "/Piece"))
		end_piece(v, *surface);
	else if (cau_word_is(at->name, "DataArray"))
		read_array(v, at);
	for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
		if (cau_word_is(at->name, sections[i].name))
			v->in = sections[i].in;
	static const char *const passed[][2] = {{"NumberOfVerts", "points"},
	                                        {"NumberOfLines", "lines"}};
	for (size_t i = 0; i < 2 && cau_word_is(at->name, "Piece"); i++) {
		cau_word word = value_of(at, passed[i][0]);
		int64_t count =
			word.length ? cau_scan_word_integer(v->scan, word, passed[i][0], 0, INT32_MAX) : 0;
		cau_mesh_builder_skip(v->builder, passed[i][1], count);
		v->lead += count;
	}
}

cau_status cau_mesh_read_vtu(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	vtu v = {.scan = scan, .builder = builder, .coding = {.scan = scan, .header_bytes = 4}};
	tag at = {0};
	bool surface = false, headed = false;
	find_appended(&v);
	while (next_tag(scan, &at) && !cau_word_is(at.name, "AppendedData")) {
		headed = headed || cau_word_is(at.name, "VTKFile");
		read_tag(&v, &at, &surface);
	}
	if (!headed)
		cau_scan_fail(scan, CAU_UNSUPPORTED, "the file is XML but not VTK: there is no <VTKFile>");
	if (headed && !cau_word_is(at.name, "/VTKFile") && !cau_word_is(at.name, "AppendedData"))
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file ends before </VTKFile>");
	cau_mesh_builder_map_regions(builder, v.cell_region, v.cell_count);
	free(v.cell_region);
	return scan->status;
}
