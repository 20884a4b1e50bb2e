#include "drivers/dds/telemetry_bridge.hpp"

#include <telemetryPubSubTypes.h>

#include "drivers/dds/topics.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kDiagnose_ns = 1'000'000'000;
constexpr std::size_t kTurnsToEmpty = 10;  // 50 ms, the time between two messages of vibration
constexpr std::size_t kMostWaiting = 1000;

}  // namespace

TelemetryBridge::TelemetryBridge(const DdsSettings& settings, const std::string& name, const std::string& hardware_id)
    : domain_{settings, "stillcut-dds " + name, {}}, state_{name, hardware_id} {
  using namespace stillcut_msgs::msg::dds_;
  const auto open = [&](Topic which, const DdsTopic& topic, auto* type) {
    writers_.at(which) =
        domain_.writer(topic_name(name, topic), eprosima::fastdds::dds::TypeSupport{type}, topic.depth);
  };
  open(status, kStatusTopic, new Status_PubSubType);
  open(indicator, kIndicatorTopic, new Indicator_PubSubType);
  open(spectrum, kSpectrumTopic, new Spectrum_PubSubType);
  open(vibration, kVibrationTopic, new sensor_msgs::msg::dds_::Imu_PubSubType);
  open(correction, kCorrectionTopic, new Correction_PubSubType);
  open(event, kEventTopic, new Event_PubSubType);
  open(lobes, kLobesTopic, new Lobes_PubSubType);
  open(diagnostics, kDiagnosticsTopic, new diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType);
}

template <class Sample>
void TelemetryBridge::write(Topic topic, Sample sample) {
  ++(writers_.at(topic)->write(&sample) ? written_ : failed_);
}

void TelemetryBridge::hear(const TelemetryMessage& message, std::int64_t heard_ns) {
  heard_ns_ = heard_ns;
  if (const auto* m = std::get_if<Status>(&message)) write(status, sample_of(*m));
  if (const auto* m = std::get_if<MonitorReport>(&message)) write(indicator, sample_of(*m));
  if (const auto* m = std::get_if<SpectrumReport>(&message)) write(spectrum, sample_of(*m));
  if (const auto* m = std::get_if<Correction>(&message)) write(correction, sample_of(*m));
  if (const auto* m = std::get_if<Event>(&message)) write(event, sample_of(*m));
  if (const auto* m = std::get_if<DiagramReport>(&message)) write(lobes, sample_of(*m));
  const std::lock_guard lock{mutex_};
  state_.hear(message, heard_ns);
  if (const auto* m = std::get_if<VibrationReport>(&message)) {
    for (ImuSample& sample : samples_of(*m)) waiting_.push_back(std::move(sample));
    for (; waiting_.size() > kMostWaiting; ++failed_) waiting_.pop_front();
  }
}

void TelemetryBridge::turn(std::int64_t now_ns, std::int64_t stamp_ns) {
  std::vector<ImuSample> due;
  std::optional<DiagnosticsSample> diagnosis;
  {
    const std::lock_guard lock{mutex_};
    for (std::size_t n = (waiting_.size() + kTurnsToEmpty - 1) / kTurnsToEmpty; n > 0; --n) {
      due.push_back(std::move(waiting_.front()));
      waiting_.pop_front();
    }
    if (now_ns - diagnosed_ns_ >= kDiagnose_ns) {
      diagnosed_ns_ = now_ns;
      diagnosis = state_.sample(now_ns, stamp_ns);
    }
  }
  for (ImuSample& sample : due) write(vibration, std::move(sample));
  if (diagnosis) write(diagnostics, std::move(*diagnosis));
}

int TelemetryBridge::readers() const {
  int readers = 0;
  for (const auto* writer : writers_) {
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    readers += status.current_count;
  }
  return readers;
}

}  // namespace stillcut
