#include "drivers/dds/dds_domain.hpp"

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <memory>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kSocketBuffer = 1U << 20U;  // a second of everything and more, while a reader does not run

dds::DomainParticipantQos participant_qos(const DdsSettings& settings, const std::string& name) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.name(name);
  // Where two met and one did not hear, they meet at the next announcement: by default 3 s later.
  qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t{1, 0};
  qos.transport().use_builtin_transports = false;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->receiveBufferSize = udp->sendBufferSize = kSocketBuffer;
  if (!settings.interface_address.empty()) udp->interfaceWhiteList.push_back(settings.interface_address);
  qos.transport().user_transports.push_back(udp);
  if (settings.shared_memory)
    qos.transport().user_transports.push_back(
        std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>());
  return qos;
}

template <class Qos>
void set_history(Qos& qos, int depth) {
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();  // its segments are shared memory that nobody chose
}

template <class T>
T* made(T* entity, const char* what) {
  if (entity == nullptr) throw ComponentError(std::string("Fast DDS could not make its ") + what);
  return entity;
}

}  // namespace

DdsDomain::DdsDomain(const DdsSettings& settings, const std::string& name,
                     std::function<void(const FoundWriter&)> on_writer)
    : on_writer_{std::move(on_writer)} {
  dds::Log::SetVerbosity(dds::Log::Error);
  // Fast DDS takes the servers from there by itself, as every ROS 2 node does; given as an option they go the same way.
  if (!settings.discovery_server.empty()) ::setenv("ROS_DISCOVERY_SERVER", settings.discovery_server.c_str(), 1);
  auto* factory = dds::DomainParticipantFactory::get_instance();
  participant_ = factory->create_participant(static_cast<dds::DomainId_t>(settings.domain),
                                             participant_qos(settings, name), this, dds::StatusMask::none());
  if (participant_ == nullptr)
    throw ComponentError("DDS domain " + std::to_string(settings.domain) +
                         " cannot be joined; is its network interface there, and are its UDP ports free? Choose "
                         "another with --domain, or --interface");
  dds::PublisherQos publisher = dds::PUBLISHER_QOS_DEFAULT;
  dds::SubscriberQos subscriber = dds::SUBSCRIBER_QOS_DEFAULT;
  if (!settings.partition.empty()) {
    publisher.partition().push_back(settings.partition.c_str());
    subscriber.partition().push_back(settings.partition.c_str());
  }
  publisher_ = made(participant_->create_publisher(publisher), "publisher");
  subscriber_ = made(participant_->create_subscriber(subscriber), "subscriber");
}

DdsDomain::~DdsDomain() {
  participant_->set_listener(nullptr);
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

void DdsDomain::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                         rtps::ParticipantDiscoveryInfo&& info) {
  if (info.status == rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT) ++others_;
}

void DdsDomain::on_publisher_discovery(dds::DomainParticipant* /*participant*/, rtps::WriterDiscoveryInfo&& info) {
  if (!on_writer_ || info.status != rtps::WriterDiscoveryInfo::DISCOVERED_WRITER) return;
  on_writer_(
      {info.info.topicName().to_string(), info.info.typeName().to_string(), info.info.m_qos.m_partition.getNames()});
}

dds::Topic* DdsDomain::topic(const std::string& name, dds::TypeSupport& type) {
  type.register_type(participant_);
  return made(participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT), "topic");
}

dds::DataWriter* DdsDomain::writer(const std::string& name, dds::TypeSupport type, int depth) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  set_history(qos, depth);
  return made(publisher_->create_datawriter(topic(name, type), qos), "writer");
}

dds::DataReader* DdsDomain::reader(const std::string& name, dds::TypeSupport type, int depth,
                                   dds::DataReaderListener* listener) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  set_history(qos, depth);
  return made(subscriber_->create_datareader(topic(name, type), qos, listener), "reader");
}

}  // namespace stillcut
