// SPDX-License-Identifier: GPL-3.0-or-later
// Fast DDS entities as a robot's program makes them. This file sets the QoS. The profile that the
// environment names (deploy/dds/loopback-fastdds.xml) sets transport and discovery.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <string>

namespace fast = eprosima::fastdds::dds;

// Returns the created entity, or ends the program without cleaning up. Fast DDS's threads still run
// then, and cleaning up would destroy objects that they use.
template <class T> T *checked(T *made, const std::string &what)
{
	if (!made) {
		std::fprintf(stderr, "interop_robot: no %s\n", what.c_str());
		std::_Exit(1);
	}
	return made;
}

// The participant, with publishers and subscribers of the default partition and of the session's
// partition.
class Wire
{
  public:
	Wire(unsigned domain, const std::string &session)
	{
		auto *factory = fast::DomainParticipantFactory::get_instance();
		factory->load_profiles();
		fast::DomainParticipantQos qos = factory->get_default_participant_qos();
		participant = checked(factory->create_participant(domain, qos), "participant");
		fast::PublisherQos publisher_qos;
		fast::SubscriberQos subscriber_qos;
		publisher = checked(participant->create_publisher(publisher_qos), "publisher");
		subscriber = checked(participant->create_subscriber(subscriber_qos), "subscriber");
		publisher_qos.partition().push_back(session.c_str());
		subscriber_qos.partition().push_back(session.c_str());
		session_publisher = checked(participant->create_publisher(publisher_qos), "publisher");
		session_subscriber = checked(participant->create_subscriber(subscriber_qos), "subscriber");
	}
	Wire(const Wire &) = delete;
	~Wire()
	{
		participant->delete_contained_entities();
		fast::DomainParticipantFactory::get_instance()->delete_participant(participant);
	}

	// PubSubType is the class that fastddsgen generated for the topic's type.
	template <class PubSubType> fast::Topic *topic(const std::string &name)
	{
		fast::TypeSupport type(new PubSubType());
		type.register_type(participant);
		return checked(
			participant->create_topic(name, type.get_type_name(), fast::TOPIC_QOS_DEFAULT),
			"topic " + name);
	}

	fast::DomainParticipant *participant;
	fast::Publisher *publisher, *session_publisher;
	fast::Subscriber *subscriber, *session_subscriber;
};

// ROS 2's default QoS: reliable, volatile, shared, keep last 10.
inline fast::DataWriterQos ros_writer_qos()
{
	fast::DataWriterQos qos;
	qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
	qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
	qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
	qos.history().depth = 10;
	return qos;
}

inline fast::DataReaderQos ros_reader_qos()
{
	fast::DataReaderQos qos;
	qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
	qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
	qos.history().depth = 10;
	return qos;
}

// QoS of a native driver. It declares its deadline and proves that it is alive only by writing.
inline fast::DataWriterQos native_writer_qos(int deadline_ms)
{
	fast::DataWriterQos qos;
	qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
	qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
	qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
	qos.history().depth = 1;
	qos.deadline().period = eprosima::fastrtps::Duration_t(1e-3 * deadline_ms);
	qos.liveliness().kind = fast::MANUAL_BY_TOPIC_LIVELINESS_QOS;
	qos.liveliness().lease_duration = eprosima::fastrtps::Duration_t(0.5);
	qos.liveliness().announcement_period = eprosima::fastrtps::Duration_t(0.25);
	return qos;
}

// QoS of topics that late joiners receive: the last `kept` samples of each instance.
inline fast::DataReaderQos kept_reader_qos(int kept)
{
	fast::DataReaderQos qos = ros_reader_qos();
	qos.durability().kind = fast::TRANSIENT_LOCAL_DURABILITY_QOS;
	qos.history().depth = kept;
	return qos;
}

// Calls take(sample, info) for each waiting sample.
template <class Sample, class Take> void each_sample(fast::DataReader *reader, Take take)
{
	Sample sample;
	fast::SampleInfo info;
	while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK)
		take(sample, info);
}
