// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a mesh: the bytes of a file, the format that the bytes show, and the mesh with its report.
// The file's name is ignored: `x.OBJ` and a name without an ending are read like any other.
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/assert.h"
#include "mesh/mesh_builder.h"

// ---- the bytes of a file
enum { PATH_BYTES = 600 };
static const long long most_bytes = 1LL << 30;

// Reads until `wanted` bytes are read or the file ends. Returns the number of bytes, or -1 with
// errno set.
static ssize_t read_all(int file, char *bytes, size_t wanted)
{
	size_t done = 0;
	while (done < wanted) {
		ssize_t got = read(file, bytes + done, wanted - done);
		if (got < 0 && errno != EINTR)
			return -1;
		if (got == 0)
			break;
		done += got > 0 ? (size_t)got : 0;
	}
	return (ssize_t)done;
}

static cau_status load(int file, const char *path, void **bytes, size_t *byte_count,
                       cau_error *error)
{
	struct stat about;
	if (fstat(file, &about))
		return cau_fail(error, CAU_IO, NULL, "cannot read '%.180s': %s", path, strerror(errno));
	if (!S_ISREG(about.st_mode))
		return cau_fail(error, CAU_IO, NULL, "'%.180s' is not a regular file", path);
	if (about.st_size > most_bytes)
		return cau_fail(error, CAU_LIMIT, NULL, "'%.180s' has %lld bytes, at most %lld are read",
		                path, (long long)about.st_size, most_bytes);

	size_t wanted = (size_t)about.st_size;
	char *loaded = cau_mesh_array(wanted, 1);
	if (!loaded)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu bytes", wanted);
	ssize_t got = read_all(file, loaded, wanted);
	if (got < 0) {
		free(loaded);
		return cau_fail(error, CAU_IO, NULL, "cannot read '%.180s': %s", path, strerror(errno));
	}
	*bytes = loaded;
	*byte_count = (size_t)got;
	return CAU_OK;
}

static cau_status load_one(const char *path, void **bytes, size_t *byte_count, cau_error *error)
{
	// Without O_NONBLOCK, open would wait for the writer of a pipe.
	int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (file < 0)
		return cau_fail(error, CAU_IO, NULL, "cannot open '%.180s': %s", path, strerror(errno));
	cau_status status = load(file, path, bytes, byte_count, error);
	close(file);
	return status;
}

// Finds the second file of a TetGen mesh, which has points and elements in two files of one name.
// Returns false if `path` is no TetGen file, or if there is no second file.
static bool find_partner(const char *path, char partner[static PATH_BYTES], bool *points)
{
	static const char *const pairs[][2] = {
		{".node", ".ele"}, {".node", ".face"}, {".ele", ".node"}, {".face", ".node"}};
	size_t length = strlen(path);
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		size_t ending = strlen(pairs[i][0]);
		if (length < ending || strcasecmp(path + length - ending, pairs[i][0]) != 0)
			continue;
		int written =
			snprintf(partner, PATH_BYTES, "%.*s%s", (int)(length - ending), path, pairs[i][1]);
		*points = strcasecmp(pairs[i][0], ".node") == 0;
		if (written > 0 && written < PATH_BYTES && access(partner, R_OK) == 0)
			return true;
	}
	return false;
}

// Joins the two byte arrays with a line feed between them. Frees both.
static cau_status join(char *first, size_t first_count, char *second, size_t second_count,
                       void **bytes, size_t *byte_count, cau_error *error)
{
	char *joined = cau_mesh_array(first_count + 1 + second_count, 1);
	if (joined) {
		memcpy(joined, first, first_count);
		joined[first_count] = '\n';
		memcpy(joined + first_count + 1, second, second_count);
		*bytes = joined;
		*byte_count = first_count + 1 + second_count;
	}
	free(first);
	free(second);
	return joined ? CAU_OK : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for two files");
}

cau_status cau_mesh_file_load(const char *path, void **bytes, size_t *byte_count, cau_error *error)
{
	CAU_ASSERT(path[0] != 0, "a file without a name, for %p", (void *)bytes);
	char partner[PATH_BYTES];
	bool points = false;
	cau_status status = load_one(path, bytes, byte_count, error);
	if (status || !find_partner(path, partner, &points))
		return status;
	void *other = NULL;
	size_t other_count = 0;
	status = load_one(partner, &other, &other_count, error);
	if (status) {
		free(*bytes);
		*bytes = NULL;
		return status;
	}
	if (points)
		return join(*bytes, *byte_count, other, other_count, bytes, byte_count, error);
	return join(other, other_count, *bytes, *byte_count, bytes, byte_count, error);
}

// ---- the format
enum {
	LOOKED_AT_BYTES = 65536, // bytes at the start of a text from which its format must be clear
	STL_HEADER_BYTES = 84,
	STL_FACET_BYTES = 50,
};

typedef struct file_format {
	cau_status (*read)(cau_mesh_builder *builder);
	const char *name;    // name of a format that is read
	const char *refusal; // otherwise: why the format is not read, and what to do
	bool text;           // a byte order mark may come first
} file_format;

typedef struct start {
	const char *bytes;
	size_t byte_count;
	file_format format;
} start;

#define STARTS(text) text, sizeof text - 1
static const start starts[] = {
	{STARTS("$"), {cau_mesh_read_gmsh, "Gmsh", NULL, true}},
	{STARTS("# vtk DataFile"), {cau_mesh_read_vtk, "VTK", NULL, true}},
	{STARTS("<?xml"), {cau_mesh_read_vtu, "VTK XML", NULL, true}},
	{STARTS("<VTKFile"), {cau_mesh_read_vtu, "VTK XML", NULL, true}},
	{STARTS("ply\n"), {cau_mesh_read_ply, "PLY", NULL, true}},
	{STARTS("ply\r"), {cau_mesh_read_ply, "PLY", NULL, true}},
	{STARTS("MeshVersionFormatted"), {cau_mesh_read_medit, "Medit", NULL, true}},
	{STARTS("\1\0\0\0"), {cau_mesh_read_meshb, "Medit binary", NULL, false}},
	{STARTS("\0\0\0\1"), {cau_mesh_read_meshb, "Medit binary", NULL, false}},
	{STARTS("#usda"), {cau_mesh_read_usda, "USD", NULL, true}},
	{STARTS("PXR-USDC"), {NULL, NULL, "binary USD: convert it with usdcat -o FILE.usda", false}},
	{STARTS("PK\3\4"), {NULL, NULL, "a zip archive (USDZ, 3MF): unpack it first", false}},
	{STARTS("\x1f\x8b"), {NULL, NULL, "compressed with gzip: unpack it first", false}},
	{STARTS("NRRD"),
     {NULL, NULL, "a volume of voxels (NRRD): make tetrahedra of it with cautery-mesh", false}},
	{STARTS("ObjectType"),
     {NULL, NULL, "a MetaImage: save the segmentation as NRRD or NIfTI", true}},
	{STARTS("NDims"), {NULL, NULL, "a MetaImage: save the segmentation as NRRD or NIfTI", true}},
	{STARTS("\x89HDF"), {NULL, NULL, "HDF5: save the mesh as VTU or Gmsh", false}},
	{STARTS("glTF"), {NULL, NULL, "glTF: save the mesh as PLY or OBJ", false}},
	{STARTS("ISO-10303-21"), {NULL, NULL, "STEP: mesh it first, as with gmsh -3", false}},
	{STARTS("solid"), {cau_mesh_read_stl, "STL", NULL, true}},
	{STARTS("OFF"), {NULL, NULL, "OFF: save the mesh as PLY or OBJ", true}},
	{STARTS("\xff\xfe"), {NULL, NULL, "text in UTF-16: save it as UTF-8", false}},
	{STARTS("\xfe\xff"), {NULL, NULL, "text in UTF-16: save it as UTF-8", false}},
};
static const file_format stl_binary = {cau_mesh_read_stl_binary, "STL binary", NULL, false};
static const file_format obj = {cau_mesh_read_obj, "OBJ", NULL, true};
static const file_format tetgen = {cau_mesh_read_tetgen, "TetGen", NULL, true};
static const file_format medit = {cau_mesh_read_medit, "Medit", NULL, true};
static const file_format gmsh = {cau_mesh_read_gmsh, "Gmsh", NULL, true};
static const file_format nifti = {
	NULL, NULL, "a volume of voxels (NIfTI): make tetrahedra of it with cautery-mesh", false};
static const file_format dicom = {
	NULL, NULL, "a DICOM image: segment it, and save the segmentation as NRRD or NIfTI", false};

// Whether a file is a binary STL. Such a file may begin with any text, so its length decides.
// `more`: bytes may follow the facets if the header cannot be text.
static bool is_binary_stl(const unsigned char *bytes, size_t byte_count, bool more)
{
	if (byte_count < STL_HEADER_BYTES)
		return false;
	uint64_t facets = 0;
	for (int i = 3; i >= 0; i--)
		facets = facets << 8 | bytes[80 + i];
	uint64_t whole = STL_HEADER_BYTES + STL_FACET_BYTES * facets;
	return facets && (byte_count == whole ||
	                  (more && byte_count > whole && memchr(bytes, 0, STL_HEADER_BYTES)));
}

// Returns the format that the first bytes identify, or NULL.
static const file_format *format_of_start(const unsigned char *bytes, size_t byte_count)
{
	size_t blank = 0; // white space before the first word of a text
	while (blank < byte_count && (bytes[blank] == ' ' || (bytes[blank] >= 9 && bytes[blank] <= 13)))
		blank++;
	for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
		size_t from = starts[i].format.text ? blank : 0;
		const char *at = (const char *)bytes + from;
		bool is_this =
			byte_count - from >= starts[i].byte_count &&
			(starts[i].format.text ? !strncasecmp(at, starts[i].bytes, starts[i].byte_count)
		                           : !memcmp(at, starts[i].bytes, starts[i].byte_count));
		if (is_this)
			return &starts[i].format;
	}
	return NULL;
}

static bool is_text(const unsigned char *bytes, size_t byte_count)
{
	return !memchr(bytes, 0, byte_count < LOOKED_AT_BYTES ? byte_count : LOOKED_AT_BYTES);
}

// Returns the format of a text. An OBJ file has a line with one of its keywords. A TetGen file
// begins with numbers.
static const file_format *format_of_text(const unsigned char *bytes, size_t byte_count)
{
	static const char *const keywords[] = {"v", "vn", "vt", "f", "mtllib", "usemtl", "o", "g", "s"};
	cau_scan scan =
		cau_scan_make(bytes, byte_count < LOOKED_AT_BYTES ? byte_count : LOOKED_AT_BYTES, NULL);
	for (; cau_scan_left(&scan); cau_scan_skip_line(&scan)) {
		cau_word word = cau_scan_word_of_line(&scan);
		if (!word.length || word.text[0] == '#')
			continue;
		for (size_t k = 0; k < sizeof keywords / sizeof *keywords; k++)
			if (cau_word_is(word, keywords[k]))
				return &obj;
		if (cau_word_is(word, "MeshVersionFormatted"))
			return &medit;
		if (word.text[0] == '$')
			return &gmsh;
		return word.text[0] >= '0' && word.text[0] <= '9' ? &tetgen : NULL;
	}
	return NULL;
}

// Returns the format, or NULL if none is known. `bytes` must begin after any byte order mark.
static const file_format *format_of(const unsigned char *bytes, size_t byte_count)
{
	CAU_ASSERT(bytes || !byte_count, "%zu bytes that are nowhere", byte_count);
	if (is_binary_stl(bytes, byte_count, false))
		return &stl_binary;
	const file_format *told = format_of_start(bytes, byte_count);
	if (told && told->read != cau_mesh_read_stl)
		return told;
	if (is_binary_stl(bytes, byte_count, true))
		return &stl_binary;
	if (told)
		return told;
	if (byte_count > 348 && (!memcmp(bytes + 344, "n+1", 4) || !memcmp(bytes + 344, "ni1", 4)))
		return &nifti;
	if (byte_count > 132 && !memcmp(bytes + 128, "DICM", 4))
		return &dicom;
	return is_text(bytes, byte_count) ? format_of_text(bytes, byte_count) : NULL;
}

// ---- the mesh
// Copies the mesh into arrays without spare capacity. Readers grow their arrays in larger steps.
static cau_status copy_tight(const cau_mesh *from, cau_mesh *mesh, cau_error *error)
{
	CAU_ASSERT(from->vertex_count >= 0 && from->triangle_count >= 0 && from->tetrahedron_count >= 0,
	           "%d vertices, %d triangles, %d tetrahedra", from->vertex_count, from->triangle_count,
	           from->tetrahedron_count);
	cau_status status = cau_mesh_reserve(mesh, from->vertex_count, from->triangle_count,
	                                     from->tetrahedron_count, from->texture != NULL, error);
	if (status)
		return status;
	size_t triangles = (size_t)from->triangle_count, tetrahedra = (size_t)from->tetrahedron_count;
	memcpy(mesh->position, from->position, 3 * (size_t)from->vertex_count * sizeof(double));
	if (triangles) {
		memcpy(mesh->triangle, from->triangle, 3 * triangles * sizeof(int32_t));
		memcpy(mesh->triangle_region, from->triangle_region, triangles * sizeof(int32_t));
	}
	if (triangles && from->texture)
		memcpy(mesh->texture, from->texture, 6 * triangles * sizeof(double));
	if (tetrahedra) {
		memcpy(mesh->tetrahedron, from->tetrahedron, 4 * tetrahedra * sizeof(int32_t));
		memcpy(mesh->tetrahedron_region, from->tetrahedron_region, tetrahedra * sizeof(int32_t));
	}
	return CAU_OK;
}

static cau_status refuse_format(const char *name, const file_format *format, cau_error *error)
{
	if (format)
		return cau_fail(error, CAU_UNSUPPORTED, NULL, "'%.80s' is %s", name, format->refusal);
	return cau_fail(error, CAU_UNSUPPORTED, NULL,
	                "'%.80s' has none of the supported formats: Gmsh, VTK, VTU, OBJ, STL, PLY, "
	                "Medit, TetGen, USD (.usda), and segmentations in NRRD or NIfTI",
	                name);
}

// Replaces carriage returns by line feeds in a text that has no line feeds. Returns a copy that the
// caller frees. Returns NULL if no copy is needed, or if memory ran out. In the latter case the
// text has one line only and is refused.
static unsigned char *with_line_feeds(const unsigned char *bytes, size_t byte_count)
{
	if (memchr(bytes, '\n', byte_count) || !memchr(bytes, '\r', byte_count))
		return NULL;
	unsigned char *copy = malloc(byte_count);
	for (size_t i = 0; copy && i < byte_count; i++)
		copy[i] = bytes[i] == '\r' ? '\n' : bytes[i];
	return copy;
}

// Splits the cells. If there are neither triangles nor tetrahedra, fails with a list of what the
// file contains instead.
static cau_status end_reading(cau_mesh_builder *builder)
{
	cau_mesh_report *report = &builder->report;
	report->vertices_read = builder->mesh.vertex_count;
	cau_cell_split(builder);
	if (builder->scan->status || builder->mesh.triangle_count || builder->mesh.tetrahedron_count)
		return builder->scan->status;
	char found[160];
	size_t length =
		(size_t)snprintf(found, sizeof found, "%d vertices", builder->mesh.vertex_count);
	for (int32_t i = 0; i < report->kind_count && length < sizeof found; i++) {
		long long count = report->kind[i].passed;
		count += report->kind[i].read;
		if (count)
			length += (size_t)snprintf(found + length, sizeof found - length, ", %lld %s", count,
			                           report->kind[i].name);
	}
	cau_scan_fail(builder->scan, CAU_BAD_MESH,
	              "no surface and no volume elements in this file, but %s", found);
	return builder->scan->status;
}

static cau_status read_as(const file_format *format, const unsigned char *bytes, size_t byte_count,
                          cau_mesh *mesh, cau_mesh_report *report, cau_error *error)
{
	unsigned char *copy = format->text ? with_line_feeds(bytes, byte_count) : NULL;
	cau_scan scan = cau_scan_make(copy ? copy : bytes, byte_count, error);
	cau_mesh_builder builder = {.scan = &scan};
	snprintf(builder.report.format, sizeof builder.report.format, "%s", format->name);
	cau_status status = format->read(&builder);
	if (!status)
		status = end_reading(&builder);
	if (!status)
		status = copy_tight(&builder.mesh, mesh, error);
	if (!status)
		cau_mesh_report_regions(&builder, &builder.report);
	if (report)
		*report = builder.report;
	cau_mesh_builder_finish(&builder);
	free(copy);
	return status;
}

cau_status cau_mesh_read(const char *name, const void *bytes, size_t byte_count, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error)
{
	CAU_ASSERT(bytes || !byte_count, "%zu bytes that are nowhere", byte_count);
	static const unsigned char byte_order_mark[] = {0xef, 0xbb, 0xbf};
	const unsigned char *from = bytes;
	*mesh = (cau_mesh){0};
	if (byte_count >= sizeof byte_order_mark &&
	    !memcmp(from, byte_order_mark, sizeof byte_order_mark)) {
		from += sizeof byte_order_mark;
		byte_count -= sizeof byte_order_mark;
	}
	if (!byte_count)
		return cau_fail(error, CAU_BAD_SYNTAX, NULL, "'%.80s' is empty", name);
	const file_format *format = format_of(from, byte_count);
	if (!format || !format->read)
		return refuse_format(name, format, error);
	return read_as(format, from, byte_count, mesh, report, error);
}
