// Lines of candump logs.
#include <cstring>

#include "drivers/can/candump_log.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

namespace {

bool same(const CanFrame& a, const CanFrame& b) {
  return a.id == b.id && a.fd == b.fd && a.fd_flags == b.fd_flags && a.length == b.length && a.stamp_ns == b.stamp_ns &&
         std::memcmp(a.data.data(), b.data.data(), a.length) == 0;
}

void check_line(std::string_view line) {
  CanFrame frame;
  std::string_view interface;
  if (parse_candump_line(line, frame, &interface) != CandumpLine::frame) return;
  require_that(interface.data() >= line.data() && interface.data() + interface.size() <= line.data() + line.size(),
               "the interface stands in the line");
  require_that(frame.length <= frame.data.size(), "no more data than a frame has room for");
  std::array<char, kMaxCandumpLine> written{};
  const std::size_t length = format_candump_line(frame, interface, written);
  require_that(length > 0 && length <= written.size() && written.at(length - 1) == '\n', "one line is written");
  CanFrame again;
  require_that(parse_candump_line({written.data(), length - 1}, again) == CandumpLine::frame, "it is a frame again");
  require_that(same(frame, again), "the same frame");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = text_of(data, size);
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    check_line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return 0;
}
