#include "tools/plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "drivers/files/input_error.hpp"
#include "tools/plot_replay.hpp"
#include "tools/plot_scale.hpp"
#include "tools/spectrogram.hpp"

// fontconfig keeps what it read of the fonts to the program's end; that is no leak of ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig\n"; }

namespace stillcut::plot {
namespace {

std::filesystem::path temporary(const std::string& name) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  return std::filesystem::path(::testing::TempDir()) / (std::string("stillcut_") + test->name() + "_" + name);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(Ticks, AreRoundInsideTheRangeAndAboutAsManyAsAsked) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-6, 6), position(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    const double span = std::pow(10.0, exponent(random)), low = position(random) * span;
    const Range range{low, low + span};
    const std::vector<double> at = ticks(range, 8);
    ASSERT_GE(at.size(), 3U);
    ASSERT_LE(at.size(), 9U);
    ASSERT_GE(at.front(), low - 1e-8 * span);
    ASSERT_LE(at.back(), low + span + 1e-8 * span);
    const double step = at[1] - at[0], power = std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    const double factor = step / power;
    ASSERT_TRUE(std::abs(factor - 1) < 1e-5 || std::abs(factor - 2) < 1e-5 || std::abs(factor - 5) < 1e-5) << factor;
  }
}

TEST(Ticks, TextHasTheDecimalsThatTheStepNeeds) {
  EXPECT_EQ(tick_text(0.25, 0.05), "0.25");
  EXPECT_EQ(tick_text(3.0, 0.5), "3.0");
  EXPECT_EQ(tick_text(9000.0, 500.0), "9000");
  EXPECT_EQ(tick_text(-2.0, 1.0), "\u22122");
  EXPECT_EQ(decade_text(-3.0), "0.001");
  EXPECT_EQ(decade_text(4.0), "10000");
  EXPECT_EQ(decade_text(-12.0), "10⁻¹²");
  EXPECT_EQ(decade_text(5.0), "10⁵");
}

TEST(AxisRange, IgnoresWhatIsNotANumberAndIsNeverEmpty) {
  const std::vector<double> with_gaps{NAN, 2.0, INFINITY, 5.0}, none{NAN}, same{3.0, 3.0};
  const auto range_of = [](const std::vector<double>& values) {
    const std::vector<const std::vector<double>*> data{&values};
    return axis_range({}, data, 0.0);
  };
  EXPECT_EQ(range_of(with_gaps).low, 2.0);
  EXPECT_EQ(range_of(with_gaps).high, 5.0);
  EXPECT_GT(range_of(none).span(), 0.0);
  EXPECT_GT(range_of(same).span(), 0.0);
}

TEST(Decimated, KeepsEveryPeakInItsColumn) {
  Line line;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100000; ++i) {
    line.x.push_back(i * 1e-4);
    line.y.push_back(normal(random));
  }
  line.y[31234] = 50.0;
  line.y[77777] = -40.0;
  const Line few = decimated(line, {0.0, 10.0}, 500);
  EXPECT_LE(few.x.size(), 4U * 501);
  EXPECT_TRUE(std::is_sorted(few.x.begin(), few.x.end()));
  for (int column = 0; column < 500; ++column) {
    const auto low_high = [&](const Line& l) {
      double low = INFINITY, high = -INFINITY;
      for (std::size_t i = 0; i < l.x.size(); ++i)
        if (std::floor(l.x[i] / 10.0 * 500) == column) low = std::min(low, l.y[i]), high = std::max(high, l.y[i]);
      return std::pair{low, high};
    };
    ASSERT_EQ(low_high(few), low_high(line)) << column;
  }
}

TEST(Decimated, KeepsGaps) {
  Line line;
  for (int i = 0; i < 10000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i >= 5000 && i < 6000 ? NAN : 1.0);
  }
  const Line few = decimated(line, {0.0, 10000.0}, 100);
  const auto gaps = std::count_if(few.y.begin(), few.y.end(), [](double y) { return std::isnan(y); });
  EXPECT_GE(gaps, 10);
  EXPECT_LT(few.y.size(), 500U);
}

TEST(ScaleColor, RisesInLightness) {
  double last = -1.0;
  for (int i = 0; i <= 100; ++i) {
    const Color c = scale_color(i / 100.0);
    const double luminance =
        0.2126 * std::pow(c.red, 2.2) + 0.7152 * std::pow(c.green, 2.2) + 0.0722 * std::pow(c.blue, 2.2);
    EXPECT_GT(luminance, last) << i;
    last = luminance;
  }
}

TEST(Spectrogram, ShowsASineAtItsFrequencyAndAmplitude) {
  constexpr double kRate = 25600.0, kFrequency = 737.5;
  std::vector<float> signal;
  for (int i = 0; i < 51200; ++i)
    signal.push_back(static_cast<float>(3.0 * std::sin(2.0 * std::numbers::pi * kFrequency * i / kRate)));
  const Image image = spectrogram(signal, kRate, 1.0, 0.08, 2000.0);
  ASSERT_GT(image.columns, 100);
  const double row_hz = (image.y_end - image.y_begin) / image.rows;
  for (const int column : {0, image.columns / 2, image.columns - 1}) {
    int strongest = 0;
    const auto value = [&](int row) { return image.values[static_cast<std::size_t>(row * image.columns + column)]; };
    for (int row = 1; row < image.rows; ++row)
      if (value(row) > value(strongest)) strongest = row;
    EXPECT_NEAR(image.y_begin + (strongest + 0.5) * row_hz, kFrequency, row_hz / 2);
    EXPECT_NEAR(value(strongest), 20.0 * std::log10(3.0), 1.5);  // between bins a Hann window loses up to 1.42 dB
  }
  EXPECT_GE(image.x_begin, 1.0);
  EXPECT_LE(image.x_end, 3.0);
}

Figure some_figure() {
  Figure figure;
  figure.title = "Title <&>";
  figure.x.label = "time [s]";
  Panel panel;
  panel.title = "Panel";
  panel.y = {.label = "µm", .logarithmic = true};
  Line line{.x = {}, .y = {}, .label = "a line"};
  for (int i = 0; i < 200000; ++i) {
    line.x.push_back(i * 1e-5);
    line.y.push_back(1.1 + std::sin(i * 0.01) * std::cos(i * 1e-4));
  }
  panel.lines.push_back(line);
  panel.points.push_back({.x = {0.5, NAN}, .y = {1.0, 1.0}, .label = "points"});
  panel.bands.push_back({.begin = 0.2, .end = 0.4, .label = "band"});
  panel.limits.push_back({1.0, "limit"});
  panel.events.push_back({0.7, "event"});
  panel.events.push_back({0.71, "event close by"});
  panel.notes.push_back({1.9, 1.0, "a note that would run out of the panel"});
  figure.panels = {panel, panel};
  figure.panels[1].y.logarithmic = false;
  return figure;
}

TEST(WriteFigure, SameFigureGivesTheSameFile) {
  for (const char* name : {"a.svg", "a.png"}) {
    const auto first = temporary(std::string("1") + name), second = temporary(std::string("2") + name);
    write_figure(some_figure(), first);
    write_figure(some_figure(), second);
    const auto content = [](const std::filesystem::path& file) {  // cairo numbers its surfaces through a process
      std::string text = bytes_of(file);
      if (const std::size_t id = text.find("id=\"surface"); id != std::string::npos)
        text.erase(id, text.find('>', id) - id);
      return text;
    };
    ASSERT_GT(content(first).size(), 10000U);
    EXPECT_TRUE(content(first) == content(second)) << name;
    std::filesystem::remove(first);
    std::filesystem::remove(second);
  }
}

TEST(WriteFigure, SvgOfALongSignalStaysSmall) {
  const auto file = temporary("long.svg");
  write_figure(some_figure(), file);
  EXPECT_LT(std::filesystem::file_size(file), 600000U);  // 400 000 points would take some 8 MB
  EXPECT_NE(bytes_of(file).find("<svg"), std::string::npos);
  std::filesystem::remove(file);
}

TEST(WriteFigure, AnEmptyFigureIsStillAPicture) {
  const auto file = temporary("empty.png");
  Figure figure;
  figure.panels.resize(2);
  write_figure(figure, file);
  EXPECT_EQ(bytes_of(file).substr(1, 3), "PNG");
  std::filesystem::remove(file);
}

TEST(WriteFigure, RefusesOtherNamesAndPlacesThatCannotBeWritten) {
  EXPECT_THROW(write_figure(some_figure(), "picture.pdf"), InputError);
  EXPECT_THROW(write_figure(some_figure(), "picture"), InputError);
  EXPECT_THROW(write_figure(some_figure(), "/no/such/folder/picture.svg"), InputError);
  EXPECT_THROW(write_figure(some_figure(), "/no/such/folder/picture.png"), InputError);
}

ReplayTrace some_replay() {
  ReplayTrace replay;
  replay.title = "A cut";
  replay.sample_rate_hz = 10000;
  replay.teeth = 2;
  for (int i = 0; i < 40000; ++i)
    replay.vibration.push_back(static_cast<float>(std::sin(i * 0.1) + (i > 20000 ? 5 * std::sin(i * 0.45) : 0)));
  replay.vibration[100] = NAN;
  for (int i = 0; i < 400; ++i) {
    const double time = i * 0.01;
    const State state = time < 0.5 ? State::air : time < 2.0 ? State::cut : time < 3.5 ? State::chatter : State::air;
    replay.trace.push_back({time, time < 2.0 ? 0.3 : 4.0, 9000.0, state, state == State::chatter ? 716.0 : NAN, NAN});
  }
  replay.events = {{0.5, EventType::cut_entry, ChatterKind::unknown, NAN, 9000},
                   {2.0, EventType::chatter_onset, ChatterKind::regenerative, 716, 9000},
                   {2.1, EventType::correction, ChatterKind::unknown, 716, 7160},
                   {3.5, EventType::chatter_end, ChatterKind::regenerative, 716, 9000},
                   {3.5, EventType::cut_exit, ChatterKind::unknown, NAN, 9000}};
  return replay;
}

TEST(ReplayFigure, TellsOnsetCorrectionAndWhatItRestsOn) {
  const Figure figure = replay_figure(some_replay());
  ASSERT_EQ(figure.panels.size(), 4U);
  const Panel &vibration = figure.panels[0], &spectrum = figure.panels[1], &indicator = figure.panels[2],
              &speed = figure.panels[3];
  ASSERT_EQ(vibration.bands.size(), 2U);
  EXPECT_NEAR(vibration.bands[1].begin, 2.0, 1e-9);
  EXPECT_NEAR(vibration.bands[1].end, 3.5, 1e-9);
  ASSERT_TRUE(spectrum.image);
  EXPECT_NEAR(spectrum.lines[0].y[0], 300.0, 1e-9);  // 2 teeth at 9000 rpm
  ASSERT_EQ(spectrum.points.size(), 1U);
  EXPECT_EQ(indicator.limits[0].y, 1.0);
  EXPECT_EQ(indicator.events[1].text, "2.000 s  regenerative chatter, 716 Hz");
  ASSERT_EQ(speed.events.size(), 1U);
  EXPECT_EQ(speed.events[0].text, "correction: 9000 → 7160 rpm,  n = 60 f/(N k)  with f = 716 Hz, N = 2, k = 3");
  const Line& target = speed.lines[1];
  EXPECT_EQ(target.y[0], 7160.0);
  EXPECT_TRUE(std::isnan(target.y.back()));  // ends with the chatter
}

TEST(ReplayFigure, ShowsTheDecayWhereItWasMeasured) {
  ReplayTrace replay = some_replay();
  for (TracePoint& point : replay.trace) {
    if (point.time_s > 1.0 && point.time_s < 2.0) point.decay_per_s = 20.0 * (2.0 - point.time_s);
  }
  const Figure figure = replay_figure(replay);
  ASSERT_EQ(figure.panels.size(), 5U);
  const Line& decay = figure.panels[3].lines[0];
  EXPECT_TRUE(std::isnan(decay.y[50]));
  EXPECT_NEAR(decay.y[150], 10.0, 1e-9);
}

TEST(ReplayFigure, HoldsWithNothingToShow) {
  const auto file = temporary("nothing.svg");
  plot_replay({}, file);
  EXPECT_GT(std::filesystem::file_size(file), 1000U);
  ReplayTrace no_speed = some_replay();
  for (TracePoint& point : no_speed.trace) point.spindle_speed_rpm = point.indicator = NAN;
  plot_replay(no_speed, file);
  EXPECT_GT(std::filesystem::file_size(file), 1000U);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace stillcut::plot
