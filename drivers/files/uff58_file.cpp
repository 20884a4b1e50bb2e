#include "drivers/files/uff58_file.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "drivers/files/input_error.hpp"
#include "drivers/files/uff_numbers.hpp"

namespace stillcut {
namespace {

constexpr int kHeaderLines = 11;

// How the numbers of a function stand in its data: the same in text and binary but for their width.
struct Layout {
  std::size_t points = 0;
  bool complex = false, double_precision = false, even = false;

  [[nodiscard]] std::size_t in_point() const { return (even ? 0U : 1U) + (complex ? 2U : 1U); }
  // Columns of a line of text, again and again.
  [[nodiscard]] std::vector<std::size_t> widths() const {
    if (!double_precision) return {13};
    if (even) return {20};
    return complex ? std::vector<std::size_t>{13, 20, 20} : std::vector<std::size_t>{13, 20};
  }
};

class UffReader {
 public:
  UffReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  UffFile read() {
    UffFile content;
    bool any = false;
    std::string_view line;
    while (next_line(line)) {
      if (uff_bare(line).empty()) continue;
      if (!is_delimiter(line)) fail(line_, "is no -1, which begins a dataset; give a universal file");
      const int begin = line_;
      if (!next_line(line)) fail(begin, "begins a dataset that is not there; is the file whole?");
      any = true;
      read_dataset(content, line, begin);
    }
    if (!any) fail(0, "has no dataset; a universal file begins with -1");
    return content;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& message) const { throw InputError(file_, line, message); }

  bool next_line(std::string_view& line) {
    if (bytes_.empty()) return false;
    const auto end = std::min(bytes_.find('\n'), bytes_.size());
    line = bytes_.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    bytes_.remove_prefix(std::min(end + 1, bytes_.size()));
    ++line_;
    return true;
  }

  std::string_view line_of(const char* what) {
    std::string_view line;
    if (!next_line(line)) fail(line_, std::string("ends before ") + what + "; is the file whole?");
    return line;
  }

  // In the first six columns: further on a dataset may have a -1 of its own.
  static bool is_delimiter(std::string_view line) {
    return uff_bare(line.substr(0, 6)) == "-1" && uff_bare(line).size() == 2;
  }

  void read_dataset(UffFile& content, std::string_view head, int begin) {
    const std::string number(field(head, 0, 6));
    const bool binary = head.size() > 6 && (head[6] == 'b' || head[6] == 'B');
    if (number == "58") {
      content.functions.push_back(read_function(head, binary, begin));
      return;
    }
    if (number == "164") {
      read_units(content, begin);
    } else if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos) {
      fail(line_, "\"" + number + "\" is no number of a dataset");
    }
    std::string_view line;
    do line = line_of("the -1 that ends its dataset");
    while (!is_delimiter(line));
  }

  static std::string_view field(std::string_view line, std::size_t begin, std::size_t width) {
    return begin < line.size() ? uff_bare(line.substr(begin, width)) : std::string_view();
  }

  // Up to 80 columns of a writer's own words; a stray carriage return would break a line when written.
  static std::string words(std::string_view text) {
    std::string result(uff_bare(text.substr(0, 80)));
    std::replace(result.begin(), result.end(), '\r', ' ');
    return result;
  }

  // A field that is left empty is 0.
  int whole(std::string_view line, std::size_t begin, std::size_t width, const char* name) const {
    const std::string_view text = field(line, begin, width);
    if (text.empty()) return 0;
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      fail(line_, std::string(name) + ": \"" + std::string(text) + "\" is no whole number in its columns");
    return value;
  }

  double real(std::string_view line, std::size_t begin, std::size_t width, const char* name) const {
    const std::string_view text = field(line, begin, width);
    if (text.empty()) return 0.0;
    const std::optional<double> value = fortran_number(text);
    if (!value) fail(line_, std::string(name) + ": \"" + std::string(text) + "\" is no number in its columns");
    return *value;
  }

  void read_units(UffFile& content, int begin) {
    UffUnits units;
    const std::string_view name = line_of("the units");
    units.code = whole(name, 0, 10, "units code");
    units.description = words(field(name, 10, 20));
    units.line = begin;
    const std::string_view factors = line_of("the factors of the units");
    units.length = real(factors, 0, 25, "factor of length");
    units.force = real(factors, 25, 25, "factor of force");
    if (!(units.length > 0.0 && units.force > 0.0)) fail(line_, "factors of length and force must be above 0");
    if (content.units && (content.units->length != units.length || content.units->force != units.force))
      fail(begin, "gives other units than line " + std::to_string(content.units->line) + "; leave one of the two");
    content.units = units;
  }

  UffAxis read_axis(const char* what) {
    const std::string_view line = line_of(what);
    return {whole(line, 0, 10, what), words(field(line, 26, 20)), words(field(line, 47, 20))};
  }

  UffFunction read_function(std::string_view head, bool binary, int begin) {
    const int head_at = line_;
    UffFunction function;
    function.line = begin;
    for (std::string& text : function.id) text = words(line_of("the five lines of text"));
    const std::string_view place = line_of("the record of its nodes");
    function.type = whole(place, 0, 5, "function type");
    function.response_node = whole(place, 41, 10, "response node");
    function.response_direction = whole(place, 51, 4, "response direction");
    function.reference_node = whole(place, 66, 10, "reference node");
    function.reference_direction = whole(place, 76, 4, "reference direction");
    const std::string_view form = line_of("the record of its data's form");
    const Layout layout = read_layout(form);
    function.complex = layout.complex;
    function.double_precision = layout.double_precision;
    function.even = layout.even;
    const double first = real(form, 30, 13, "begin of the abscissa"), step = real(form, 43, 13, "step of the abscissa");
    if (layout.even && !(step > 0.0) && layout.points > 1) fail(line_, "step of the abscissa: must be above 0");
    if (layout.even && !std::isfinite(first + static_cast<double>(layout.points - 1) * step))
      fail(line_, "step of the abscissa: leads to a number that is not finite");
    function.abscissa_axis = read_axis("its abscissa");
    function.ordinate = read_axis("its ordinate");
    function.denominator = read_axis("its ordinate's denominator");
    (void)read_axis("its z axis");
    const std::vector<double> numbers = binary ? read_binary(head, head_at, layout, begin) : read_text(layout, begin);
    std::size_t next = 0;
    for (std::size_t i = 0; i < layout.points; ++i) {
      function.abscissa.push_back(layout.even ? first + static_cast<double>(i) * step : numbers[next++]);
      const double real_part = numbers[next++];
      function.values.emplace_back(real_part, layout.complex ? numbers[next++] : 0.0);
    }
    return function;
  }

  Layout read_layout(std::string_view line) const {
    Layout layout;
    const int type = whole(line, 0, 10, "ordinate data type"), points = whole(line, 10, 10, "number of points");
    const int spacing = whole(line, 20, 10, "abscissa spacing");
    if (type != 2 && type != 4 && type != 5 && type != 6)
      fail(line_, "ordinate data type: must be 2 or 4, real, or 5 or 6, complex");
    if (points < 1) fail(line_, "number of points: must be from 1 up");
    if (spacing != 0 && spacing != 1) fail(line_, "abscissa spacing: must be 1, even, or 0, uneven");
    layout.points = static_cast<std::size_t>(points);
    layout.complex = type >= 5;
    layout.double_precision = type == 4 || type == 6;
    layout.even = spacing == 1;
    if (layout.points > bytes_.size()) fail(line_, "number of points: are more than the file has bytes; is it whole?");
    return layout;
  }

  std::vector<double> read_text(const Layout& layout, int begin) {
    const std::size_t wanted = layout.points * layout.in_point();
    const std::vector<std::size_t> widths = layout.widths();
    std::vector<double> numbers;
    while (numbers.size() < wanted) {
      std::string_view line;
      if (!next_line(line) || is_delimiter(line))
        fail(line_, "ends the function of line " + std::to_string(begin) + " after " +
                        std::to_string(numbers.size() / layout.in_point()) + " of " + std::to_string(layout.points) +
                        " points; is the file whole?");
      if (const std::string wrong = add_uff_numbers(line, widths, numbers); !wrong.empty())
        fail(line_, "\"" + wrong + "\" is no number of the data");
    }
    std::string_view line;
    if (numbers.size() > wanted || !next_line(line) || !is_delimiter(line))
      fail(line_, "the function of line " + std::to_string(begin) + " does not end with -1 after its " +
                      std::to_string(layout.points) + " points; mend their number or the data");
    return numbers;
  }

  // Where the dataset that ends here is over: behind a line of -1 in its very columns, a line feed before it or not;
  // empty where it is not there.
  static std::optional<std::size_t> end_of_dataset(std::string_view rest) {
    const auto at = std::min(rest.find_first_not_of("\r\n"), rest.size());
    const auto line_end = std::min(rest.find('\n', at), rest.size());
    const std::string_view line = rest.substr(at, line_end - at);
    if (!line.starts_with("    -1") || !is_delimiter(line)) return {};
    return std::min(line_end + 1, rest.size());
  }

  std::vector<double> read_binary(std::string_view head, int head_at, const Layout& layout, int begin) {
    const auto in_head = [&](std::size_t at, std::size_t width) { return field(head, at, width); };
    const bool little = in_head(7, 6) == "1";
    if (!little && in_head(7, 6) != "2") fail(head_at, "byte ordering: must be 1, little, or 2, big endian");
    if (in_head(13, 6) != "2") fail(head_at, "floating-point format: must be 2, IEEE 754");
    if (in_head(19, 12) != std::to_string(kHeaderLines)) fail(head_at, "number of lines before the data: must be 11");
    const std::size_t value = layout.double_precision ? 8 : 4, in_values = (layout.complex ? 2 : 1) * value;
    // What the head tells first, then the smaller: that its end stands within the data of the larger is as good as
    // impossible.
    std::array<std::size_t, 2> widths{layout.even ? 0U : 4U, layout.even ? 0 : value};
    if (in_head(31, 12) == std::to_string(layout.points * (widths[1] + in_values))) std::swap(widths[0], widths[1]);
    for (const std::size_t abscissa : widths) {
      const std::size_t size = layout.points * (abscissa + in_values);
      if (size > bytes_.size()) continue;
      const std::optional<std::size_t> end = end_of_dataset(bytes_.substr(size));
      if (!end) continue;
      std::vector<double> numbers;
      std::string_view data = bytes_.substr(0, size);
      while (!data.empty()) {
        if (abscissa > 0) numbers.push_back(take(data, abscissa, little));
        for (std::size_t taken = 0; taken < in_values; taken += value) numbers.push_back(take(data, value, little));
      }
      for (const double number : numbers)
        if (!std::isfinite(number)) fail(begin, "the function that begins here has a number that is not finite");
      line_ +=
          static_cast<int>(std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size + *end), '\n'));
      bytes_.remove_prefix(size + *end);
      return numbers;
    }
    fail(begin, "the data of the function that begins here do not end with -1 after its " +
                    std::to_string(layout.points) + " points; is the file whole?");
  }

  static double take(std::string_view& data, std::size_t size, bool little) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i)
      bits |= std::uint64_t{static_cast<unsigned char>(data[little ? i : size - 1 - i])} << (8 * i);
    data.remove_prefix(size);
    if (size == 8) return std::bit_cast<double>(bits);
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  }

  std::string_view bytes_;
  const std::string& file_;
  int line_ = 0;
};

}  // namespace

UffFile parse_uff(std::string_view bytes, const std::string& file) { return UffReader(bytes, file).read(); }

}  // namespace stillcut
