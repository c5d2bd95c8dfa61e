// SPDX-License-Identifier: Apache-2.0
// Writes examples.md, the worked examples of the protocol. The codecs produce them, for a session
// with three vertices, one face and one tool.
#include <stdlib.h>
#include <string.h>

#include "cautery/chunk_codec.h"
#include "cautery/rpc.h"
#include "cautery/topology_codec.h"
#include "generate/model.h"

enum { ROW_BYTES = 16, VERTICES = 3, CAPACITY = 4096, ENCODER_BYTES = 1 << 15 };

static const uint64_t epoch = 0x0123456789abcdef;

static void check(cau_status status)
{
	if (status != CAU_OK)
		abort();
}

static void write_hex(FILE *out, const uint8_t *bytes, size_t count)
{
	fputs("\n```\n", out);
	for (size_t row = 0; row < count; row += ROW_BYTES) {
		fprintf(out, "%04zx ", row);
		for (size_t i = row; i < count && i < row + ROW_BYTES; i++)
			fprintf(out, " %02x", bytes[i]);
		fputc('\n', out);
	}
	fputs("```\n", out);
}

// ---- frames -------------------------------------------------------------------------------------

static cau_stream_def stream(void)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = 7;
	def.profile = 1;
	def.channels =
		CAU_CHANNEL_POSITIONS | CAU_CHANNEL_MASK | CAU_CHANNEL_EXPOSURE | CAU_CHANNEL_TOOLS;
	def.vertex_count = VERTICES;
	def.face_count = 1;
	return def;
}

static void encode(FILE *out, cau_frame_encoder *encoder, const cau_stream_sample *sample)
{
	uint8_t bytes[CAPACITY];
	size_t count;
	check(cau_frame_encode(encoder, sample, bytes, sizeof bytes, &count, NULL));
	write_hex(out, bytes, count);
}

static void write_frames(FILE *out)
{
	static _Alignas(16) uint8_t storage[ENCODER_BYTES];
	cau_stream_def def = stream();
	cau_frame_encoder *encoder;
	double position[3 * VERTICES] = {0.0, 0.0, 0.0, 0.001, 0.0, 0.0, 0.0, 0.001, -0.00005};
	float exposure[VERTICES] = {0.0f, 0.0f, 0.0f};
	uint32_t mask[1] = {0};
	cau_stream_tool tool = {
		.name = "hook",
		.shape = CAU_TOOL_HOOK,
		.pose = {.position_m = {0.5, 0.25, 0.0}, .rotation = {1.0, 0.0, 0.0, 0.0}},
		.tip_temperature_c = 37.0,
		.driver = 2,
		.energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
	cau_stream_sample sample = {.tick = 60,
	                            .time_s = 1.0,
	                            .published_us = 5000000,
	                            .position = position,
	                            .face_mask = mask,
	                            .exposure = exposure,
	                            .tool_count = 1,
	                            .tools = &tool};
	check(cau_frame_encoder_init(storage, sizeof storage, &def, epoch, &encoder, NULL));
	fputs(
		"\n## A key frame\n\nSession 7, profile 1, epoch 0123456789abcdef, tick 60. Steps of "
		"0.05 mm. "
		"Vertices at (0, 0, 0), (1, 0, 0) and (0, 1, -0.05) mm: (0, 0, 0), (20, 0, 0) and (0, "
		"20, -1) "
		"steps, written as differences to the vertex before: (0, 0, 0), (20, 0, 0), (-20, 20, -1). "
		"One tool, `hook`, driven by client 2.\n",
		out);
	encode(out, encoder, &sample);
	position[3] += 0.0002;
	exposure[2] = 1.0f;
	mask[0] = 1;
	sample.tick = 61;
	sample.time_s = 61.0 / 60.0;
	sample.published_us += 16667;
	tool.sequence = 12;
	tool.energized = true;
	tool.tip_temperature_c = 170.0;
	fputs("\n## The delta after it\n\nVertex 1 has moved by 0.2 mm (4 steps) in x, vertex 2 is "
	      "exposed to "
	      "the full (255, of width 2 because the difference does not fit a signed byte), face 0 is "
	      "no longer "
	      "drawn, the tool is energized and has applied command 12.\n",
	      out);
	encode(out, encoder, &sample);
}

static void write_topology(FILE *out)
{
	static _Alignas(16) uint8_t scratch[CAPACITY];
	uint8_t bytes[CAPACITY];
	size_t count;
	cau_stream_def def = stream();
	const int32_t face[] = {0, 1, 2};
	const uint8_t layer[] = {0};
	const double rest[3 * VERTICES] = {0.0, 0.0, 0.0, 0.001, 0.0, 0.0, 0.0, 0.001, 0.0};
	cau_topology topology = {.face = face, .face_layer = layer, .rest_position = rest};
	check(cau_topology_encode(&def, epoch, &topology, scratch, bytes, sizeof bytes, &count, NULL));
	fputs("\n## A topology frame\n\nOne face of vertices 0, 1, 2 in layer 0, without texture.\n",
	      out);
	write_hex(out, bytes, count);
}

static void write_chunk(FILE *out)
{
	static const uint8_t data[] = {'h', 'e', 'l', 'l', 'o'};
	uint8_t bytes[CAU_CHUNK_HEADER_BYTES + sizeof data];
	cau_chunk chunk = {.transfer = 3, .offset = 262144};
	cau_chunk_header_write(bytes, &chunk);
	memcpy(bytes + CAU_CHUNK_HEADER_BYTES, data, sizeof data);
	fputs("\n## A chunk\n\nTransfer 3, the second chunk, five bytes.\n", out);
	write_hex(out, bytes, sizeof bytes);
}

// ---- a dialogue ---------------------------------------------------------------------------------

static void say(FILE *out, const char *who, cau_status status, const cau_rpc_buffer *text)
{
	check(status);
	fprintf(out, "%s %s\n", who, text->buffer);
}

static cau_rpc_id id_of(int64_t number)
{
	return (cau_rpc_id){.kind = CAU_RPC_ID_NUMBER, .number = number};
}

static void answer(FILE *out, cau_rpc_buffer *to, int64_t number, cau_method method,
                   const void *result)
{
	cau_rpc_id id = id_of(number);
	say(out, "<", cau_rpc_write_result(to, &id, method, result, NULL), to);
}

static void say_hello(FILE *out, cau_rpc_buffer *to)
{
	cau_wire_hello hello = {
		.version = 1, .client = "example 1.0", .has_client_id = true, .client_id = "bench-3"};
	cau_wire_hello_result known = {.server = "cauteryd 0.1.0",
	                               .version = 1,
	                               .daemon = "d1",
	                               .role = CAU_ROLE_OPERATE,
	                               .client = 2,
	                               .client_id = "bench-3",
	                               .resume = "de159721b33b369d3c19a9f757294935",
	                               .capabilities = 1u << CAU_CAPABILITY_UPLOAD |
	                                               1u << CAU_CAPABILITY_EXPORT |
	                                               1u << CAU_CAPABILITY_STORE,
	                               .limits = {.message_bytes_max = 1048576,
	                                          .upload_bytes_max = 67108864,
	                                          .has_uploads_bytes_max = true,
	                                          .uploads_bytes_max = 134217728,
	                                          .chunk_bytes_max = 262144,
	                                          .sessions_max = 64,
	                                          .subscribers_max = 1024,
	                                          .profiles_max = 4,
	                                          .has_streams_max = true,
	                                          .streams_max = 8,
	                                          .tools_max = 8,
	                                          .requests_per_s_max = 2000,
	                                          .motions_per_s_max = 2000,
	                                          .bytes_in_flight_max = 196608,
	                                          .heartbeat_s = 0.25},
	                               .server_time_us = 4900000,
	                               .wall_time_s = 1795471587.5};
	say(out, ">", cau_rpc_write_request(to, 1, CAU_METHOD_HELLO, &hello, NULL), to);
	answer(out, to, 1, CAU_METHOD_HELLO, &known);
}

static void say_join(FILE *out, cau_rpc_buffer *to)
{
	cau_stream_def def = stream();
	cau_wire_session_join join = {
		.has_session = true, .session = "d1-demo", .has_rate_hz = true, .rate_hz = 30.0};
	cau_wire_stream_description granted = {.session = "d1-demo",
	                                       .session_number = def.session,
	                                       .profile = def.profile,
	                                       .epoch = epoch,
	                                       .rate_hz = 30.0,
	                                       .channels = def.channels,
	                                       .vertex_count = def.vertex_count,
	                                       .face_count = def.face_count,
	                                       .step_m = def.step_m,
	                                       .stress_step_pa = def.stress_step_pa,
	                                       .has_plain = true};
	say(out, ">", cau_rpc_write_request(to, 2, CAU_METHOD_SESSION_JOIN, &join, NULL), to);
	answer(out, to, 2, CAU_METHOD_SESSION_JOIN, &granted);
	fputs("< (binary) the topology frame of below, then a key frame\n", out);
}

static void say_take_over(FILE *out, cau_rpc_buffer *to)
{
	cau_wire_tool_ref hook = {.has_session = true, .session = "d1-demo", .tool = "hook"};
	cau_wire_driver driver = {.tool = "hook",
	                          .client = 2,
	                          .name = "example 1.0",
	                          .energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
	cau_wire_driver_changed changed = {.session = "d1-demo", .driver = driver};
	say(out, ">", cau_rpc_write_request(to, 3, CAU_METHOD_TOOL_TAKE_OVER, &hook, NULL), to);
	say(out, "<", cau_rpc_write_notification(to, CAU_METHOD_TOOL_DRIVER_CHANGED, &changed, NULL),
	    to);
	answer(out, to, 3, CAU_METHOD_TOOL_TAKE_OVER, &driver);
	fputs("< (binary) the key frame of below: client 2 drives the hook\n", out);
}

static void say_commands(FILE *out, cau_rpc_buffer *to)
{
	cau_rpc_envelope envelope = {true, "d1-demo", true, 1};
	cau_command energize = {.kind = CAU_COMMAND_TOOL_ENERGIZE, .sequence = 12, .tool = "hook"};
	energize.as.energized = 1;
	cau_command move = {.kind = CAU_COMMAND_TOOL_MOVE, .sequence = 13, .tool = "hook"};
	move.as.move.pose = (cau_pose){{0.01, 0.0, 0.002}, {1.0, 0.0, 0.0, 0.0}};
	cau_wire_command_result applied = {.tick = 61, .sequence = 12};
	int64_t number = 4;
	say(out, ">", cau_rpc_write_command(to, &number, &envelope, &energize, NULL), to);
	answer(out, to, number, CAU_METHOD_TOOL_ENERGIZE, &applied);
	fputs("< (binary) the delta of below: its energy is on\n", out);
	say(out, ">", cau_rpc_write_command(to, NULL, NULL, &move, NULL), to);
	fputs("> (again and again, at least every limits.heartbeat_s)\n", out);
	cau_wire_heartbeat alive = {.visible = true};
	say(out, ">", cau_rpc_write_notification(to, CAU_METHOD_HEARTBEAT, &alive, NULL), to);
}

// Writes a wrong request and its answer. The request is a literal, because the codec refuses to
// write it.
static void say_a_mistake(FILE *out, cau_rpc_buffer *to)
{
	cau_rpc_id id = id_of(5);
	cau_rpc_fault fault;
	cau_error error;
	fputs("> {\"jsonrpc\":\"2.0\",\"id\":5,\"method\":\"tool.move\",\"params\":{\"session\":"
	      "\"d1-demo\",\"tick\":0,\"sequence\":14,\"tool\":\"hook\",\"position_m\":[0.01,0,0.002],"
	      "\"rotation\":[7,0,0,0],\"jaw\":0}}\n",
	      out);
	cau_fail(&error, CAU_BAD_VALUE, "params.rotation[0]", "7 is outside -1.001 to 1.001");
	cau_rpc_fault_of_error(&fault, &error);
	say(out, "<", cau_rpc_write_error(to, &id, &fault, NULL), to);
}

static void write_dialogue(FILE *out)
{
	char text[CAPACITY];
	cau_rpc_buffer to = {text, sizeof text, 0};
	fputs("\n## A dialogue\n\n`>` client, `<` server: from the first message until a tool's energy "
	      "is on, and how "
	      "it stays so. A request is answered once, by its id, a notification (without one) never; "
	      "what the "
	      "server sends by itself, such as `tool.driver_changed` and `event`, comes between "
	      "answers in no "
	      "fixed order.\n\n```\n",
	      out);
	say_hello(out, &to);
	say_join(out, &to);
	say_take_over(out, &to);
	say_commands(out, &to);
	say_a_mistake(out, &to);
	fputs("```\n", out);
}

void write_examples(FILE *out)
{
	fputs(
		"# Examples\n\nGenerated by the codecs; build the target `messages` after a change there. "
		"The layouts are in [README.md](README.md).\n",
		out);
	write_dialogue(out);
	write_topology(out);
	write_frames(out);
	write_chunk(out);
}
