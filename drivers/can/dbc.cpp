#include "drivers/can/dbc.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>

#include "drivers/can/dbc_scanner.hpp"
#include "drivers/files/input_error.hpp"
#include "rt/can_frame.hpp"

namespace stillcut {
namespace {

// Vector's editors collect signals of no message under this one; it is never on the bus.
constexpr std::string_view kIndependentSignals = "VECTOR__INDEPENDENT_SIG_MSG";
constexpr std::int64_t kIndependentSignalsId = 0xC0000000;

// Statements that describe networks, nodes and tools, not frames.
constexpr std::array<std::string_view, 27> kNotNeeded = {"VERSION",     "NS_",
                                                         "BS_",         "BU_",
                                                         "EV_",         "VAL_TABLE_",
                                                         "BO_TX_BU_",   "BA_DEF_",
                                                         "BA_DEF_DEF_", "BA_DEF_REL_",
                                                         "BA_REL_",     "BA_DEF_SGTYPE_",
                                                         "BA_SGTYPE_",  "BU_SG_REL_",
                                                         "BU_EV_REL_",  "BU_BO_REL_",
                                                         "SIG_GROUP_",  "SIGTYPE_VALTYPE_",
                                                         "SGTYPE_",     "SGTYPE_VAL_",
                                                         "CAT_DEF_",    "CAT_",
                                                         "FILTER",      "ENVVAR_DATA_",
                                                         "EV_DATA_",    "BA_DEF_DEF_REL_",
                                                         "NS_DESC_"};

std::uint32_t frame_id(DbcScanner& scan) {
  const std::int64_t id = scan.integer("message identifier");
  const auto value = static_cast<std::uint32_t>(id & 0xFFFFFFFF);
  const std::uint32_t most = (value & CanFrame::kExtended) != 0 ? CanFrame::kExtended | 0x1FFFFFFFU : 0x7FFU;
  if (id != kIndependentSignalsId && (id < 0 || id > 0xFFFFFFFFLL || value > most)) {
    scan.fail("message identifier " + std::to_string(id) + " is neither 11 bits nor, with bit 31 set, 29 bits wide");
  }
  return value;
}

void parse_message(Dbc& dbc, DbcScanner& scan, int line) {
  DbcMessage message;
  message.line = line;
  message.id = frame_id(scan);
  message.name = scan.word("message name");
  scan.expect(':');
  const std::int64_t length = scan.integer("message length in bytes");
  if (length < 0 || length > 64) {
    scan.fail("message '" + message.name + "' has " + std::to_string(length) + " bytes; a CAN FD frame holds 0 to 64");
  }
  message.length = static_cast<int>(length);
  message.fd = length > 8;
  for (const DbcMessage& other : dbc.messages) {
    if (other.name == message.name || other.id == message.id) {
      scan.fail("message '" + message.name + "' has the " + (other.name == message.name ? "name" : "identifier") +
                " of message '" + other.name + "' in line " + std::to_string(other.line));
    }
  }
  dbc.messages.push_back(std::move(message));
}

// M: the multiplexer; m3: present when the multiplexer is 3; m3M: both.
void parse_multiplexing(std::string_view word, DbcSignal& signal, DbcScanner& scan) {
  if (word.back() == 'M') {
    signal.multiplexer = true;
    word.remove_suffix(1);
  }
  if (word.empty()) return;
  const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size(), signal.multiplexed);
  if (word.front() != 'm' || error != std::errc() || end != word.data() + word.size() || signal.multiplexed < 0) {
    scan.fail("signal '" + signal.name + "': ':', 'M' or 'm' and a number expected after the name");
  }
}

void parse_signal(DbcMessage& message, DbcScanner& scan, int line) {
  DbcSignal signal;
  signal.line = line;
  signal.name = scan.word("signal name");
  if (!scan.accept(':')) {
    parse_multiplexing(scan.word("':'"), signal, scan);
    scan.expect(':');
  }
  const std::int64_t start = scan.integer("start bit");
  scan.expect('|');
  const std::int64_t length = scan.integer("length in bits");
  scan.expect('@');
  const std::int64_t order = scan.integer("byte order (0 Motorola, 1 Intel)");
  if (order != 0 && order != 1) scan.fail("signal '" + signal.name + "': byte order is 0 (Motorola) or 1 (Intel)");
  if (scan.accept('-')) {
    signal.type = ValueType::signed_integer;
  } else {
    scan.expect('+');
  }
  scan.expect('(');
  signal.factor = scan.number("factor");
  scan.expect(',');
  signal.offset = scan.number("offset");
  scan.expect(')');
  scan.expect('[');
  signal.minimum = scan.number("minimum");
  scan.expect('|');
  signal.maximum = scan.number("maximum");
  scan.expect(']');
  signal.unit = scan.quoted("unit");

  if (message.name == kIndependentSignals) return;
  if (length < 1 || length > 64) {
    scan.fail("signal '" + signal.name + "' is " + std::to_string(length) + " bits long; 1 to 64 are possible");
  }
  if (start < 0 || start > 511) scan.fail("signal '" + signal.name + "': start bit is 0 to 511");
  if (signal.factor == 0.0) scan.fail("signal '" + signal.name + "': factor 0 leaves nothing of the signal");
  signal.bits = {static_cast<std::uint16_t>(start), static_cast<std::uint8_t>(length), order == 1};
  if (end_bit(signal.bits) > 8 * message.length) {
    scan.fail("signal '" + signal.name + "' reaches beyond the " + std::to_string(message.length) +
              " bytes of message '" + message.name + "'");
  }
  if (const DbcSignal* other = message.find(signal.name); other != nullptr) {
    scan.fail("signal '" + signal.name + "' is already in line " + std::to_string(other->line));
  }
  message.signals.push_back(std::move(signal));
}

DbcMessage* message_of(Dbc& dbc, DbcScanner& scan) {
  const std::int64_t id = scan.integer("message identifier");
  const auto found = std::find_if(dbc.messages.begin(), dbc.messages.end(),
                                  [id](const DbcMessage& m) { return static_cast<std::int64_t>(m.id) == id; });
  return found != dbc.messages.end() ? &*found : nullptr;
}

DbcSignal* signal_of(Dbc& dbc, DbcScanner& scan) {
  DbcMessage* message = message_of(dbc, scan);
  const std::string_view name = scan.word("signal name");
  return message != nullptr ? const_cast<DbcSignal*>(message->find(name)) : nullptr;
}

void parse_value_type(Dbc& dbc, DbcScanner& scan) {
  DbcSignal* signal = signal_of(dbc, scan);
  scan.accept(':');  // some writers leave it out
  const std::int64_t type = scan.integer("value type (0 integer, 1 float, 2 double)");
  if (type < 0 || type > 2) scan.fail("value type is 0 (integer), 1 (float) or 2 (double)");
  if (signal == nullptr || type == 0) return;
  if (signal->bits.length != 32 * type) {
    scan.fail("signal '" + signal->name + "' is " + std::to_string(signal->bits.length) + " bits long; a " +
              (type == 1 ? "float has 32" : "double has 64"));
  }
  signal->type = type == 1 ? ValueType::float32 : ValueType::float64;
}

void parse_value_names(Dbc& dbc, DbcScanner& scan) {
  if (!scan.next_is_digit()) return;  // of an environment variable
  DbcSignal* signal = signal_of(dbc, scan);
  while (!scan.accept(';')) {
    const std::int64_t value = scan.integer("value");
    std::string name = scan.quoted("name of the value");
    if (signal != nullptr) signal->value_names.emplace_back(value, std::move(name));
  }
}

void parse_comment(Dbc& dbc, DbcScanner& scan) {
  std::string unused;  // comments on the file, on nodes and on variables
  std::string* comment = &unused;
  if (!scan.next_is('"')) {
    const std::string_view kind = scan.word("BO_, SG_, BU_ or EV_");
    if (kind == "BO_") {
      if (DbcMessage* message = message_of(dbc, scan); message != nullptr) comment = &message->comment;
    } else if (kind == "SG_") {
      if (DbcSignal* signal = signal_of(dbc, scan); signal != nullptr) comment = &signal->comment;
    } else {
      scan.word("name");
    }
  }
  *comment = scan.quoted("comment");
  scan.expect(';');  // a quote left open would swallow the lines after it
}

void parse_attribute(Dbc& dbc, DbcScanner& scan) {
  const std::string name = scan.quoted("attribute name");
  if (name != "VFrameFormat" && name != "GenMsgCycleTime") return;
  if (scan.word("BO_") != "BO_") scan.fail("attribute " + name + " belongs to a message (BO_)");
  DbcMessage* message = message_of(dbc, scan);
  const std::int64_t value = scan.integer("attribute value");
  if (message == nullptr) return;
  if (name == "VFrameFormat") {
    message->fd = message->fd || value == 14 || value == 15;  // StandardCAN_FD, ExtendedCAN_FD
  } else if (value >= 0 && value <= 3'600'000) {
    message->cycle_time_ms = static_cast<int>(value);
  }
}

// The statements whose quoted text may go on in the next lines. In a message or signal a quote left open is an error of
// that line and must not swallow the next ones.
bool may_span_lines(std::string_view text) {
  return text.starts_with("CM_") || text.starts_with("BA_") || text.starts_with("VAL_");
}

// Takes one statement from the text: a line, and those after it for as long as a quote is open. Counts its lines.
std::string_view take_statement(std::string_view& text, int& lines) {
  const bool may_span = may_span_lines(text);
  bool in_quotes = false;
  std::size_t end = 0;
  lines = 0;
  for (; end < text.size(); ++end) {
    if (text[end] == '"' && !(in_quotes && text[end - 1] == '\\')) in_quotes = !in_quotes;
    if (text[end] != '\n') continue;
    ++lines;
    if (!in_quotes || !may_span) break;
  }
  const std::string_view statement = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return statement;
}

void parse_statement(Dbc& dbc, std::string_view statement, int line) {
  const std::size_t from = statement.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return;
  const std::size_t to = std::min(statement.find_first_of(" \t\r\":;", from), statement.size());
  const std::string_view keyword = statement.substr(from, to - from);
  DbcScanner scan(statement.substr(to), dbc.file, line);
  if (from > 0 && (keyword != "SG_" || scan.at_end())) return;  // the list of keywords under NS_

  if (keyword == "BO_") {
    parse_message(dbc, scan, line);
  } else if (keyword == "SG_") {
    if (dbc.messages.empty()) scan.fail("a signal (SG_) stands before the first message (BO_)");
    parse_signal(dbc.messages.back(), scan, line);
  } else if (keyword == "SIG_VALTYPE_") {
    parse_value_type(dbc, scan);
  } else if (keyword == "VAL_") {
    parse_value_names(dbc, scan);
  } else if (keyword == "CM_") {
    parse_comment(dbc, scan);
  } else if (keyword == "BA_") {
    parse_attribute(dbc, scan);
  } else if (std::find(kNotNeeded.begin(), kNotNeeded.end(), keyword) == kNotNeeded.end()) {
    dbc.warnings.push_back(dbc.file + ":" + std::to_string(line) + ": '" + std::string(keyword.substr(0, 40)) +
                           "' is not known and passed over");
  }
}

}  // namespace

const DbcSignal* DbcMessage::find(std::string_view signal) const {
  const auto found =
      std::find_if(signals.begin(), signals.end(), [signal](const DbcSignal& s) { return s.name == signal; });
  return found != signals.end() ? &*found : nullptr;
}

const DbcMessage* Dbc::find(std::string_view message) const {
  const auto found =
      std::find_if(messages.begin(), messages.end(), [message](const DbcMessage& m) { return m.name == message; });
  return found != messages.end() ? &*found : nullptr;
}

Dbc parse_dbc(std::string_view text, const std::string& file) {
  Dbc dbc;
  dbc.file = file;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the mark some editors put before UTF-8
  for (int line = 1, lines = 0; !text.empty(); line += lines) {
    const std::string_view statement = take_statement(text, lines);
    parse_statement(dbc, statement, line);
  }
  if (dbc.messages.empty()) throw InputError(file, 0, "no message (BO_) in this file; is it a DBC file?");
  return dbc;
}

Dbc read_dbc(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw InputError(file.string(), 0, "is a folder, not a DBC file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), 0, std::string("cannot be opened: ") + std::strerror(errno));
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return parse_dbc(text, file.string());
}

}  // namespace stillcut
