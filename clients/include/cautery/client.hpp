// SPDX-License-Identifier: Apache-2.0
// client.h for C++17: a loop and a client are destroyed with their scope, and a failure is an
// exception.
//
//     #include "cautery/client.hpp"
//
//     // Shows a session until it ends.
//     static void watch(const char *url, const std::string &session)
//     {
//         cautery::loop loop;
//         cau_client_def def = cau_default_client_def();
//         def.url = url;
//         cautery::client client(loop, def);
//         client.connect();
//         const cau_client_stream &stream = client.join(session);
//         while (!stream.ended) {
//             loop.wait(0.1); // everything happens in here
//             if (stream.state->synced)
//                 std::printf("tick %llu\n", static_cast<unsigned long long>(stream.state->tick));
//         }
//     }
//
// This header has what most programs need. All functions of client.h accept the pointers that
// client::get and loop::get return. The rules of client.h for threads and callbacks apply. A loop
// must outlive its clients.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "cautery/client.h"

namespace cautery
{

// The exception for a failed call. what() is the reason. `told` also has the path and the status.
class error : public std::runtime_error
{
  public:
	explicit error(const cau_error &why) : std::runtime_error(why.reason), told(why) {}
	cau_error told;
};

// Throws unless the status is CAU_OK.
inline void check(cau_status status, cau_error &why)
{
	if (status == CAU_OK)
		return;
	why.status = status;
	throw error(why);
}

// Copies a text into an array of a message. A text that is too long is an error.
template <std::size_t bytes> void put(char (&to)[bytes], const std::string &text)
{
	cau_error why = {};
	if (text.size() >= bytes)
		check(cau_fail(&why, CAU_LIMIT, "", "a text of %zu bytes, of %zu at most", text.size(),
		               bytes - 1),
		      why);
	to[text.copy(to, bytes - 1)] = 0;
}

class loop
{
  public:
	loop()
	{
		cau_error why = {};
		cau_loop *made = nullptr;
		check(cau_loop_create(&made, &why), why);
		owned.reset(made);
	}
	void wait(double seconds) { cau_loop_wait(owned.get(), seconds); }
	cau_loop *get() const { return owned.get(); }

  private:
	struct destroy {
		void operator()(cau_loop *of) const { cau_loop_destroy(of); }
	};
	std::unique_ptr<cau_loop, destroy> owned;
};

class client
{
  public:
	client(const loop &on, const cau_client_def &def)
	{
		cau_error why = {};
		cau_client *made = nullptr;
		check(cau_client_create(on.get(), &def, &made, &why), why);
		owned.reset(made);
	}
	// Connects, and waits for the answer to hello.
	void connect()
	{
		cau_error why = {};
		check(cau_client_connect(owned.get(), &why), why);
	}
	// Sends a request and waits. `result` is the method's C type, or nullptr.
	void call(cau_method method, const void *params, void *result = nullptr)
	{
		cau_error why = {};
		check(cau_client_call(owned.get(), method, params, result, &why), why);
	}
	// Sends a command and waits for the result. `session` is "" if the URL names the session.
	cau_wire_command_result command(const std::string &session, const cau_command &what)
	{
		cau_error why = {};
		cau_wire_command_result result = {};
		check(cau_client_command(owned.get(), session.empty() ? nullptr : session.c_str(), &what,
		                         &result, &why),
		      why);
		return result;
	}
	// Asks for frames and waits for the first key frame. The stream is valid as long as the client
	// exists.
	const cau_client_stream &join(const std::string &session)
	{
		cau_error why = {};
		cau_wire_session_join params = {};
		cau_client_stream *stream = nullptr;
		params.has_session = !session.empty();
		put(params.session, session);
		check(cau_client_join(owned.get(), &params, &stream, &why), why);
		return *stream;
	}
	// Sends the queued messages and closes the connection. Without this call the destructor drops
	// the connection.
	void close() { cau_client_close(owned.get()); }
	cau_client *get() const { return owned.get(); }

  private:
	struct destroy {
		void operator()(cau_client *of) const { cau_client_destroy(of); }
	};
	std::unique_ptr<cau_client, destroy> owned;
};

} // namespace cautery
