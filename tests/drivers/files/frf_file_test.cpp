// From universal files and CSV to receptance: directions, kinds, units, and what is refused.
#include "drivers/files/frf_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "drivers/files/frf_csv.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/frf_cases.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

UffFunction accelerance(int response, int reference) {
  UffFunction f;
  f.line = 40;
  f.response_node = f.reference_node = 3;
  f.response_direction = response;
  f.reference_direction = reference;
  f.abscissa_axis = {kUffFrequency, "Frequency", "Hz"};
  f.ordinate = {kUffAcceleration, "Acceleration", "m/s^2"};
  f.denominator = {kUffExcitationForce, "Force", "N"};
  f.abscissa = {10.0, 20.0};
  f.values = {{1.0, 2.0}, {3.0, -4.0}};
  return f;
}

UffFile content_of(std::vector<UffFunction> functions) {
  return {.units = UffUnits{.line = 1}, .functions = std::move(functions)};
}

void expect_near(std::complex<double> a, std::complex<double> b) { EXPECT_LT(std::abs(a - b), 1e-12 * std::abs(b)); }

// Of one mode, x'' = i w x' = -w² x: the three kinds are the same receptance. Fails with a wrong power, sign or 2 π.
TEST(FrfFile, OfEveryKindIsTheSameReceptance) {
  const auto h = [](double hz) { return 1e-7 / std::complex<double>(1.0 - hz * hz / 225.0, 0.1 * hz / 15.0); };
  for (const auto& [data_type, power] : {std::pair{kUffDisplacement, 0}, {kUffVelocity, 1}, {kUffAcceleration, 2}}) {
    UffFunction f = accelerance(1, 1);
    f.ordinate = {data_type, "", ""};
    for (std::size_t i = 0; i < 2; ++i)
      f.values[i] =
          h(f.abscissa[i]) * std::pow(std::complex<double>(0.0, 2.0 * std::numbers::pi * f.abscissa[i]), power);
    const FrfFile read = frf_of(content_of({f}), "a.uff");
    for (std::size_t i = 0; i < 2; ++i) expect_near(read.response.receptance[0][0][i], h(f.abscissa[i]));
    EXPECT_THAT(read.notes, IsEmpty());
  }
}

// Fails where response and force change places, or a direction's sign is lost.
TEST(FrfFile, OfDirectionsIsTheEntryOfTheseAxes) {
  UffFunction f = accelerance(-2, 3), g = accelerance(-1, -1);
  f.ordinate.data_type = g.ordinate.data_type = kUffDisplacement;
  f.ordinate.units = g.ordinate.units = "m";
  const FrequencyResponse r = frf_of(content_of({f, g}), "a.uff").response;
  EXPECT_EQ(measured_entries(r), 2U);
  EXPECT_THAT(r.receptance[1][2], ElementsAre(std::complex<double>(-1, -2), std::complex<double>(-3, 4)));
  EXPECT_THAT(r.receptance[0][0], ElementsAre(std::complex<double>(1, 2), std::complex<double>(3, -4)));
}

TEST(FrfFile, TakesUnitsFromTheDatasetTheLabelsOrSaysThatItAssumesSi) {
  const auto first = [](const UffFile& content, std::size_t notes) {
    const FrfFile read = frf_of(content, "a.uff");
    EXPECT_EQ(read.notes.size(), notes);
    return read.response.receptance[0][0][0];
  };
  UffFunction f = accelerance(1, 1);
  const std::complex<double> si = first(content_of({f}), 0);
  f.ordinate.units = f.denominator.units = "NONE";
  expect_near(first({.units = {}, .functions = {f}}, 1), si);
  UffUnits mm_kn{.code = 9, .description = "", .length = 1e3, .force = 1e-3, .line = 1};
  expect_near(first({.units = mm_kn, .functions = {f}}, 0), 1e-6 * si);
  f.ordinate.units = "g";
  f.denominator.units = "N";
  expect_near(first({.units = {}, .functions = {f}}, 0), 9.80665 * si);
  for (const char* both : {"(m/s^2)/N", "m/s^2/N", "m/s2"}) {
    f.ordinate.units = both;
    expect_near(first({.units = {}, .functions = {f}}, 0), si);
  }
  f.abscissa_axis.units = "rad/s";
  f.abscissa = {10.0 * 2.0 * std::numbers::pi, 20.0 * 2.0 * std::numbers::pi};
  expect_near(first(content_of({f}), 0), si);
}

// The head of a file that an analyser wrote where the quantities were left open (an open data set of the University of
// Ljubljana's has this form, in UTF-8), and what its labels say. Its directions are open too: no one but the user knows
// them.
TEST(FrfFile, TakesAnOpenQuantityFromItsLabelButNoOpenDirection) {
  const auto file = [](const char* unit, int direction) {
    char nodes[100];
    std::snprintf(nodes, sizeof nodes,
                  "    4         0    0         0 NONE               0%4d NONE               0%4d\n", direction,
                  direction);
    return std::string(
               "    -1\n    58\nref6\nNONE\n23-Mar-17 19:02:23\nRecord 1 of Dataset no 58\nH1 : #  2 / #  1\n") +
           nodes +
           "         5         2         1 1.00000e+00  1.95313e-01  0.00000e+00 \n"
           "        18    0    0    0 NONE                 Hz                  \n"
           "         1    0    0    0 Frequency Function   " +
           unit +
           "\n         0    0    0    0 NONE                 NONE                \n"
           "         0    0    0    0 NONE                 NONE                \n"
           " 3.00000e+00 -4.00000e+00 -5.99924e-02 -5.53260e-02 \n    -1\n";
  };
  const auto first = [&](const char* unit) {
    const FrfFile read = frf_of(parse_uff(file(unit, 1), "a.uff"), "a.uff");
    EXPECT_EQ(read.notes.size(), 0U);
    return read.response.receptance[0][0][0];
  };
  const double w = 2.0 * std::numbers::pi;
  const std::complex<double> h{3, -4}, iw{0.0, w};
  for (const char* unit : {"(1/N)*(m/s\xC2\xB2)", "(1/N)*(m/s\xB2)", "(m/s^2)/N"})
    expect_near(first(unit), h / (iw * iw));
  expect_near(first("mm/s/kN"), 1e-6 * h / iw);
  expect_near(first("(1/mN)*(m)"), 1e3 * h);
  EXPECT_THAT(message_of<InputError>([&] { (void)frf_of(parse_uff(file("m/N", 0), "a.uff"), "a.uff"); }),
              HasSubstr("a.uff:1: response direction: 0 is no translation; give the points their directions in the "
                        "instrument, or 1, 2 or 3 for x, y, z in line 8"));
}

TEST(FrfFile, LeavesOutWhatIsNoResponseAndZeroHertz) {
  UffFunction f = accelerance(1, 1), coherence = accelerance(1, 1);
  f.abscissa = {0.0, 20.0};
  coherence.type = 6;
  const FrfFile read = frf_of(content_of({coherence, f}), "a.uff");
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("1 functions"), HasSubstr("0 Hz is left out")));
  EXPECT_THAT(read.response.frequencies_hz, ElementsAre(20.0));
  ASSERT_EQ(read.response.receptance[0][0].size(), 1U);
  expect_near(read.response.receptance[0][0][0], std::complex<double>(3, -4) / -std::pow(40.0 * std::numbers::pi, 2));
}

TEST(FrfFile, NamesFileAndLineOfWhatIsWrong) {
  const auto message = [](auto spoil) {
    std::vector<UffFunction> functions{accelerance(1, 1), accelerance(2, 1)};
    functions[1].line = 60;
    spoil(functions[1]);
    return message_of<InputError>([&] { (void)frf_of(content_of(functions), "a.uff"); });
  };
  using F = UffFunction;
  EXPECT_THAT(message([](F& f) { f.complex = false; }), HasSubstr("a.uff:60: a frequency response of real numbers"));
  EXPECT_THAT(message([](F& f) { f.response_direction = 4; }), HasSubstr("a.uff:60: response direction: 4"));
  EXPECT_THAT(message([](F& f) { f.reference_direction = 0; }), HasSubstr("a.uff:60: reference direction: 0"));
  EXPECT_THAT(message([](F& f) { std::swap(f.ordinate, f.denominator); }), HasSubstr("a.uff:60: force over response"));
  EXPECT_THAT(message([](F& f) { f.denominator = {15, "Force", "N"}; }), HasSubstr("data type 15 is no force"));
  EXPECT_THAT(message([](F& f) { f.denominator = {0, "NONE", "NONE"}; }), HasSubstr("data type 0 is no force"));
  EXPECT_THAT(message([](F& f) { f.ordinate = {1, "Function", "NONE"}; }), HasSubstr("data type 1 is no displacement"));
  EXPECT_THAT(message([](F& f) {
                f.values[1] = 1e308;
                f.abscissa = {1e-9, 20.0};
                f.values[0] = 1e308;
              }),
              HasSubstr("a.uff:60: "));
  EXPECT_THAT(message([](F& f) { f.ordinate.data_type = 15; }), HasSubstr("data type 15 is no displacement"));
  EXPECT_THAT(message([](F& f) { f.ordinate.units = "mm/s^2"; }),
              HasSubstr("contradicts the units of dataset 164, line 1"));
  EXPECT_THAT(message([](F& f) { f.denominator.units = "kN"; }), HasSubstr("\"kN\" contradicts"));
  EXPECT_THAT(message([](F& f) { f.abscissa_axis.data_type = 17; }), HasSubstr("data type 17 is no frequency"));
  EXPECT_THAT(message([](F& f) { f.abscissa_axis.units = "rpm"; }), HasSubstr("unit \"rpm\" is not known"));
  EXPECT_THAT(message([](F& f) { f.abscissa = {20.0, 10.0}; }), HasSubstr("point 2 does not"));
  EXPECT_THAT(message([](F& f) { f.abscissa[1] = 21.0; }), HasSubstr("other frequencies than the function of line 40"));
  EXPECT_THAT(message([](F& f) { f.response_node = 4; }), HasSubstr("nodes 4 and 3, not 3 and 3"));
  EXPECT_THAT(message([](F& f) { f.id[2] = "added decay 4.6 1/s"; }),
              HasSubstr("a.uff:60: another exponential window than the function of line 40"));
  EXPECT_THAT(message([](F& f) { f.id[2] = "added decay some"; }),
              HasSubstr("a.uff:60: \"added decay some\" must tell"));
  EXPECT_THAT(message([](F& f) {
                f.type = kUffCoherence;
                f.complex = false;
                f.response_direction = 1;
                f.values = {0.5, 1.5};
              }),
              HasSubstr("a.uff:60: a coherence must be from 0 to 1"));
  EXPECT_THAT(message([](F& f) { f.response_direction = -1; }),
              HasSubstr("response x to force x stands in the file twice"));
  UffFunction unknown = accelerance(1, 1);
  unknown.ordinate.units = "V";
  EXPECT_THAT(message_of<InputError>([&] { (void)frf_of({.units = {}, .functions = {unknown}}, "a.uff"); }),
              HasSubstr("unit \"V\" is not known; add the units as dataset 164"));
  unknown.type = 1;
  EXPECT_THAT(message_of<InputError>([&] { (void)frf_of({.units = {}, .functions = {unknown}}, "a.uff"); }),
              HasSubstr("a.uff: has no frequency response"));
}

TEST(FrfFile, ComesBackFromEveryFormat) {
  const TempFolder folder;
  std::mt19937_64 random(4);
  for (int n = 0; n < 100; ++n) {
    const FrequencyResponse response = random_response(random);
    std::ostringstream csv, binary, text;
    write_frf_csv(csv, response);
    write_uff(binary, uff_of(response), UffForm::binary);
    write_uff(text, uff_of(response), UffForm::text);
    for (const auto& [name, content] :
         {std::pair{"p.csv", csv.str()}, {"p.uff", binary.str()}, {"p.unv", binary.str()}}) {
      const FrfFile back = read_frf(folder.write(name, content));
      ASSERT_EQ(back.response.frequencies_hz, response.frequencies_hz) << name;
      ASSERT_EQ(back.response.receptance, response.receptance) << name;
      ASSERT_EQ(back.response.coherence, response.coherence) << name;
      ASSERT_EQ(back.response.added_decay_per_s, response.added_decay_per_s) << name;
      ASSERT_EQ(back.response.force_error, response.force_error) << name;
      ASSERT_THAT(back.notes, IsEmpty());
    }
    const FrequencyResponse rounded = read_frf(folder.write("p.uff", text.str())).response;
    ASSERT_EQ(measured_entries(rounded), measured_entries(response));
    ASSERT_EQ(rounded.added_decay_per_s, response.added_decay_per_s);
  }
  EXPECT_THAT(message_of<InputError>([&] { (void)read_frf(folder.write("p.txt", "")); }), HasSubstr("must end in"));
}

}  // namespace
}  // namespace stillcut
