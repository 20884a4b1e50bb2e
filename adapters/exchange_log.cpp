#include "adapters/exchange_log.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

#include "drivers/files/input_error.hpp"
#include "drivers/lcm/messages.hpp"

namespace stillcut {
namespace {

constexpr std::array<std::string_view, 5> kKindNames{"packet", "answer", "correction", "ack", "state"};

// Nothing when an escape is broken.
std::optional<std::string> unescaped(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes += text[i];
      continue;
    }
    unsigned value = 0;
    if (i + 3 > text.size()) return std::nullopt;
    const auto [end, error] = std::from_chars(&text[i + 1], &text[i + 1] + 2, value, 16);
    if (error != std::errc{} || end != &text[i + 1] + 2) return std::nullopt;
    bytes += static_cast<char>(value);
    i += 2;
  }
  return bytes;
}

std::optional<ExchangeEntry> entry_of(std::string_view line) {
  ExchangeEntry entry;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), entry.time_ns);
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  if (error != std::errc{} || !line.starts_with(' ')) return std::nullopt;
  line.remove_prefix(1);
  const std::string_view name = line.substr(0, line.find(' '));
  const auto* kind = std::find(kKindNames.begin(), kKindNames.end(), name);
  if (kind == kKindNames.end() || name.size() == line.size()) return std::nullopt;
  entry.kind = static_cast<ExchangeKind>(kind - kKindNames.begin());
  auto bytes = unescaped(line.substr(name.size() + 1));
  if (!bytes) return std::nullopt;
  entry.bytes = std::move(*bytes);
  return entry;
}

}  // namespace

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string exchange_line(const ExchangeEntry& entry) {
  std::string line = std::to_string(entry.time_ns) + ' ';
  line.append(kKindNames.at(static_cast<std::size_t>(entry.kind))) += ' ';
  for (const char c : entry.bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F && c != '\\') {
      line += c;
    } else {
      std::array<char, 4> escape{};
      std::snprintf(escape.data(), escape.size(), "\\%02x", byte);
      line += escape.data();
    }
  }
  return line;
}

std::vector<ExchangeEntry> read_exchange(const std::string& file) {
  std::ifstream in{file, std::ios::binary};
  if (!in) throw InputError(file, 0, "cannot be read; check the name");
  std::vector<ExchangeEntry> entries;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    auto entry = entry_of(line);
    if (!entry) throw InputError(file, number, "is not 'TIME KIND BYTES' as an adapter's --record writes it");
    entries.push_back(std::move(*entry));
  }
  return entries;
}

ExchangeRecorder::ExchangeRecorder(const std::string& file, const std::string& comment) {
  if (file.empty()) return;
  out_.open(file, std::ios::binary);
  if (!out_) throw InputError(file, 0, "cannot be written; check the folder and its rights");
  out_ << "# " << comment << '\n';
}

void ExchangeRecorder::put(std::int64_t time_ns, ExchangeKind kind, std::string_view bytes) {
  if (out_.is_open()) out_ << exchange_line({time_ns, kind, std::string{bytes}}) << '\n';
}

void ExchangeRecorder::put(std::int64_t time_ns, const Correction& correction) {
  if (out_.is_open()) put(time_ns, ExchangeKind::correction, text_of(encode(correction)));
}

void ExchangeRecorder::put(std::int64_t time_ns, const Answer& answer) {
  if (out_.is_open()) put(time_ns, ExchangeKind::ack, text_of(encode(answer.ack, text_of(answer.reason))));
}

void ExchangeRecorder::put(std::int64_t time_ns, const RobotState& state) {
  if (out_.is_open()) put(time_ns, ExchangeKind::state, text_of(encode(state)));
}

}  // namespace stillcut
