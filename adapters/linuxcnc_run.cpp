#include "adapters/linuxcnc_run.hpp"

#include <spdlog/spdlog.h>

#include <thread>

#include "adapters/adapter_options.hpp"
#include "adapters/adapter_run.hpp"
#include "adapters/correction_intake.hpp"
#include "adapters/exchange_log.hpp"
#include "adapters/lcm_link.hpp"
#include "adapters/linuxcnc_adapter.hpp"
#include "adapters/tcp_lines.hpp"
#include "adapters/udp_port.hpp"

namespace stillcut {
namespace {

constexpr int kConnectWithin_ms = 1000;
constexpr int kWaitForLine_ms = 5;
constexpr std::chrono::milliseconds kConnectAgain{500};

class LinuxCncLoop {
 public:
  LinuxCncLoop(const LinuxCncOptions& options, const AdapterSettings& settings)
      : recorder_{options.adapter.record, "stillcut-linuxcnc " + options.adapter.cell},
        adapter_{settings.session, options.login},
        server_{ipv4_address(options.server)},
        link_{open_lcm(settings.lcm_url)} {}

  // One connection, until it breaks or the end is asked for.
  void talk(const EndSignal& end) {
    const int socket = tcp_connect(server_, kConnectWithin_ms);
    if (socket < 0) {
      if (!complained_) spdlog::warn("LinuxCNC does not listen; is linuxcncrsh started? Trying again");
      complained_ = true;
      for (HeardCorrection unheard; link_.next(unheard);) {  // nobody is there to follow them
      }
      std::this_thread::sleep_for(kConnectAgain);
      return;
    }
    complained_ = false;
    spdlog::info("connected");
    TcpLines lines{socket};
    const char* hang_up = nullptr;
    std::int64_t ends_ns = 0;  // when it must be over, once the end was asked for
    while (hang_up == nullptr && !lines.gone()) {
      if (ends_ns == 0 && end.came()) {
        adapter_.end();
        ends_ns = steady_ns() + kLongestEnd_ns;
        ended_ = true;
      }
      if (ends_ns > 0 && (adapter_.farewell().empty() || steady_ns() > ends_ns || end.came_again())) break;
      const std::optional<std::string> line = lines.next(kWaitForLine_ms);
      const std::int64_t now = steady_ns();
      take_corrections(link_, recorder_, adapter_, complaints_);
      const CncOutput output = adapter_.line(line.value_or(""), now);
      record(line.value_or(""), output, now);
      if (!output.send.empty()) lines.send(output.send);
      if (output.state) link_.say(*output.state);
      if (output.warning != nullptr) spdlog::warn("{}", output.warning);
      hang_up = output.hang_up;
    }
    lines.send(adapter_.farewell());
    adapter_.disconnected();
    spdlog::info("disconnected{}{}", hang_up == nullptr ? "" : ": ", hang_up == nullptr ? "" : hang_up);
    if (hang_up != nullptr) std::this_thread::sleep_for(kConnectAgain);
  }

  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::string summary() const {
    return summary_of(adapter_.session().counters(), adapter_.session().follower_counters()) + ", replies bad " +
           std::to_string(adapter_.bad()) + ", commands refused " + std::to_string(adapter_.refused()) +
           ", published " + std::to_string(link_.sent());
  }

 private:
  // An empty line stands for time that has passed: kept where it led to something.
  void record(std::string_view line, const CncOutput& output, std::int64_t now) {
    if (line.empty() && output.send.empty() && !output.state) return;
    recorder_.put(now, ExchangeKind::packet, line);
    if (!output.send.empty()) recorder_.put(now, ExchangeKind::answer, output.send);
    if (output.state) recorder_.put(now, *output.state);
  }

  Complaints complaints_;
  bool complained_ = false, ended_ = false;
  ExchangeRecorder recorder_;
  LinuxCncAdapter adapter_;
  sockaddr_in server_;
  LcmLink link_;
};

}  // namespace

void run_linuxcnc_adapter(const LinuxCncOptions& options) {
  AdapterSettings settings = adapter_settings(options.adapter, linuxcnc_refusals());
  settings.session.follower.max_variation_hz = 0.1 / (1e-3 * options.adapter.cycle_ms);  // ten setpoints a period
  set_up_log("stillcut-linuxcnc");
  const EndSignal end{options.adapter.duration_s};
  LinuxCncLoop loop{options, settings};
  spdlog::info("stillcut-linuxcnc talks to {}, LCM {}", options.server, settings.lcm_url);
  while (!loop.ended() && !end.came()) loop.talk(end);
  spdlog::info("ended: {}", loop.summary());
}

}  // namespace stillcut
