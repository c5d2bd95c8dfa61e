// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a stream's newest state as foxglove.SceneUpdate in JSON. The schema of these messages is
// at the end.
#include "cautery/recording.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

// Sizes of the shape that is drawn for an instrument. The stream has the instrument's pose, not its
// sizes.
static const double shaft_m = 0.06, shaft_diameter_m = 0.002, tip_diameter_m = 0.0015;

enum { LAYER_COLORS = 4, LAYERS_MAX = 256 };

// Colours by the index of the layer, in the usual order: pearly fascia, a pink membrane, fat. All
// further layers have the last colour, that of the tissue under the fat.
static const char *const layer_color[LAYER_COLORS] = {
	"{\"r\":0.9,\"g\":0.82,\"b\":0.76,\"a\":1}",
	"{\"r\":0.85,\"g\":0.58,\"b\":0.5,\"a\":1}",
	"{\"r\":0.93,\"g\":0.77,\"b\":0.4,\"a\":1}",
	"{\"r\":0.7,\"g\":0.35,\"b\":0.32,\"a\":1}",
};
static const char steel[] = "{\"r\":0.7,\"g\":0.72,\"b\":0.75,\"a\":1}";
static const char glowing[] = "{\"r\":1,\"g\":0.35,\"b\":0.1,\"a\":1}";
static const char at_origin[] =
	"{\"position\":{\"x\":0,\"y\":0,\"z\":0},\"orientation\":{\"x\":0,\"y\":0,\"z\":0,\"w\":1}}";

static void write_time(FILE *out, uint64_t time_ns)
{
	fprintf(out, "\"timestamp\":{\"sec\":%llu,\"nsec\":%llu}",
	        (unsigned long long)(time_ns / 1000000000), (unsigned long long)(time_ns % 1000000000));
}

// Writes the beginning of an entity. The caller writes the lists of shapes that it has.
static void open_entity(FILE *out, const char *id, const cau_stream_state *state, uint64_t time_ns)
{
	fputc('{', out);
	write_time(out, time_ns);
	fprintf(out,
	        ",\"frame_id\":\"session\",\"id\":\"%s\",\"lifetime\":{\"sec\":0,\"nsec\":0},"
	        "\"frame_locked\":false,\"metadata\":[{\"key\":\"tick\",\"value\":\"%llu\"},"
	        "{\"key\":\"time_s\",\"value\":\"%.9g\"}],"
	        "\"arrows\":[],\"cubes\":[],\"lines\":[],\"texts\":[],\"models\":[],",
	        id, (unsigned long long)state->tick, state->time_s);
}

// ---- tissue ------------------------------------------------------------------------------------
static bool drawn(const cau_client_stream *stream, int32_t face, int layer)
{
	return stream->topology.face_layer[face] == layer &&
	       !(stream->state->face_mask[face / 32] >> face % 32 & 1);
}

static void write_point(FILE *out, const cau_client_stream *stream, int32_t vertex)
{
	const cau_stream_def *d = &stream->def;
	const int32_t *q = stream->state->quantised + 3 * vertex;
	fprintf(out, "{\"x\":%.7g,\"y\":%.7g,\"z\":%.7g}", d->origin_m[0] + d->step_m * q[0],
	        d->origin_m[1] + d->step_m * q[1], d->origin_m[2] + d->step_m * q[2]);
}

// Writes the points of a layer's drawn faces and returns their number. `place` (vertex_count) is -1
// before the call. Afterwards it has the index in the list, or -1 for vertices that are not listed.
static int32_t write_points(FILE *out, const cau_client_stream *stream, int layer, int32_t *place)
{
	int32_t count = 0;
	for (int32_t face = 0; face < stream->def.face_count; face++) {
		if (!drawn(stream, face, layer))
			continue;
		for (int c = 0; c < 3; c++) {
			int32_t vertex = stream->topology.face[3 * face + c];
			if (place[vertex] >= 0)
				continue;
			if (count > 0)
				fputc(',', out);
			place[vertex] = count++;
			write_point(out, stream, vertex);
		}
	}
	return count;
}

static void write_indices(FILE *out, const cau_client_stream *stream, int layer,
                          const int32_t *place)
{
	bool first = true;
	for (int32_t face = 0; face < stream->def.face_count; face++) {
		if (!drawn(stream, face, layer))
			continue;
		const int32_t *vertex = stream->topology.face + 3 * (size_t)face;
		fprintf(out, "%s%d,%d,%d", first ? "" : ",", place[vertex[0]], place[vertex[1]],
		        place[vertex[2]]);
		first = false;
	}
}

static cau_status write_tissue(FILE *out, const cau_client_stream *stream, cau_error *error)
{
	size_t place_bytes = (size_t)stream->def.vertex_count * sizeof(int32_t);
	int32_t *place = malloc(place_bytes + 1);
	bool has[LAYERS_MAX] = {false}, first = true;
	if (!place)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the tissue's points");
	for (int32_t face = 0; face < stream->def.face_count; face++)
		has[stream->topology.face_layer[face]] = true;
	fputs("\"spheres\":[],\"cylinders\":[],\"triangles\":[", out);
	for (int layer = 0; layer < LAYERS_MAX; layer++) {
		if (!has[layer])
			continue;
		memset(place, 0xff, place_bytes);
		fprintf(out, "%s{\"pose\":%s,\"points\":[", first ? "" : ",", at_origin);
		write_points(out, stream, layer, place);
		fprintf(out, "],\"color\":%s,\"colors\":[],\"indices\":[",
		        layer_color[layer < LAYER_COLORS ? layer : LAYER_COLORS - 1]);
		write_indices(out, stream, layer, place);
		fputs("]}", out);
		first = false;
	}
	fputs("]}", out);
	free(place);
	return CAU_OK;
}

// ---- tools -------------------------------------------------------------------------------------
// Writes the pose of a point on the shaft's axis, which is the tool's third axis.
static void write_pose(FILE *out, const cau_pose *pose, double along_m)
{
	const double *q = pose->rotation, *p = pose->position_m; // w, x, y, z
	double axis[3] = {2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]),
	                  1 - 2 * (q[1] * q[1] + q[2] * q[2])};
	fprintf(out,
	        "\"pose\":{\"position\":{\"x\":%.7g,\"y\":%.7g,\"z\":%.7g},"
	        "\"orientation\":{\"x\":%.7g,\"y\":%.7g,\"z\":%.7g,\"w\":%.7g}}",
	        p[0] + along_m * axis[0], p[1] + along_m * axis[1], p[2] + along_m * axis[2], q[1],
	        q[2], q[3], q[0]);
}

static void write_size(FILE *out, double across_m, double along_m)
{
	fprintf(out, ",\"size\":{\"x\":%g,\"y\":%g,\"z\":%g}", across_m, across_m, along_m);
}

static void write_tool(FILE *out, const cau_stream_tool *tool)
{
	fputs("\"triangles\":[],\"spheres\":[{", out);
	write_pose(out, &tool->pose, 0);
	write_size(out, tip_diameter_m, tip_diameter_m);
	fprintf(out, ",\"color\":%s}],\"cylinders\":[{", tool->energized ? glowing : steel);
	write_pose(out, &tool->pose, tip_diameter_m / 2 + shaft_m / 2);
	write_size(out, shaft_diameter_m, shaft_m);
	fprintf(out, ",\"bottom_scale\":1,\"top_scale\":1,\"color\":%s}]}", steel);
}

cau_status cli_scene_update_write(FILE *out, const cau_client_stream *stream, uint64_t time_ns,
                                  cau_error *error)
{
	const cau_stream_state *state = stream->state;
	char id[CAU_NAME_BYTES + 8];
	CAU_ASSERT(state->synced && state->face_mask && stream->has_topology, "%s is incomplete",
	           stream->description.session);
	// Each message has the whole scene, so that a reader can begin at any message.
	fputs("{\"deletions\":[{", out);
	write_time(out, time_ns);
	fputs(",\"type\":1,\"id\":\"\"}],\"entities\":[", out);
	open_entity(out, "tissue", state, time_ns);
	cau_status status = write_tissue(out, stream, error);
	for (int32_t i = 0; i < state->tool_count && !status; i++) {
		snprintf(id, sizeof id, "tool %s", state->tools[i].name);
		fputc(',', out);
		open_entity(out, id, state, time_ns);
		write_tool(out, &state->tools[i]);
	}
	fputs("]}", out);
	return status;
}

// ---- schema ------------------------------------------------------------------------------------
// foxglove.SceneUpdate in JSON Schema, from the npm package @foxglove/schemas. The descriptions are
// left out, so it has 10 KB instead of 21. tests/browser/page/mcap.test.ts compares it with the
// package.
#define NUMBER(name) "\"" name "\":{\"type\":\"number\"}"
#define TEXT(name) "\"" name "\":{\"type\":\"string\"}"
#define BOOL(name) "\"" name "\":{\"type\":\"boolean\"}"
#define OBJECT(title, properties, required)                                                        \
	"{\"title\":\"foxglove." title "\",\"type\":\"object\",\"properties\":{" properties            \
	"},\"required\":[" required "]}"
#define LIST(name, item) "\"" name "\":{\"type\":\"array\",\"items\":" item "}"

#define NANOSECONDS "\"nsec\":{\"type\":\"integer\",\"minimum\":0,\"maximum\":999999999}"
#define TIME                                                                                       \
	"\"timestamp\":{\"type\":\"object\",\"title\":\"time\",\"properties\":{"                       \
	"\"sec\":{\"type\":\"integer\",\"minimum\":0}," NANOSECONDS "}}"
#define DURATION                                                                                   \
	"\"lifetime\":{\"type\":\"object\",\"title\":\"duration\",\"properties\":{"                    \
	"\"sec\":{\"type\":\"integer\"}," NANOSECONDS "}}"
#define THREE NUMBER("x") "," NUMBER("y") "," NUMBER("z")
#define VECTOR(title) OBJECT(title, THREE, "\"x\",\"y\",\"z\"")
#define POSE                                                                                       \
	"\"pose\":" OBJECT("Pose",                                                                     \
	                   "\"position\":" VECTOR("Vector3") ",\"orientation\":" OBJECT(               \
						   "Quaternion", THREE "," NUMBER("w"), "\"x\",\"y\",\"z\",\"w\""),        \
	                   "\"position\",\"orientation\"")
#define COLOR_VALUE                                                                                \
	OBJECT("Color", NUMBER("r") "," NUMBER("g") "," NUMBER("b") "," NUMBER("a"),                   \
	       "\"r\",\"g\",\"b\",\"a\"")
#define COLOR "\"color\":" COLOR_VALUE
#define COLORS LIST("colors", COLOR_VALUE)
#define POINTS LIST("points", VECTOR("Point3"))
#define INDICES LIST("indices", "{\"type\":\"integer\",\"minimum\":0}")
#define SIZE "\"size\":" VECTOR("Vector3")

const char *const cli_mcap_schema[] = {
	"{\"title\":\"foxglove.SceneUpdate\",\"type\":\"object\",\"properties\":{",
	LIST("deletions", OBJECT("SceneEntityDeletion",
                             TIME ",\"type\":{\"title\":\"foxglove.SceneEntityDeletionType\","
                                  "\"oneOf\":[{\"title\":\"MATCHING_ID\",\"const\":0},"
                                  "{\"title\":\"ALL\",\"const\":1}]}," TEXT("id"),
                             "\"timestamp\",\"type\",\"id\"")),
	",\"entities\":{\"type\":\"array\",\"items\":{\"title\":\"foxglove.SceneEntity\","
	"\"type\":\"object\",\"properties\":{",
	TIME "," TEXT("frame_id") "," TEXT("id") "," DURATION "," BOOL("frame_locked") ",",
	LIST("metadata",
         OBJECT("KeyValuePair", TEXT("key") "," TEXT("value"), "\"key\",\"value\"")) ",",
	LIST("arrows", OBJECT("ArrowPrimitive",
                          POSE "," NUMBER("shaft_length") "," NUMBER("shaft_diameter") "," NUMBER(
							  "head_length") "," NUMBER("head_diameter") "," COLOR,
                          "\"pose\",\"shaft_length\",\"shaft_diameter\",\"head_length\","
                          "\"head_diameter\",\"color\"")) ",",
	LIST("cubes",
         OBJECT("CubePrimitive", POSE "," SIZE "," COLOR, "\"pose\",\"size\",\"color\"")) ",",
	LIST("spheres",
         OBJECT("SpherePrimitive", POSE "," SIZE "," COLOR, "\"pose\",\"size\",\"color\"")) ",",
	LIST("cylinders",
         OBJECT("CylinderPrimitive",
                POSE "," SIZE "," NUMBER("bottom_scale") "," NUMBER("top_scale") "," COLOR,
                "\"pose\",\"size\",\"bottom_scale\",\"top_scale\",\"color\"")) ",",
	LIST("lines", OBJECT("LinePrimitive",
                         "\"type\":{\"title\":\"foxglove.LineType\",\"oneOf\":["
                         "{\"title\":\"LINE_STRIP\",\"const\":0},"
                         "{\"title\":\"LINE_LOOP\",\"const\":1},"
                         "{\"title\":\"LINE_LIST\",\"const\":2}]}," POSE
                         "," NUMBER("thickness") "," BOOL("scale_invariant") "," POINTS "," COLOR
                                                                             "," COLORS "," INDICES,
                         "\"type\",\"pose\",\"thickness\",\"scale_invariant\",\"points\","
                         "\"color\",\"colors\",\"indices\"")) ",",
	LIST("triangles",
         OBJECT("TriangleListPrimitive", POSE "," POINTS "," COLOR "," COLORS "," INDICES,
                "\"pose\",\"points\",\"color\",\"colors\",\"indices\"")) ",",
	LIST("texts", OBJECT("TextPrimitive",
                         POSE "," BOOL("billboard") "," NUMBER("font_size") "," BOOL(
							 "scale_invariant") "," COLOR "," TEXT("text"),
                         "\"pose\",\"billboard\",\"font_size\",\"scale_invariant\",\"color\","
                         "\"text\"")) ",",
	LIST("models",
         OBJECT("ModelPrimitive",
                POSE ",\"scale\":" VECTOR("Vector3") "," COLOR "," BOOL("override_color") "," TEXT(
					"url") "," TEXT("media_type") ",\"data\":{\"type\":\"string\","
                                                  "\"contentEncoding\":\"base64\"}",
                "\"pose\",\"scale\",\"color\",\"override_color\",\"url\",\"media_type\","
                "\"data\"")),
	"},\"required\":[\"timestamp\",\"frame_id\",\"id\",\"lifetime\",\"frame_locked\","
	"\"metadata\",\"arrows\",\"cubes\",\"spheres\",\"cylinders\",\"lines\",\"triangles\","
	"\"texts\",\"models\"]}}},\"required\":[\"deletions\",\"entities\"]}",
	NULL,
};
