// Universal files: what the published formats say is read, what we wrote is read by the formats' own columns, what is
// spoilt is refused.
#include "drivers/files/uff58_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/frf_cases.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

const std::string kUnitsSet =
    "    -1\n   164\n         5mm (milli newton)           2\n"
    "  1.00000000000000000D+03  1.00000000000000000D+03  1.00000000000000000D+00\n"
    "  2.73149999999999977D+02\n    -1\n";

// The eleven records before the data, by hand; `form` is the seventh.
std::string head_of(const std::string& form, const std::string& mark = "    58") {
  return "    -1\n" + mark +
         "\naccelerance of the tool\nNONE\n01-Mar-24 10:11:12\nNONE\nNONE\n"
         "    4        12    0         0 Tool point        7  -2 Tool point        7   1\n" +
         form +
         "        18    0    0    0 Frequency            Hz                  \n"
         "        12    1    0    0 Acceleration         m/s^2               \n"
         "        13    0    1    0 Force                N                   \n"
         "         0    0    0    0 NONE                 NONE                \n";
}

std::string form_of(int type, int points, int even, const char* begin = "  0.00000E+00",
                    const char* step = "  0.00000E+00") {
  char text[80];
  std::snprintf(text, sizeof text, "%10d%10d%10d%s%s  0.00000E+00\n", type, points, even, begin, step);
  return text;
}

const UffFunction& only_function(const UffFile& content) {
  EXPECT_EQ(content.functions.size(), 1U);
  return content.functions.front();
}

// Columns that touch, D for E, a dataset of another kind before, CRLF. Fails with a column, place or part that is off.
TEST(UffFile, OfTheFormatIsRead) {
  std::string text = "    -1     \n   151     \nany model\nby any program\n         0        -1\n        -1\n    -1\n" +
                     kUnitsSet + head_of(form_of(5, 4, 1, "  1.00000E+01", "  2.50000E-01")) +
                     " -1.00000E+00-2.00000E+00  3.00000E-03  4.00000D-03 -5.00000E+10  6.00000E-10\n"
                     "  7.00000E+00  8.00000E+00\n    -1\n";
  for (const bool carriage_return : {false, true}) {
    if (carriage_return)
      for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, 1, '\r');
    const UffFile content = parse_uff(text, "a.uff");
    ASSERT_TRUE(content.units);
    EXPECT_EQ(content.units->code, 5);
    EXPECT_EQ(content.units->description, "mm (milli newton)");
    EXPECT_EQ(content.units->length, 1000.0);
    EXPECT_EQ(content.units->force, 1000.0);
    const UffFunction& f = only_function(content);
    EXPECT_EQ(f.line, 14);
    EXPECT_EQ(f.id[0], "accelerance of the tool");
    EXPECT_EQ(f.id[2], "01-Mar-24 10:11:12");
    EXPECT_EQ(f.type, kUffFrequencyResponse);
    EXPECT_EQ(f.response_node, 7);
    EXPECT_EQ(f.response_direction, -2);
    EXPECT_EQ(f.reference_node, 7);
    EXPECT_EQ(f.reference_direction, 1);
    EXPECT_EQ(f.ordinate.data_type, kUffAcceleration);
    EXPECT_EQ(f.ordinate.units, "m/s^2");
    EXPECT_EQ(f.denominator.data_type, kUffExcitationForce);
    EXPECT_EQ(f.abscissa, (std::vector<double>{10.0, 10.25, 10.5, 10.75}));
    EXPECT_EQ(f.values, (std::vector<std::complex<double>>{{-1, -2}, {3e-3, 4e-3}, {-5e10, 6e-10}, {7, 8}}));
  }
}

// Every kind of number that the format has, text first.
TEST(UffFile, OfEveryKindOfNumberIsRead) {
  using Values = std::vector<std::complex<double>>;
  const auto read = [](int type, int even, const std::string& data) {
    const std::string form = form_of(type, 2, even, "  5.00000E+00", "  1.00000E+00");
    return only_function(parse_uff(head_of(form) + data + "    -1\n", "a.uff"));
  };
  EXPECT_EQ(read(2, 1, "  1.00000E+00  2.00000E+00\n").values, (Values{1, 2}));
  EXPECT_EQ(read(4, 1, "  1.000000000001E+00  2.000000000000-100\n").values, (Values{1.000000000001, 2e-100}));
  EXPECT_EQ(read(6, 1, "  1.000000000000E+00 -2.000000000000E+00  3.000000000000E+00  4.000000000000E+00\n").values,
            (Values{{1, -2}, {3, 4}}));
  const UffFunction real = read(4, 0, "  8.00000E+00  1.000000000000E+00  9.50000E+00 -2.000000000000E+00\n");
  EXPECT_EQ(real.abscissa, (std::vector<double>{8.0, 9.5}));
  EXPECT_EQ(real.values, (Values{1, -2}));
  const UffFunction complex = read(
      6, 0,
      "  8.00000E+00 -1.000000000000E+00 -2.000000000000E+00\n  9.50000E+00  3.000000000000E+00  4.000000000000E+00\n");
  EXPECT_EQ(complex.abscissa, (std::vector<double>{8.0, 9.5}));
  EXPECT_EQ(complex.values, (Values{{-1, -2}, {3, 4}}));
}

template <class Number>
void append(std::string& bytes, Number number, bool little) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  if (little != (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof number);
  bytes.append(raw, sizeof number);
}

// By hand, in both orders; the size that the head tells is wrong, as one common writer has it.
TEST(UffFile, OfBinaryNumbersIsRead) {
  for (const bool little : {true, false}) {
    const std::string mark = std::string("    58b     ") + (little ? "1" : "2") +
                             "     2          11          16     0     0           0           0";
    std::string doubles, floats, mixed;
    for (const double x : {1.5, -2.25, 1e-9, 4.0}) append(doubles, x, little);
    for (const double x : {1.5, -2.25, 0.5, 4.0}) append(floats, static_cast<float>(x), little);
    for (const double x : {8.0, 9.5}) {  // abscissa in single, values in double precision
      append(mixed, static_cast<float>(x), little);
      for (const double y : {x + 0.1, -x}) append(mixed, y, little);
    }
    for (const char* before_end : {"", "\n", "\r\n"}) {
      const auto read = [&](int type, int even, const std::string& data) {
        const std::string form = form_of(type, 2, even, "  5.00000E+00", "  1.00000E+00");
        return parse_uff(head_of(form, mark) + data + before_end + "    -1\n" + kUnitsSet, "a.uff");
      };
      const UffFile both = read(6, 1, doubles);
      EXPECT_EQ(only_function(both).values, (std::vector<std::complex<double>>{{1.5, -2.25}, {1e-9, 4.0}}));
      EXPECT_TRUE(both.units);  // what follows is found
      EXPECT_EQ(only_function(read(5, 1, floats)).values,
                (std::vector<std::complex<double>>{{1.5, -2.25}, {0.5, 4.0}}));
      EXPECT_EQ(only_function(read(4, 0, doubles)).abscissa, (std::vector<double>{1.5, 1e-9}));
      const UffFunction uneven = only_function(read(6, 0, mixed));
      EXPECT_EQ(uneven.abscissa, (std::vector<double>{8.0, 9.5}));
      EXPECT_EQ(uneven.values, (std::vector<std::complex<double>>{{8.1, -8.0}, {9.6, -9.5}}));
    }
  }
}

// Rows of twelve bytes, whose abscissa is in single precision, would end where this value looks like the dataset's end.
TEST(UffFile, OfBinaryNumbersIsOfTheSizeThatItsHeadTells) {
  std::string data;
  for (const double x : {1.0, 2.0, 3.0}) append(data, x, true);
  const std::string looks_like_the_end = "    -1\n ";
  double value = 0.0;
  std::memcpy(&value, looks_like_the_end.data(), sizeof value);
  const std::string mark = "    58b     1     2          11          32     0     0           0           0";
  const UffFile content = parse_uff(head_of(form_of(4, 2, 0), mark) + data + looks_like_the_end + "    -1\n", "a.uff");
  EXPECT_EQ(only_function(content).abscissa, (std::vector<double>{1.0, 3.0}));
  EXPECT_EQ(only_function(content).values[1], value);
}

// Heads as catman and others write them: three digits of exponent, blanks up to another width, none filled columns.
TEST(UffFile, OfAnInstrumentsHabitsIsRead) {
  const std::string blanks(66, ' ');
  const std::string text = "    -1  " + blanks + "\n    58  " + blanks + "\n1x : m/s\xC2\xB2" + blanks +
                           "\nUFF58 file created by HBM catman\n30-Apr-20 19:12:52\n" + std::string(200, 'x') +
                           "\nNO\rNE\n"
                           "    1         0    0         0 NONE               0   0 NONE               0   0\n"
                           "         2         3         1 0.00000E+000 5.00000E-005 0.00000E+000           \n"
                           "        17    0    0    0 Time                 s                                \n"
                           "         1    0    0    0 1x                   m/s\xC2\xB2                             \n"
                           "         0    0    0    0 NONE                 NONE                             \n"
                           "         0    0    0    0 NONE                 NONE                             \n"
                           " -3.81956E+00 -3.56616E+00 -2.98987E+00" +
                           blanks + "\n    -1" + blanks + "\n";
  const UffFunction function = only_function(parse_uff(text, "a.uff"));
  EXPECT_EQ(function.type, 1);
  EXPECT_EQ(function.abscissa, (std::vector<double>{0.0, 5e-5, 1e-4}));
  EXPECT_EQ(function.values, (std::vector<std::complex<double>>{-3.81956, -3.56616, -2.98987}));
  EXPECT_EQ(function.id[3], std::string(80, 'x'));
  EXPECT_EQ(function.id[4], "NO NE");
  EXPECT_EQ(function.ordinate.units, "m/s\xC2\xB2");
}

UffFile random_content(std::mt19937_64& random) {
  const auto flip = [&] { return std::uniform_int_distribution<>(0, 1)(random) == 1; };
  UffFile content;
  if (flip()) content.units = UffUnits{.code = 9, .description = "ours", .length = 39.37, .force = 0.2248, .line = 1};
  for (int n = std::uniform_int_distribution<>(1, 3)(random); n > 0; --n) {
    const FrequencyResponse response = random_response(random);
    UffFunction function;
    function.id[0] = "function";
    function.id[4] = std::string(80, 'x');
    function.response_node = 123456789;
    function.reference_node = -5;
    function.response_direction = 3;
    function.reference_direction = -1;
    function.complex = flip();
    function.double_precision = flip();
    function.abscissa_axis = {kUffFrequency, "Frequency", "Hz"};
    function.ordinate = {kUffVelocity, "a label of 20 letter", "mm/s"};
    function.abscissa = response.frequencies_hz;
    for (const auto& row : response.receptance)
      for (const ComplexValues& entry : row)
        if (!entry.empty()) function.values = entry;
    for (auto& value : function.values) {
      if (!function.double_precision) value = {static_cast<float>(value.real()), static_cast<float>(value.imag())};
      if (!function.complex) value = value.real();
    }
    if (!function.double_precision)
      for (double& x : function.abscissa) x = static_cast<float>(x);
    content.functions.push_back(function);
  }
  return content;
}

std::string written(const UffFile& content, UffForm form) {
  std::ostringstream out;
  write_uff(out, content, form);
  return out.str();
}

// `digits` of them must be the same.
bool same_number(double a, double b, int digits) { return std::abs(a - b) <= std::pow(10.0, 1 - digits) * std::abs(b); }

TEST(UffFile, ComesBackInBinaryToTheLastBitAndInTextToItsDigits) {
  std::mt19937_64 random(2);
  for (int n = 0; n < 400; ++n) {
    const UffFile content = random_content(random);
    for (const UffForm form : {UffForm::binary, UffForm::text}) {
      const UffFile back = parse_uff(written(content, form), "a.uff");
      ASSERT_EQ(back.units.has_value(), content.units.has_value());
      if (back.units) {
        ASSERT_EQ(back.units->length, content.units->length);
      }
      ASSERT_EQ(back.functions.size(), content.functions.size());
      for (std::size_t f = 0; f < back.functions.size(); ++f) {
        const UffFunction &a = back.functions[f], &b = content.functions[f];
        ASSERT_EQ(a.id[4], b.id[4]);
        ASSERT_EQ(a.response_node, b.response_node);
        ASSERT_EQ(a.reference_node, b.reference_node);
        ASSERT_EQ(a.reference_direction, b.reference_direction);
        ASSERT_EQ(a.ordinate.label, b.ordinate.label);
        ASSERT_EQ(a.ordinate.units, b.ordinate.units);
        ASSERT_EQ(a.complex, b.complex);
        ASSERT_EQ(a.double_precision, b.double_precision);
        ASSERT_EQ(a.values.size(), b.values.size());
        if (form == UffForm::binary) {
          ASSERT_EQ(a.abscissa, b.abscissa);
          ASSERT_EQ(a.values, b.values);
          continue;
        }
        for (std::size_t i = 0; i < a.values.size(); ++i) {
          ASSERT_TRUE(same_number(a.abscissa[i], b.abscissa[i], 6));
          ASSERT_TRUE(same_number(a.values[i].real(), b.values[i].real(), b.double_precision ? 13 : 6));
          ASSERT_TRUE(same_number(a.values[i].imag(), b.values[i].imag(), b.double_precision ? 13 : 6));
        }
      }
    }
  }
}

// What we write, by the columns of the published format and nothing else. Fails where a field is shifted.
TEST(UffFile, IsWrittenInTheColumnsOfTheFormat) {
  UffFile content{.units = UffUnits{}, .functions = {UffFunction{}}};
  UffFunction& f = content.functions[0];
  f.response_node = f.reference_node = 1;
  f.response_direction = 1;
  f.reference_direction = -3;
  f.ordinate = {kUffDisplacement, "Displacement", "m"};
  f.abscissa = {1.0, 1.5, 2.0};
  f.values = {{1e-7, -2e-7}, {3e-7, 4e-7}, {5e-7, -1.23456789012345e-101}};
  std::vector<std::string> lines;
  std::istringstream text(written(content, UffForm::text));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 22U);
  EXPECT_EQ(lines[0], "    -1");
  EXPECT_EQ(lines[1].substr(0, 6), "   164");
  EXPECT_EQ(std::stod(lines[3].substr(25, 25)), 1.0);
  EXPECT_EQ(lines[5], "    -1");
  EXPECT_EQ(lines[7], "    58");
  EXPECT_EQ(std::stoi(lines[13].substr(0, 5)), 4);
  EXPECT_EQ(std::stoi(lines[13].substr(41, 10)), 1);
  EXPECT_EQ(std::stoi(lines[13].substr(51, 4)), 1);
  EXPECT_EQ(std::stoi(lines[13].substr(76, 4)), -3);
  EXPECT_EQ(std::stoi(lines[14].substr(0, 10)), 6);
  EXPECT_EQ(std::stoi(lines[14].substr(10, 10)), 3);
  EXPECT_EQ(std::stoi(lines[14].substr(20, 10)), 1);
  EXPECT_EQ(std::stod(lines[14].substr(30, 13)), 1.0);
  EXPECT_EQ(std::stod(lines[14].substr(43, 13)), 0.5);
  EXPECT_EQ(std::stoi(lines[16].substr(0, 10)), 8);
  EXPECT_EQ(lines[16].substr(26, 12), "Displacement");
  EXPECT_EQ(lines[16].substr(47, 2), "m ");
  ASSERT_EQ(lines[19].size(), 80U);  // 4E20.12
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(std::stod(lines[19].substr(20 * i, 20)), (std::array{1e-7, -2e-7, 3e-7, 4e-7}[i]));
  EXPECT_EQ(std::stod(lines[20].substr(20, 20)), -1.234567890123e-101);
  EXPECT_EQ(lines[21], "    -1");
  const std::string binary = written(content, UffForm::binary);
  const auto mark = binary.find("    58b");
  EXPECT_EQ(binary.substr(mark, 80),
            "    58b     1     2          11          48     0     0           0           0\n");
  double first[2];
  std::memcpy(first, binary.data() + binary.size() - 7 - 48, 16);
  if (std::endian::native == std::endian::little) {
    EXPECT_EQ(first[1], -2e-7);
  }
}

TEST(UffFile, NamesFileAndLineOfWhatIsWrong) {
  const std::string data = "  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00\n", end = "    -1\n";
  const std::string form = form_of(5, 2, 1, "  5.00000E+00", "  1.00000E+00"), sound = head_of(form) + data + end;
  EXPECT_EQ(only_function(parse_uff(sound, "a.uff")).values.size(), 2U);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = sound;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string mark = "    58b     1     2          11          16     0     0           0           0";
  const std::pair<std::string, std::string> cases[] = {
      {"", "a.uff: has no dataset"},
      {"frequency_hz\n", "a.uff:1: is no -1"},
      {"    -1\n", "a.uff:1: begins a dataset that is not there"},
      {"    -1\n   abc\n    -1\n", "a.uff:2: \"abc\" is no number of a dataset"},
      {"    -1\n    15\n 1 2 3\n", "a.uff:3: ends before the -1"},
      {sound.substr(0, sound.find("01-Mar")), "a.uff:4: ends before the five lines"},
      {sound.substr(0, sound.find("        13 ")), "a.uff:11: ends before its ordinate's denominator"},
      {with(form, form_of(3, 2, 1)), "a.uff:9: ordinate data type"},
      {with(form, form_of(5, 0, 1)), "a.uff:9: number of points"},
      {with(form, form_of(5, 2000000000, 1)), "a.uff:9: number of points: are more than"},
      {with(form, form_of(5, 2, 2)), "a.uff:9: abscissa spacing"},
      {with(form, form_of(5, 2, 1)), "a.uff:9: step of the abscissa"},
      {with(form, form_of(5, 3, 1, "  5.00000E+00", "  1.00000E+00")),
       "a.uff:15: ends the function of line 1 after 2 of 3 points"},
      {with(form, form_of(5, 1, 1)), "a.uff:14: the function of line 1 does not end with -1 after its 1 points"},
      {with(data, data.substr(0, 20)), "a.uff:14"},
      {with("3.00000E+00", "3.0000xE+00"), "a.uff:14: \"3.0000xE+00\" is no number"},
      {with("3.00000E+00", "        NaN"), "a.uff:14: \"NaN\" is no number"},
      {with("3.00000E+00", "***********"), "a.uff:14"},
      {with("   7  -2", "   7  up"), "a.uff:8: response direction"},
      {kUnitsSet + "    -1\n   164\n         1SI                           2\n 1. 1. 1.\n    -1\n", "a.uff:10"},
      {kUnitsSet + "    -1\n   164\n         1SI                           2\n  1.00000000000000000D+00  "
                   "1.00000000000000000D+00\n    -1\n",
       "a.uff:7: gives other units than line 1"},
      {head_of(form, mark) + std::string(16, '\0'), "a.uff:1: the data of the function that begins here do not end"},
      {head_of(form, mark) + std::string(15, '\0') + end, "a.uff:1: the data"},
      {head_of(form, mark) + std::string(16, '\xFF') + end, "a.uff:1: the function that begins here has a number"},
      {head_of(form, "    58b     3     2          11          16"), "a.uff:2: byte ordering"},
      {head_of(form, "    58b     1     1          11          16"), "a.uff:2: floating-point format"},
      {head_of(form, "    58b     1     2          12          16"), "a.uff:2: number of lines"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(message_of<InputError>([&] { (void)parse_uff(text, "a.uff"); }), HasSubstr(message)) << text;
}

// Cut off and spoilt at random: read or refused, never worse; and what is read is whole.
TEST(UffFile, SpoiltIsReadOrRefused) {
  std::mt19937_64 random(3);
  int read = 0, refused = 0;
  for (int n = 0; n < 3000; ++n) {
    std::string text = written(random_content(random), n % 2 == 0 ? UffForm::text : UffForm::binary);
    const auto at = [&] { return std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random); };
    if (n % 3 == 0) text.resize(at());
    for (int change = n % 4; change > 0 && !text.empty(); --change)
      text[at()] = static_cast<char>(std::uniform_int_distribution<>(0, 255)(random));
    try {
      for (const UffFunction& function : parse_uff(text, "a.uff").functions) {
        ASSERT_EQ(function.abscissa.size(), function.values.size());
        ASSERT_FALSE(function.values.empty());
        for (const auto& value : function.values) ASSERT_TRUE(std::isfinite(std::abs(value)));
      }
      ++read;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(refused, 300);
}

TEST(UffFile, RefusesAnEvenAbscissaThatOverflows) {
  const std::string text = head_of(form_of(5, 2, 1, " 9.9000E+307", " 9.9000E+307")) +
                           std::string("  1.00000E+00  1.00000E+00\n") + "    -1\n";
  EXPECT_THAT(message_of<InputError>([&] { (void)parse_uff(text, "a.uff"); }), HasSubstr("not finite"));
}

TEST(UffFile, IsNotWrittenOfWhatItCannotHold) {
  UffFile content{.units = {}, .functions = {UffFunction{}}};
  UffFunction sound;
  sound.abscissa = {1.0, 2.0};
  sound.values = {{1, 2}, {3, 4}};
  const auto refuses = [&](auto spoil) {
    content.functions[0] = sound;
    spoil(content.functions[0]);
    for (const UffForm form : {UffForm::text, UffForm::binary})
      EXPECT_THROW(written(content, form), std::invalid_argument);
  };
  content.functions[0] = sound;
  EXPECT_NO_THROW(written(content, UffForm::text));
  refuses([](UffFunction& f) { f.values.pop_back(); });
  refuses([](UffFunction& f) { f.values.clear(), f.abscissa.clear(); });
  refuses([](UffFunction& f) { f.values[1] = NAN; });
  refuses([](UffFunction& f) { f.complex = false; });
  refuses([](UffFunction& f) { f.id[1] = "two\nlines"; });
  refuses([](UffFunction& f) { f.id[1] = std::string(81, 'x'); });
  refuses([](UffFunction& f) { f.ordinate.label = std::string(21, 'x'); });
}

}  // namespace
}  // namespace stillcut
