// SPDX-License-Identifier: GPL-3.0-or-later
// foxglove.SceneUpdate in JSON Schema, from the npm package @foxglove/schemas. The descriptions are
// left out, so it has 10 KB instead of 21. tests/browser/page/mcap.test.ts compares it with the
// package.
#include "cautery/mcap.h"

#include <stddef.h>

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
