// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes a session's frames. Key frames, deltas and topology frames come from three topics.
#pragma once

#include <cinttypes>
#include <deque>
#include <vector>

#include "cauteryPubSubTypes.h"
#include "frames.h"
#include "wire.hpp"

class Stream
{
  public:
	explicit Stream(Wire &wire)
	{
		fast::Subscriber *from = wire.session_subscriber;
		fast::DataReaderQos delta_qos = ros_reader_qos();
		delta_qos.history().depth = HELD;
		topology = checked(from->create_datareader(topic(wire, "topology"), kept_reader_qos(1)),
		                   "reader of topologies");
		key = checked(from->create_datareader(topic(wire, "key_frame"), kept_reader_qos(1)),
		              "reader of key frames");
		delta =
			checked(from->create_datareader(topic(wire, "delta"), delta_qos), "reader of deltas");
	}
	Stream(const Stream &) = delete;
	~Stream() { frames_destroy(decoder); }

	// Takes the waiting frames. The topics are not ordered relative to each other: a delta may
	// arrive before its key frame. So deltas are held until their base has come.
	void read()
	{
		take(topology, [this](cautery::Frame &frame) { take_topology(frame); });
		take(key, [this](cautery::Frame &frame) { take_key(frame); });
		take(delta, [this](cautery::Frame &frame) {
			deltas++;
			held.push_back(frame);
			if (held.size() > HELD)
				held.pop_front();
		});
		apply_held();
	}

	void tell() const
	{
		std::printf("\"stream\":{\"topologies\":%d,\"keys\":%d,\"deltas\":%d,\"applied\":%d,"
		            "\"refused\":%d,\"reason\":\"%s\",\"last_vertex\":%d",
		            topologies, keys, deltas, applied, refused, reason.c_str(),
		            decoder ? frames_last_vertex(decoder) : -1);
		if (decoder && frames_quantised(decoder))
			std::printf(",\"epoch\":\"%016" PRIx64 "\",\"sequence\":%" PRIu64 ",\"tick\":%" PRIu64
			            ",\"gone\":%d",
			            frames_epoch(decoder), frames_sequence(decoder), frames_tick(decoder),
			            frames_gone_faces(decoder));
		std::printf("}");
	}

	void tell_positions() const
	{
		const int32_t *quantised = decoder ? frames_quantised(decoder) : nullptr;
		std::printf("{\"event\":\"positions\",\"step_m\":%.9g,\"tick\":%" PRIu64 ",\"quantised\":[",
		            description.step_m, quantised ? frames_tick(decoder) : 0);
		for (int32_t i = 0; quantised && i < 3 * description.vertex_count; i++)
			std::printf("%s%d", i ? "," : "", quantised[i]);
		std::printf("]}\n");
	}

  private:
	// largest number of held deltas: more than the deltas between two key frames
	static constexpr size_t HELD = 256;

	static fast::Topic *topic(Wire &wire, const std::string &name)
	{
		return wire.topic<cautery::FramePubSubType>("cautery/" + name);
	}

	template <class Take> static void take(fast::DataReader *reader, Take one)
	{
		each_sample<cautery::Frame>(reader,
		                            [&](cautery::Frame &frame, const fast::SampleInfo &info) {
										if (info.valid_data)
											one(frame);
									});
	}

	// Returns the decoder of this frame's stream. If the stream has changed, returns a new, empty
	// decoder.
	bool prepare(const cautery::Frame &frame)
	{
		const cautery::StreamDescription &s = frame.stream();
		if (decoder && s.profile() == description.profile && s.channels() == description.channels &&
		    static_cast<int32_t>(s.vertex_count()) == description.vertex_count)
			return true;
		description = {frame.session_number(),
		               s.profile(),
		               s.channels(),
		               static_cast<int32_t>(s.vertex_count()),
		               static_cast<int32_t>(s.face_count()),
		               {s.origin_m()[0], s.origin_m()[1], s.origin_m()[2]},
		               s.step_m(),
		               s.stress_step_pa()};
		frames_destroy(decoder);
		decoder = frames_create(&description);
		if (!decoder)
			refuse("the description is none of a stream");
		return decoder != nullptr;
	}

	void refuse(const char *why)
	{
		refused++;
		reason = why;
	}

	void take_topology(const cautery::Frame &frame)
	{
		topologies++;
		if (!prepare(frame))
			return;
		const char *why = frames_take_topology(decoder, frame.bytes().data(), frame.bytes().size());
		if (why)
			refuse(why);
	}

	void take_key(const cautery::Frame &frame)
	{
		keys++;
		if (!prepare(frame))
			return;
		bool stale = frames_quantised(decoder) && frames_epoch(decoder) == frame.epoch() &&
		             frames_sequence(decoder) >= frame.sequence_number();
		const char *why =
			stale ? nullptr : frames_take(decoder, frame.bytes().data(), frame.bytes().size());
		if (why)
			refuse(why);
	}

	void apply_held()
	{
		std::deque<cautery::Frame> rest;
		for (cautery::Frame &frame : held) {
			bool based =
				decoder && frames_quantised(decoder) && frames_epoch(decoder) == frame.epoch();
			uint64_t at = based ? frames_sequence(decoder) : 0;
			if (!based || frame.base_sequence() > at) {
				rest.push_back(std::move(frame));
			} else if (frame.base_sequence() == at) {
				const char *why = frames_take(decoder, frame.bytes().data(), frame.bytes().size());
				why ? refuse(why) : static_cast<void>(applied++);
			} // a delta that is older than the present state needs no decoding
		}
		held.swap(rest);
	}

	fast::DataReader *topology, *key, *delta;
	frames_description description{};
	frames_decoder *decoder = nullptr;
	std::deque<cautery::Frame> held;
	int topologies = 0, keys = 0, deltas = 0, applied = 0, refused = 0;
	std::string reason;
};
