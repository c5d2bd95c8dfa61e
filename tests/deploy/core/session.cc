// SPDX-License-Identifier: GPL-3.0-or-later
// The core from C++ as a stranger would write it: the headers' functions have C linkage.
#include <cstdio>
#include <memory>

#include <cautery/embed.h>
#include <cautery/solid.h>

int main(int, char **arguments)
{
	cau_error error = {};
	cau_session *made = nullptr;
	if (cau_session_from_file(arguments[1], nullptr, &made, &error)) {
		std::fprintf(stderr, "%s\n", error.reason);
		return 1;
	}
	std::unique_ptr<cau_session, decltype(&cau_session_destroy)> session(made, cau_session_destroy);
	if (cau_solid_is_volume("no volume", 9) || cau_session_step(session.get(), &error))
		return 1;
	cau_session_info info;
	cau_frame frame;
	cau_session_describe(session.get(), &info);
	cau_session_frame(session.get(), &frame);
	std::printf("%d vertices, the first at %g\n", static_cast<int>(info.vertex_count),
	            frame.position[0]);
}
