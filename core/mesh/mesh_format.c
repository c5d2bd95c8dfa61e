// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh_format.h"

#include <string.h>
#include <strings.h>

#include "cautery/assert.h"
#include "mesh/readers.h"

enum {
	LOOKED_AT_BYTES = 65536, // bytes at the start of a text from which its format must be clear
	STL_HEADER_BYTES = 84,
	STL_FACET_BYTES = 50,
};

typedef struct start {
	const char *bytes;
	size_t byte_count;
	cau_mesh_format format;
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
static const cau_mesh_format stl_binary = {cau_mesh_read_stl_binary, "STL binary", NULL, false};
static const cau_mesh_format obj = {cau_mesh_read_obj, "OBJ", NULL, true};
static const cau_mesh_format tetgen = {cau_mesh_read_tetgen, "TetGen", NULL, true};
static const cau_mesh_format medit = {cau_mesh_read_medit, "Medit", NULL, true};
static const cau_mesh_format gmsh = {cau_mesh_read_gmsh, "Gmsh", NULL, true};
static const cau_mesh_format nifti = {
	NULL, NULL, "a volume of voxels (NIfTI): make tetrahedra of it with cautery-mesh", false};
static const cau_mesh_format dicom = {
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
static const cau_mesh_format *format_of_start(const unsigned char *bytes, size_t byte_count)
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
static const cau_mesh_format *format_of_text(const unsigned char *bytes, size_t byte_count)
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

const cau_mesh_format *cau_mesh_format_of(const unsigned char *bytes, size_t byte_count)
{
	CAU_ASSERT(bytes || !byte_count, "%zu bytes that are nowhere", byte_count);
	if (is_binary_stl(bytes, byte_count, false))
		return &stl_binary;
	const cau_mesh_format *told = format_of_start(bytes, byte_count);
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
