// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/writers.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { VTK_LINE = 3, VTK_TRIANGLE = 5, VTK_TETRA = 10, PATH_BYTES = 1024 };

typedef enum cell_kind { CELL_TETRAHEDRON, CELL_LINK, CELL_TRIANGLE } cell_kind;

// The cells of one file, in the arrays that the format needs.
typedef struct cells {
	int64_t count, corner_count;
	int64_t *corner; // vertices of all cells, one cell after the other
	int64_t *end;    // (count): end of each cell's vertices in `corner`
	uint8_t *type;   // (count): VTK's type of each cell
	uint8_t *kind;   // (count): cell_kind of each cell
	int32_t *layer;  // (count): layer of each triangle, else -1
} cells;

static cau_status fail_file(const char *path, cau_error *error)
{
	const char *reason = strerror(errno);
	snprintf(error->file, sizeof error->file, "%.255s", path);
	return cau_fail(error, CAU_IO, NULL, "cannot write: %s", reason);
}

static cau_status make_path(const sim_vtu *vtu, const char *name, char path[PATH_BYTES],
                            cau_error *error)
{
	int bytes = snprintf(path, PATH_BYTES, "%s/%s", vtu->folder, name);
	if (bytes < 0 || bytes >= PATH_BYTES)
		return cau_fail(
			error, CAU_LIMIT, NULL,
			"the path of %s is longer than %d bytes: choose a folder with a shorter name", name,
			PATH_BYTES - 1);
	return CAU_OK;
}

// ---- cells ------------------------------------------------------------------------------------

static void finish_cells(cells *c)
{
	free(c->corner);
	free(c->end);
	free(c->type);
	free(c->kind);
	free(c->layer);
}

static bool reserve_cells(cells *c, size_t most)
{
	c->corner = malloc((4 * most + 1) * sizeof *c->corner);
	c->end = malloc((most + 1) * sizeof *c->end);
	c->type = malloc(most + 1);
	c->kind = malloc(most + 1);
	c->layer = malloc((most + 1) * sizeof *c->layer);
	return c->corner && c->end && c->type && c->kind && c->layer;
}

static void add_cell(cells *c, const int32_t *vertex, int corners, uint8_t type, cell_kind kind,
                     int32_t layer)
{
	for (int i = 0; i < corners; i++)
		c->corner[c->corner_count++] = vertex[i];
	c->end[c->count] = c->corner_count;
	c->type[c->count] = type;
	c->kind[c->count] = (uint8_t)kind;
	c->layer[c->count++] = layer;
}

static bool is_drawn(const cau_frame *frame, int32_t face)
{
	return !(frame->face_mask[face / 32] >> (face % 32) & 1u);
}

static bool fill_cells(const cau_session *session, const cau_session_info *info,
                       const cau_frame *frame, cells *c)
{
	const uint8_t *tetrahedron, *triangle, *link;
	if (!reserve_cells(c, (size_t)info->tetrahedron_count + (size_t)info->link_count +
	                          (size_t)info->face_count))
		return false;
	cau_session_alive(session, &tetrahedron, &triangle, &link);
	for (int32_t i = 0; i < info->tetrahedron_count; i++)
		if (tetrahedron[i])
			add_cell(c, info->tetrahedron + 4 * (size_t)i, 4, VTK_TETRA, CELL_TETRAHEDRON, -1);
	for (int32_t i = 0; i < info->link_count; i++)
		if (link[i])
			add_cell(c, info->link + 2 * (size_t)i, 2, VTK_LINE, CELL_LINK, -1);
	for (int32_t i = 0; i < info->face_count; i++) {
		int32_t layer = info->face_layer[i];
		if (info->layers[layer].kind != CAU_LAYER_FAT && is_drawn(frame, i))
			add_cell(c, info->face + 3 * (size_t)i, 3, VTK_TRIANGLE, CELL_TRIANGLE, layer);
	}
	return true;
}

// ---- a file -----------------------------------------------------------------------------------

typedef struct array {
	// the XML element that is opened before the array; NULL: the open element continues
	const char *group;
	const char *name, *type;
	int components;
	const void *data;
	size_t bytes;
} array;

static void write_head(FILE *file, const array *arrays, int count, int64_t points,
                       int64_t cell_count)
{
	const char *open = NULL;
	uint64_t offset = 0;
	fprintf(file,
	        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
	        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
	        "<Piece NumberOfPoints=\"%" PRId64 "\" NumberOfCells=\"%" PRId64 "\">\n",
	        points, cell_count);
	for (int i = 0; i < count; i++) {
		if (arrays[i].group) {
			if (open)
				fprintf(file, "</%s>\n", open);
			open = arrays[i].group;
			fprintf(file, "<%s>\n", open);
		}
		fprintf(file,
		        "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" "
		        "format=\"appended\" offset=\"%" PRIu64 "\"/>\n",
		        arrays[i].type, arrays[i].name, arrays[i].components, offset);
		offset += sizeof(uint64_t) + arrays[i].bytes;
	}
	if (open)
		fprintf(file, "</%s>\n", open);
	fputs("</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_", file);
}

static cau_status write_arrays(const char *path, const array *arrays, int count, int64_t points,
                               int64_t cell_count, cau_error *error)
{
	FILE *file = fopen(path, "wb");
	if (!file)
		return fail_file(path, error);
	write_head(file, arrays, count, points, cell_count);
	for (int i = 0; i < count; i++) {
		uint64_t bytes = arrays[i].bytes;
		fwrite(&bytes, sizeof bytes, 1, file);
		if (bytes > 0)
			fwrite(arrays[i].data, 1, arrays[i].bytes, file);
	}
	fputs("\n</AppendedData>\n</VTKFile>\n", file);
	bool failed = ferror(file) != 0;
	if (fclose(file) != 0 || failed)
		return fail_file(path, error);
	return CAU_OK;
}

static cau_status write_grid(const char *path, const cau_session_info *info, const cau_frame *frame,
                             const cells *c, cau_error *error)
{
	size_t n = (size_t)info->vertex_count, m = (size_t)c->count;
	const array arrays[] = {
		{"PointData", "velocity_m_s", "Float64", 3, frame->velocity, 24 * n},
		{NULL, "exposure", "Float32", 1, frame->exposure, 4 * n},
		{NULL, "charring", "Float32", 1, frame->charring, 4 * n},
		{NULL, "temperature_c", "Float32", 1, frame->temperature, 4 * n},
		{NULL, "stress_pa", "Float32", 1, frame->stress, 4 * n},
		{"CellData", "kind", "UInt8", 1, c->kind, m},
		{NULL, "layer", "Int32", 1, c->layer, 4 * m},
		{"Points", "position_m", "Float64", 3, frame->position, 24 * n},
		{"Cells", "connectivity", "Int64", 1, c->corner, 8 * (size_t)c->corner_count},
		{NULL, "offsets", "Int64", 1, c->end, 8 * m},
		{NULL, "types", "UInt8", 1, c->type, m},
	};
	return write_arrays(path, arrays, (int)(sizeof arrays / sizeof *arrays), info->vertex_count,
	                    c->count, error);
}

// ---- tools --------------------------------------------------------------------------------------

// The tools' part of a file. Each tool has two points: its tip and the end of its shaft.
typedef struct tool_arrays {
	double *position;            // (2 count x 3): tips and ends, m
	int64_t *corner, *end;       // corner: (2 count), end: (count), as in `cells`
	uint8_t *type, *energized;   // (count) each
	int32_t *number;             // (count): the tool's number in the tick
	double *force_n, *torque_nm; // (count x 3) each
	double *temperature_c, *energy_j;
} tool_arrays;

static void finish_tools(tool_arrays *a)
{
	free(a->position);
	free(a->corner);
	free(a->end);
	free(a->type);
	free(a->energized);
	free(a->number);
	free(a->force_n);
	free(a->torque_nm);
	free(a->temperature_c);
	free(a->energy_j);
}

static bool reserve_tools(tool_arrays *a, size_t count)
{
	count += 1; // one element more, because malloc(0) may return NULL
	a->position = malloc(6 * count * sizeof *a->position);
	a->corner = malloc(2 * count * sizeof *a->corner);
	a->end = malloc(count * sizeof *a->end);
	a->type = malloc(count);
	a->energized = malloc(count);
	a->number = malloc(count * sizeof *a->number);
	a->force_n = malloc(3 * count * sizeof *a->force_n);
	a->torque_nm = malloc(3 * count * sizeof *a->torque_nm);
	a->temperature_c = malloc(count * sizeof *a->temperature_c);
	a->energy_j = malloc(count * sizeof *a->energy_j);
	return a->position && a->corner && a->end && a->type && a->energized && a->number &&
	       a->force_n && a->torque_nm && a->temperature_c && a->energy_j;
}

// Computes the tip and the end of the shaft. The shaft is along the tool's own +z axis.
static void place_tool(const cau_tool_state *tool, double tip[3], double end[3])
{
	const double *q = tool->pose.rotation, length = tool->definition.shaft_length_m;
	const double shaft[3] = {2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]),
	                         1 - 2 * (q[1] * q[1] + q[2] * q[2])};
	for (int c = 0; c < 3; c++) {
		tip[c] = tool->pose.position_m[c];
		end[c] = tip[c] + length * shaft[c];
	}
}

static void fill_tools(const cau_frame *frame, tool_arrays *a)
{
	for (int32_t i = 0; i < frame->tool_count; i++) {
		const cau_tool_state *tool = &frame->tools[i];
		size_t at = (size_t)i;
		place_tool(tool, a->position + 6 * at, a->position + 6 * at + 3);
		a->corner[2 * at] = 2 * i;
		a->corner[2 * at + 1] = 2 * i + 1;
		a->end[at] = 2 * (i + 1);
		a->type[at] = VTK_LINE;
		a->energized[at] = tool->energized;
		a->number[at] = i;
		memcpy(a->force_n + 3 * at, tool->raw_force_n, sizeof tool->raw_force_n);
		memcpy(a->torque_nm + 3 * at, tool->raw_torque_nm, sizeof tool->raw_torque_nm);
		a->temperature_c[at] = tool->tip_temperature_c;
		a->energy_j[at] = tool->energy_j;
	}
}

static cau_status write_tools(const char *path, const cau_frame *frame, cau_error *error)
{
	tool_arrays a = {0};
	size_t n = (size_t)frame->tool_count;
	cau_status status = CAU_OK;
	if (reserve_tools(&a, n)) {
		fill_tools(frame, &a);
		const array arrays[] = {
			{"CellData", "tool", "Int32", 1, a.number, 4 * n},
			{NULL, "force_n", "Float64", 3, a.force_n, 24 * n},
			{NULL, "torque_nm", "Float64", 3, a.torque_nm, 24 * n},
			{NULL, "temperature_c", "Float64", 1, a.temperature_c, 8 * n},
			{NULL, "energy_j", "Float64", 1, a.energy_j, 8 * n},
			{NULL, "energized", "UInt8", 1, a.energized, n},
			{"Points", "position_m", "Float64", 3, a.position, 48 * n},
			{"Cells", "connectivity", "Int64", 1, a.corner, 16 * n},
			{NULL, "offsets", "Int64", 1, a.end, 8 * n},
			{NULL, "types", "UInt8", 1, a.type, n},
		};
		status = write_arrays(path, arrays, (int)(sizeof arrays / sizeof *arrays),
		                      2 * frame->tool_count, frame->tool_count, error);
	} else {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a file's tools");
	}
	finish_tools(&a);
	return status;
}

// ---- the series ---------------------------------------------------------------------------------

cau_status sim_vtu_begin(const char *folder, sim_vtu *vtu, cau_error *error)
{
	*vtu = (sim_vtu){.folder = folder};
	if (mkdir(folder, 0777) != 0 && errno != EEXIST)
		return fail_file(folder, error);
	return CAU_OK;
}

static cau_status remember(sim_vtu *vtu, const cau_frame *frame, cau_error *error)
{
	size_t count = (size_t)vtu->file_count + 1;
	uint64_t *tick = realloc(vtu->tick, count * sizeof *tick);
	if (tick)
		vtu->tick = tick;
	double *time_s = realloc(vtu->time_s, count * sizeof *time_s);
	if (time_s)
		vtu->time_s = time_s;
	if (!tick || !time_s)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the list of files");
	vtu->tick[vtu->file_count] = frame->tick;
	vtu->time_s[vtu->file_count++] = frame->time_s;
	return CAU_OK;
}

static cau_status write_tissue(const char *path, const cau_session *session, const cau_frame *frame,
                               cau_error *error)
{
	cau_session_info info;
	cells c = {0};
	cau_session_describe(session, &info);
	cau_status status = fill_cells(session, &info, frame, &c)
	                        ? write_grid(path, &info, frame, &c, error)
	                        : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a file's cells");
	finish_cells(&c);
	return status;
}

cau_status sim_vtu_write(sim_vtu *vtu, cau_session *session, cau_error *error)
{
	char name[64], path[PATH_BYTES];
	cau_frame frame;
	cau_session_watch(session, CAU_CHANNEL_STRESS | CAU_CHANNEL_TEMPERATURE);
	cau_session_frame(session, &frame);
	snprintf(name, sizeof name, "tissue-%08" PRIu64 ".vtu", frame.tick);
	cau_status status = make_path(vtu, name, path, error);
	if (!status)
		status = write_tissue(path, session, &frame, error);
	snprintf(name, sizeof name, "tools-%08" PRIu64 ".vtu", frame.tick);
	if (!status)
		status = make_path(vtu, name, path, error);
	if (!status)
		status = write_tools(path, &frame, error);
	if (!status)
		status = remember(vtu, &frame, error);
	cau_session_watch(session, 0);
	return status;
}

cau_status sim_vtu_finish(sim_vtu *vtu, cau_error *error)
{
	char path[PATH_BYTES];
	cau_status status = make_path(vtu, "cautery.pvd", path, error);
	FILE *file = status ? NULL : fopen(path, "wb");
	if (!status && !file)
		status = fail_file(path, error);
	if (file) {
		fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n"
		      "<Collection>\n",
		      file);
		for (int32_t i = 0; i < vtu->file_count; i++)
			fprintf(file,
			        "<DataSet timestep=\"%.9g\" part=\"0\" file=\"tissue-%08" PRIu64 ".vtu\"/>\n"
			        "<DataSet timestep=\"%.9g\" part=\"1\" file=\"tools-%08" PRIu64 ".vtu\"/>\n",
			        vtu->time_s[i], vtu->tick[i], vtu->time_s[i], vtu->tick[i]);
		fputs("</Collection>\n</VTKFile>\n", file);
		if (fclose(file) != 0)
			status = fail_file(path, error);
	}
	free(vtu->tick);
	free(vtu->time_s);
	return status;
}
