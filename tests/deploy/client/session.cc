// SPDX-License-Identifier: GPL-3.0-or-later
// A C++ client as a stranger would write it: makes a session, steps it, and says what it sees. The
// second session has a name that the server refuses.
#include <cstdio>
#include <vector>

#include <cautery/client.hpp>

static std::string create(cautery::client &client, const char *name)
{
	std::vector<cau_wire_layer_description> layers(CAU_MAX_LAYERS);
	std::vector<cau_wire_driver> drivers(CAU_MAX_TOOLS);
	auto definition = std::make_unique<cau_scene_def>();
	cau_wire_session_create params = {};
	cau_wire_session_description made = {};
	params.has_scene = params.has_name = params.has_paused = params.paused = true;
	cautery::put(params.scene, "fascia");
	cautery::put(params.name, name);
	made.layers = {layers.data(), 0, CAU_MAX_LAYERS};
	made.drivers = {drivers.data(), 0, CAU_MAX_TOOLS};
	made.definition = definition.get();
	client.call(CAU_METHOD_SESSION_CREATE, &params, &made);
	return made.summary.session;
}

int main(int, char **arguments)
{
	cautery::loop loop;
	cau_client_def def = cau_default_client_def();
	def.url = arguments[1];
	cautery::client client(loop, def);
	client.connect();
	const cau_client_stream &stream = client.join(create(client, "knee"));
	std::printf("tick %d, %d vertices\n", static_cast<int>(stream.state->tick),
	            static_cast<int>(stream.def.vertex_count));
	try {
		create(client, "no name");
	} catch (const cautery::error &refused) {
		std::printf("refused: %s\n", refused.what());
	}
	client.close();
}
