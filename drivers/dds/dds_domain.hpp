// A participant in a DDS domain, as ROS 2 nodes are: where it meets others and over which way, its writers and readers.
#pragma once

#include <atomic>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <string>
#include <vector>

#include "drivers/dds/dds_settings.hpp"

namespace stillcut {

// Somebody's writer that was found in the domain.
struct FoundWriter {
  std::string topic, type;
  std::vector<std::string> partitions;
};

class DdsDomain : eprosima::fastdds::dds::DomainParticipantListener {
 public:
  // `name` is what others see of this participant; `on_writer` is called on a thread of Fast DDS's and may be empty.
  // Throws ComponentError.
  DdsDomain(const DdsSettings& settings, const std::string& name, std::function<void(const FoundWriter&)> on_writer);
  ~DdsDomain() override;
  DdsDomain(const DdsDomain&) = delete;
  DdsDomain& operator=(const DdsDomain&) = delete;

  // Reliable, volatile, keep last `depth`: what takes part with best-effort and reliable readers alike. They live as
  // long as this. Throw ComponentError.
  eprosima::fastdds::dds::DataWriter* writer(const std::string& topic, eprosima::fastdds::dds::TypeSupport type,
                                             int depth);
  eprosima::fastdds::dds::DataReader* reader(const std::string& topic, eprosima::fastdds::dds::TypeSupport type,
                                             int depth, eprosima::fastdds::dds::DataReaderListener* listener);

  // How many others were found since the start; with discovery servers those count as well. Any thread.
  [[nodiscard]] int others() const noexcept { return others_; }

 private:
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  eprosima::fastdds::dds::Topic* topic(const std::string& name, eprosima::fastdds::dds::TypeSupport& type);

  std::function<void(const FoundWriter&)> on_writer_;
  std::atomic<int> others_{0};

  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
};

}  // namespace stillcut
