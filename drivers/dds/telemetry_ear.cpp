#include "drivers/dds/telemetry_ear.hpp"

#include <fastdds/rtps/common/SampleIdentity.h>
#include <telemetryPubSubTypes.h>

#include <chrono>
#include <cstdio>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <map>
#include <mutex>

#include "drivers/dds/diagnostics.hpp"
#include "drivers/dds/topics.hpp"

namespace stillcut {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

template <class... Values>
std::string worded(const char* format, Values... values) {
  std::array<char, 160> text{};
  (void)std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string state_word(std::uint8_t state) {
  return state <= static_cast<std::uint8_t>(State::fault) ? describe(static_cast<State>(state))
                                                          : "state " + std::to_string(state);
}

std::string describe(const StatusSample& s) {
  return state_word(s.state()) + worded(", %.0f rpm, indicator %.2f, frames %lld", s.spindle_speed_rpm(), s.indicator(),
                                        static_cast<long long>(s.frames()));
}
std::string describe(const IndicatorSample& s) {
  return state_word(s.state()) + worded(", indicator %.2f, chatter at %.1f Hz, margin %.2f", s.indicator(),
                                        s.chatter_frequency_hz(), s.margin());
}
std::string describe(const SpectrumSample& s) {
  std::size_t peak = 0;
  for (std::size_t i = 1; i < s.amplitude_m_per_s2().size(); ++i)
    if (s.amplitude_m_per_s2()[i] > s.amplitude_m_per_s2()[peak]) peak = i;
  return worded("%zu bins of %.2f Hz, peak at %.1f Hz", s.amplitude_m_per_s2().size(), s.bin_hz(),
                static_cast<double>(peak) * s.bin_hz());
}
std::string describe(const ImuSample& s) {
  const auto& a = s.linear_acceleration();
  return s.header().frame_id() + worded(": %.3f %.3f %.3f m/s^2", a.x(), a.y(), a.z());
}
std::string describe(const CorrectionSample& s) {
  return worded("number %lld, kind %d, mode %d, %.0f rpm: ", static_cast<long long>(s.sequence_number()), int{s.kind()},
                int{s.mode()}, s.spindle_speed_target_rpm()) +
         s.reason();
}
std::string describe(const EventSample& s) {
  return worded("event %d, kind %d, %.1f Hz: ", int{s.event()}, int{s.kind()}, s.frequency_hz()) + s.note();
}
std::string describe(const LobesSample& s) {
  return worded("%zu limits from %.0f to %.0f rpm, %zu modes", s.depth_limit_mm().size(), s.min_rpm(), s.max_rpm(),
                s.mode_hz().size());
}
std::string describe(const DiagnosticsSample& s) {
  std::string text;
  for (const auto& item : s.status())
    text += (text.empty() ? "" : ", ") + item.name() + worded(" (%d): ", int{item.level()}) + item.message();
  return text;
}

double steady_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

class TelemetryEar::Topic : public dds::DataReaderListener {
 public:
  explicit Topic(std::string name) { heard_.topic = std::move(name); }
  [[nodiscard]] HeardTopic heard() const {
    const std::lock_guard lock{mutex_};
    HeardTopic heard = heard_;
    if (heard.messages > 1 && last_s_ > first_s_)
      heard.rate_hz = static_cast<double>(heard.messages - 1) / (last_s_ - first_s_);
    return heard;
  }

 protected:
  // Each writer counts its samples from 1; what was said before the first heard is not lost.
  void count(const rtps::SampleIdentity& identity, std::string newest) {
    const std::lock_guard lock{mutex_};
    last_s_ = steady_s();
    if (heard_.messages++ == 0) first_s_ = last_s_;
    const std::int64_t number = static_cast<std::int64_t>(identity.sequence_number().to64long());
    const auto [writer, is_new] = last_number_.try_emplace(identity.writer_guid(), number);
    if (!is_new) heard_.lost += number - writer->second - 1;
    writer->second = number;
    heard_.newest = std::move(newest);
  }
  void on_subscription_matched(dds::DataReader* /*reader*/, const dds::SubscriptionMatchedStatus& status) override {
    const std::lock_guard lock{mutex_};
    heard_.writers = status.current_count;
  }

 private:
  mutable std::mutex mutex_;
  HeardTopic heard_;
  double first_s_ = 0.0, last_s_ = 0.0;
  std::map<rtps::GUID_t, std::int64_t> last_number_;
};

template <class Type>
class TelemetryEar::TypedTopic : public TelemetryEar::Topic {
 public:
  using Topic::Topic;
  void on_data_available(dds::DataReader* reader) override {
    typename Type::type sample;
    dds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
      if (info.valid_data) count(info.sample_identity, describe(sample));
  }
};

TelemetryEar::TelemetryEar(const DdsSettings& settings, const std::string& name) : settings_{settings} {
  using namespace stillcut_msgs::msg::dds_;
  domain_ = std::make_unique<DdsDomain>(settings, "stillcut-dds --listen",
                                        [this](const FoundWriter& writer) { note_speaker(writer); });
  const auto listen = [&]<class Type>(const DdsTopic& topic, Type* type) {
    topics_.push_back(std::make_unique<TypedTopic<Type>>(topic_name(name, topic)));
    domain_->reader(topic_name(name, topic), dds::TypeSupport{type}, topic.depth, topics_.back().get());
  };
  listen(kStatusTopic, new Status_PubSubType);
  listen(kIndicatorTopic, new Indicator_PubSubType);
  listen(kSpectrumTopic, new Spectrum_PubSubType);
  listen(kVibrationTopic, new sensor_msgs::msg::dds_::Imu_PubSubType);
  listen(kCorrectionTopic, new Correction_PubSubType);
  listen(kEventTopic, new Event_PubSubType);
  listen(kLobesTopic, new Lobes_PubSubType);
  listen(kDiagnosticsTopic, new diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType);
}

TelemetryEar::~TelemetryEar() = default;

std::vector<HeardTopic> TelemetryEar::heard() const {
  std::vector<HeardTopic> all;
  for (const auto& topic : topics_) all.push_back(topic->heard());
  return all;
}

// Under which names and partitions Stillcut speaks.
void TelemetryEar::note_speaker(const FoundWriter& writer) {
  const std::string prefix = "rt/", suffix = std::string("/") + kStatusTopic.name;
  if (writer.type != stillcut_msgs::msg::dds_::Status_PubSubType{}.getName() ||
      writer.topic.size() <= prefix.size() + suffix.size() || !writer.topic.ends_with(suffix))
    return;
  std::string options =
      "--namespace " + writer.topic.substr(prefix.size(), writer.topic.size() - prefix.size() - suffix.size());
  for (const std::string& partition : writer.partitions) options += " --partition " + partition;
  const std::lock_guard lock{mutex_};
  speakers_.insert(options);
}

std::string TelemetryEar::advice() const {
  const std::string where = "DDS domain " + std::to_string(settings_.domain);
  if (domain_->others() == 0)
    return "nobody else is in " + where + "; is stillcut-dds running, with the same ROS_DOMAIN_ID, " +
           (settings_.discovery_server.empty() ? "on a network that multicast reaches?"
                                               : "and the discovery server " + settings_.discovery_server + "?");
  const std::lock_guard lock{mutex_};
  if (speakers_.empty())
    return "others are in " + where +
           ", but Stillcut is not; start `stillcut-dds CELL` with ROS_DOMAIN_ID=" + std::to_string(settings_.domain);
  std::string options;
  for (const std::string& speaker : speakers_) options += (options.empty() ? "" : ", or ") + speaker;
  return "in " + where + " Stillcut speaks elsewhere; listen with " + options;
}

}  // namespace stillcut
