// SPDX-License-Identifier: GPL-3.0-or-later
// A robot controller with the DDS of another vendor: Fast DDS, the code that fastddsgen generated
// from the IDL, and nothing of the server.
//
//     interop_robot DOMAIN SESSION TOOL native|ros|sensor DEADLINE_MS
//
// The mode sensor is like ros, but writes poses with best effort, like ROS 2's sensor data. The
// program writes 100 times a second. Lines on standard input control it:
//     aim X Y Z      goes to this position (m) at 0.2 m/s
//     energy 0|1     level of energy that it writes
//     write on|off   off: silent, but alive
//     state          prints the received state
//     positions      prints the decoded vertices
// It writes events as JSON objects, one a line, to standard output: matched, state, positions.
#include <chrono>
#include <cmath>
#include <poll.h>
#include <sstream>
#include <thread>
#include <unistd.h>

#include "ros2PubSubTypes.h"
#include "stream.hpp"

namespace geometry = geometry_msgs::msg::dds_;
namespace sensor = sensor_msgs::msg::dds_;

static constexpr double PERIOD_S = 0.01, SPEED_M_S = 0.2;

struct Options {
	unsigned domain;
	std::string session, tool;
	bool ros, sensor;
	int deadline_ms;
};

static std::string ros_name(const Options &options, const std::string &leaf)
{
	std::string name = "rt/" + options.session + "/" + options.tool + "/" + leaf;
	for (char &letter : name)
		if (letter == '-')
			letter = '_';
	return name;
}

class Robot
{
  public:
	explicit Robot(const Options &given)
		: options(given), wire(given.domain, given.session), stream(wire)
	{
		state_reader = checked(
			wire.session_subscriber->create_datareader(
				wire.topic<cautery::ToolStatePubSubType>("cautery/tool_state"), kept_reader_qos(1)),
			"reader of states");
		status_reader =
			checked(wire.session_subscriber->create_datareader(
						wire.topic<cautery::SessionStatusPubSubType>("cautery/session_status"),
						kept_reader_qos(1)),
		            "reader of statuses");
		fast::Topic *pose =
			wire.topic<geometry::PoseStamped_PubSubType>(ros_name(options, "measured_cp"));
		fast::Topic *force =
			wire.topic<geometry::WrenchStamped_PubSubType>(ros_name(options, "measured_cf"));
		pose_reader = checked(wire.subscriber->create_datareader(pose, ros_reader_qos()), "reader");
		force_reader =
			checked(wire.subscriber->create_datareader(force, ros_reader_qos()), "reader");
		options.ros ? open_ros() : open_native();
	}

	void run()
	{
		auto next = std::chrono::steady_clock::now();
		while (listen()) {
			next += std::chrono::microseconds(static_cast<int>(1e6 * PERIOD_S));
			std::this_thread::sleep_until(next);
			read();
			if (!matched && is_matched()) {
				matched = true;
				std::printf("{\"event\":\"matched\"}\n");
			}
			if (matched && writing)
				write();
		}
	}

  private:
	void open_native()
	{
		fast::Topic *topic = wire.topic<cautery::ToolCommandPubSubType>("cautery/tool_command");
		command_writer = checked(wire.session_publisher->create_datawriter(
									 topic, native_writer_qos(options.deadline_ms)),
		                         "writer of commands");
	}

	void open_ros()
	{
		fast::Topic *pose =
			wire.topic<geometry::PoseStamped_PubSubType>(ros_name(options, "servo_cp"));
		fast::Topic *level = wire.topic<sensor::Joy_PubSubType>(ros_name(options, "energize"));
		fast::DataWriterQos pose_qos = ros_writer_qos();
		if (options.sensor)
			pose_qos.reliability().kind = fast::BEST_EFFORT_RELIABILITY_QOS;
		pose_writer = checked(wire.publisher->create_datawriter(pose, pose_qos), "writer");
		level_writer =
			checked(wire.publisher->create_datawriter(level, ros_writer_qos()), "writer");
	}

	static bool has_reader(fast::DataWriter *writer)
	{
		fast::PublicationMatchedStatus status;
		return writer->get_publication_matched_status(status) == ReturnCode_t::RETCODE_OK &&
		       status.current_count > 0;
	}

	bool is_matched() const
	{
		if (!state_count)
			return false;
		return options.ros ? has_reader(pose_writer) && has_reader(level_writer) && pose_count
		                   : has_reader(command_writer);
	}

	void read()
	{
		each_sample<cautery::ToolState>(
			state_reader, [this](const cautery::ToolState &sample, const fast::SampleInfo &info) {
				removed = info.instance_state == fast::NOT_ALIVE_DISPOSED_INSTANCE_STATE;
				if (info.valid_data && sample.tool().to_string() == options.tool) {
					state = sample;
					state_count++;
				}
			});
		each_sample<cautery::SessionStatus>(
			status_reader,
			[this](const cautery::SessionStatus &sample, const fast::SampleInfo &info) {
				gone = info.instance_state == fast::NOT_ALIVE_DISPOSED_INSTANCE_STATE;
				if (info.valid_data)
					status = sample;
			});
		each_sample<geometry::PoseStamped_>(
			pose_reader,
			[this](const geometry::PoseStamped_ &sample, const fast::SampleInfo &info) {
				pose_count += info.valid_data;
				pose = sample;
			});
		each_sample<geometry::WrenchStamped_>(
			force_reader,
			[this](const geometry::WrenchStamped_ &sample, const fast::SampleInfo &info) {
				force_count += info.valid_data;
				force = sample;
			});
		stream.read();
	}

	void go_on()
	{
		double away[3], squared = 0;
		for (int i = 0; i < 3; i++) {
			away[i] = aim_m[i] - position_m[i];
			squared += away[i] * away[i];
		}
		double most = SPEED_M_S * PERIOD_S, distance = std::sqrt(squared);
		for (int i = 0; i < 3; i++)
			position_m[i] += (distance > most ? most / distance : 1) * away[i];
	}

	void write()
	{
		go_on();
		options.ros ? write_ros() : write_native();
	}

	void write_native()
	{
		cautery::ToolCommand sample;
		sample.session(options.session);
		sample.tool(options.tool);
		sample.sequence_number(++sequence);
		sample.source_time_ns(std::chrono::duration_cast<std::chrono::nanoseconds>(
								  std::chrono::system_clock::now().time_since_epoch())
		                          .count());
		sample.position_m({position_m[0], position_m[1], position_m[2]});
		sample.rotation({1, 0, 0, 0});
		sample.jaw(1);
		sample.energy(energy);
		sample.grasp(false);
		command_writer->write(&sample);
	}

	void write_ros()
	{
		geometry::PoseStamped_ sample;
		sample.header_().frame_id_("world");
		sample.pose_().position_().x_(position_m[0]);
		sample.pose_().position_().y_(position_m[1]);
		sample.pose_().position_().z_(position_m[2]);
		sample.pose_().orientation_().w_(1);
		pose_writer->write(&sample);
		sensor::Joy_ level;
		level.buttons_({energy ? 1 : 0});
		level_writer->write(&level);
	}

	void tell() const
	{
		const auto &p = state.position_m();
		const auto &at = pose.pose_().position_();
		const auto &f = force.wrench_().force_();
		std::printf("{\"event\":\"state\",\"native\":{\"count\":%d,\"tick\":%llu,\"sequence\":%llu,"
		            "\"position_m\":[%.6f,%.6f,%.6f],\"force_n\":[%.6g,%.6g,%.6g],"
		            "\"energized\":%s,\"energy_off\":%d,\"driver\":%u,\"driver_name\":\"%s\","
		            "\"removed\":%s},",
		            state_count, static_cast<unsigned long long>(state.tick()),
		            static_cast<unsigned long long>(state.sequence_number()), p[0], p[1], p[2],
		            state.force_n()[0], state.force_n()[1], state.force_n()[2],
		            state.energized() ? "true" : "false", static_cast<int>(state.energy_off()),
		            state.driver(), state.driver_name().to_string().c_str(),
		            removed ? "true" : "false");
		std::printf("\"cp\":{\"count\":%d,\"position_m\":[%.6f,%.6f,%.6f],\"frame_id\":\"%s\"},"
		            "\"cf\":{\"count\":%d,\"force_n\":[%.6g,%.6g,%.6g]},"
		            "\"status\":{\"session\":\"%s\",\"state\":%d,\"tick\":%llu,"
		            "\"vertices\":%u,\"gone\":%s},",
		            pose_count, at.x_(), at.y_(), at.z_(), pose.header_().frame_id_().c_str(),
		            force_count, f.x_(), f.y_(), f.z_(), status.session().to_string().c_str(),
		            static_cast<int>(status.state()),
		            static_cast<unsigned long long>(status.tick()), status.vertex_count(),
		            gone ? "true" : "false");
		stream.tell();
		std::printf("}\n");
	}

	void obey(const std::string &line)
	{
		std::istringstream words(line);
		std::string word, value;
		words >> word;
		if (word == "aim") {
			words >> aim_m[0] >> aim_m[1] >> aim_m[2];
			return;
		}
		words >> value;
		if (word == "energy")
			energy = value == "1";
		else if (word == "write")
			writing = value == "on";
		else if (word == "state")
			tell();
		else if (word == "positions")
			stream.tell_positions();
	}

	// Obeys the whole lines that wait on standard input. Returns false at the end of the input.
	bool listen()
	{
		pollfd input = {STDIN_FILENO, POLLIN, 0};
		while (poll(&input, 1, 0) > 0) {
			char bytes[256];
			ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
			if (got <= 0)
				return false;
			heard.append(bytes, static_cast<size_t>(got));
		}
		for (size_t end; (end = heard.find('\n')) != std::string::npos; heard.erase(0, end + 1))
			obey(heard.substr(0, end));
		return true;
	}

	const Options options;
	Wire wire;
	Stream stream;
	fast::DataWriter *command_writer = nullptr, *pose_writer = nullptr, *level_writer = nullptr;
	fast::DataReader *state_reader, *status_reader, *pose_reader, *force_reader;
	cautery::ToolState state;
	cautery::SessionStatus status;
	geometry::PoseStamped_ pose;
	geometry::WrenchStamped_ force;
	int state_count = 0, pose_count = 0, force_count = 0;
	bool matched = false, writing = false, energy = false, gone = false, removed = false;
	double position_m[3] = {0, 0, 0.02}, aim_m[3] = {0, 0, 0.02};
	uint64_t sequence = 0;
	std::string heard;
};

int main(int argument_count, char **arguments)
{
	if (argument_count != 6) {
		std::fprintf(stderr,
		             "usage: interop_robot DOMAIN SESSION TOOL native|ros|sensor DEADLINE_MS\n");
		return 2;
	}
	std::setvbuf(stdout, nullptr, _IOLBF, 0);
	Options options = {static_cast<unsigned>(std::atoi(arguments[1])),
	                   arguments[2],
	                   arguments[3],
	                   std::string(arguments[4]) != "native",
	                   std::string(arguments[4]) == "sensor",
	                   std::atoi(arguments[5])};
	Robot robot(options);
	robot.run();
	return 0;
}
