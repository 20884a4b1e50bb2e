// One way over DDS between two participants of this host, one kilobyte at 1 kHz: how many arrive, how late, and how
// long a write holds its thread. Over UDP and over shared memory, reliable, as stillcut-dds sends.
//
//   bench_dds [SECONDS]    a line for each way; 5 s unless said
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <telemetryPubSubTypes.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <mutex>
#include <thread>
#include <vector>

#include "drivers/dds/dds_domain.hpp"
#include "drivers/dds/samples.hpp"

namespace stillcut {
namespace {

namespace dds = eprosima::fastdds::dds;
using Type = stillcut_msgs::msg::dds_::Spectrum_PubSubType;

constexpr int kDomain = 63, kDepth = 200;
constexpr std::size_t kFloats = 242;  // with the other members 1 kB

std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

double us_at(std::vector<std::int64_t>& sorted_ns, double share) {
  if (sorted_ns.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted_ns.size() - 1));
  std::nth_element(sorted_ns.begin(), sorted_ns.begin() + static_cast<std::ptrdiff_t>(at), sorted_ns.end());
  return 1e-3 * static_cast<double>(sorted_ns[at]);
}

class Arrivals : public dds::DataReaderListener {
 public:
  void on_data_available(dds::DataReader* reader) override {
    SpectrumSample sample;
    dds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      const std::lock_guard lock{mutex_};
      late_ns_.push_back(now_ns() - static_cast<std::int64_t>(sample.window_s()));
    }
  }
  std::vector<std::int64_t> late_ns() {
    const std::lock_guard lock{mutex_};
    return late_ns_;
  }

 private:
  std::mutex mutex_;
  std::vector<std::int64_t> late_ns_;
};

void measure(const char* way, bool shared_memory, long seconds) {
  Arrivals arrivals;
  DdsSettings settings;
  settings.domain = kDomain;
  settings.shared_memory = shared_memory;
  DdsDomain sender{settings, "bench sender", {}}, receiver{settings, "bench receiver", {}};
  receiver.reader("bench", dds::TypeSupport{new Type}, kDepth, &arrivals);
  dds::DataWriter* writer = sender.writer("bench", dds::TypeSupport{new Type}, kDepth);
  for (dds::PublicationMatchedStatus status; status.current_count == 0; writer->get_publication_matched_status(status))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));

  SpectrumSample sample;
  sample.amplitude_m_per_s2(std::vector<float>(kFloats, 1.0F));
  std::vector<std::int64_t> write_ns;
  const auto start = std::chrono::steady_clock::now();
  for (long i = 0; i < 1000 * seconds; ++i) {
    std::this_thread::sleep_until(start + std::chrono::milliseconds(i));
    const std::int64_t before = now_ns();
    sample.window_s(static_cast<double>(before));  // whole nanoseconds up to 2^53: a hundred days
    writer->write(&sample);
    write_ns.push_back(now_ns() - before);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::vector<std::int64_t> late_ns = arrivals.late_ns();
  std::printf("%-14s %zu of %zu arrived, one way %.0f us (p99 %.0f, max %.0f), write %.0f us (p99 %.0f, max %.0f)\n",
              way, late_ns.size(), write_ns.size(), us_at(late_ns, 0.5), us_at(late_ns, 0.99), us_at(late_ns, 1.0),
              us_at(write_ns, 0.5), us_at(write_ns, 0.99), us_at(write_ns, 1.0));
}

}  // namespace
}  // namespace stillcut

int main(int argc, char** argv) {
  // Two participants of one process would hand samples over directly.
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  const long seconds = argc > 1 ? std::max(1L, std::atol(argv[1])) : 5;
  stillcut::measure("UDP", false, seconds);
  stillcut::measure("shared memory", true, seconds);
  return 0;
}
