// Taps from universal files, CSV and WAV: what is read of them, and what is refused.
#include "drivers/files/tap_recording_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/tap_cases.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Fails where the channels of one hit go to another, a sign or an axis is lost, or a rate of seven digits is rounded.
TEST(TapRecordingFile, ComesBackFromUniversalFilesHitByHit) {
  std::mt19937_64 random(11);
  for (int n = 0; n < 40; ++n) {
    std::vector<TapRecording> taps{random_taps(random)};
    for (int more = 0; more < 2; ++more) {
      TapRecording next = taps.front();
      for (double& value : next.force) value += 1.0;
      taps.push_back(next);
    }
    const HammerDirection hammer{static_cast<int>(random() % 3), random() % 2 == 0 ? 1.0 : -1.0};
    for (const UffForm form : {UffForm::binary, UffForm::text}) {
      std::ostringstream out;
      write_uff(out, uff_of(taps, hammer), form);
      const TapFile back = tap_file_of(parse_uff(out.str(), "a.uff"), "a.uff");
      ASSERT_EQ(back.taps.size(), taps.size());
      EXPECT_THAT(back.notes, IsEmpty());
      for (std::size_t i = 0; i < taps.size(); ++i) {
        ASSERT_EQ(back.taps[i].direction, hammer);
        ASSERT_EQ(back.taps[i].recording.sample_rate_hz, taps[i].sample_rate_hz);
        if (form == UffForm::binary) {
          ASSERT_EQ(back.taps[i].recording.force, taps[i].force);
          ASSERT_EQ(back.taps[i].recording.acceleration, taps[i].acceleration);
        } else {
          ASSERT_THAT(back.taps[i].recording.force, testing::Pointwise(testing::DoubleNear(1e-9), taps[i].force));
        }
      }
    }
  }
}

UffFunction record(int data_type, int direction, const char* unit) {
  UffFunction f;
  f.line = 40;
  f.type = kUffTimeResponse;
  f.complex = false;
  f.response_node = 3;
  f.response_direction = direction;
  f.abscissa_axis = {kUffTime, "Time", "s"};
  f.ordinate = {data_type, "", unit};
  f.abscissa = {0.0, 0.001, 0.002};
  f.values = {1.0, 2.0, 3.0};
  return f;
}

TEST(TapRecordingFile, TakesDirectionsAndUnitsFromTheUniversalFile) {
  UffFunction force = record(kUffExcitationForce, -2, "kN"), x = record(kUffAcceleration, -1, "g"),
              open = record(0, 3, "m/s2");
  const TapFile read = tap_file_of({.units = {}, .functions = {force, x, open}}, "a.uff");
  ASSERT_EQ(read.taps.size(), 1U);
  EXPECT_EQ(read.taps[0].direction, (HammerDirection{1, -1.0}));
  EXPECT_EQ(read.taps[0].recording.sample_rate_hz, 1000.0);
  EXPECT_THAT(read.taps[0].recording.force, ElementsAre(1000.0, 2000.0, 3000.0));
  EXPECT_THAT(read.taps[0].recording.acceleration[0], ElementsAre(-9.80665, -2 * 9.80665, -3 * 9.80665));
  EXPECT_THAT(read.taps[0].recording.acceleration[1], IsEmpty());
  EXPECT_THAT(read.taps[0].recording.acceleration[2], ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(read.notes, IsEmpty());

  force.ordinate.units = x.ordinate.units = "";
  UffFunction spectrum = record(kUffAcceleration, 1, "");
  spectrum.type = 2;
  const TapFile bare = tap_file_of({.units = {}, .functions = {spectrum, force, x}}, "a.uff");
  EXPECT_THAT(bare.taps[0].recording.force, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(bare.notes, ElementsAre(HasSubstr("1 functions that are no time record"), HasSubstr("SI is assumed")));
  const UffUnits mm{.code = 9, .description = "", .length = 1e3, .force = 1.0, .line = 1};
  EXPECT_THAT(tap_file_of({.units = mm, .functions = {force, x}}, "a.uff").taps[0].recording.acceleration[0],
              ElementsAre(-1e-3, -2e-3, -3e-3));
}

TEST(TapRecordingFile, NamesFileAndLineOfWhatIsWrongInAUniversalFile) {
  const auto message = [](auto spoil) {
    std::vector<UffFunction> functions{record(kUffExcitationForce, 1, "N"), record(kUffAcceleration, 1, "m/s^2"),
                                       record(kUffAcceleration, 2, "m/s^2")};
    functions[2].line = 60;
    spoil(functions);
    return message_of<InputError>(
        [&] { (void)tap_file_of({.units = UffUnits{.line = 1}, .functions = functions}, "a.uff"); });
  };
  using F = std::vector<UffFunction>;
  EXPECT_THAT(message([](F& f) { f[2].complex = true; }), HasSubstr("a.uff:60: a time record of complex numbers"));
  EXPECT_THAT(message([](F& f) { f[2].response_direction = 5; }), HasSubstr("a.uff:60: response direction: 5"));
  EXPECT_THAT(message([](F& f) { f[2].ordinate.data_type = 8; }), HasSubstr("data type 8 is no force (13, 9) and no"));
  EXPECT_THAT(message([](F& f) { f[2].ordinate.units = "m/s"; }), HasSubstr("unit \"m/s\" is of no acceleration"));
  EXPECT_THAT(message([](F& f) { f[0].ordinate.units = "m/s^2"; }), HasSubstr("unit \"m/s^2\" is of no force"));
  EXPECT_THAT(message([](F& f) { f[2].ordinate.units = "g"; }),
              HasSubstr("contradicts the units of dataset 164, line 1"));
  EXPECT_THAT(message([](F& f) { f[2].abscissa_axis.data_type = 18; }), HasSubstr("data type 18 is no time"));
  EXPECT_THAT(message([](F& f) { f[2].abscissa_axis.units = "min"; }), HasSubstr("unit \"min\" is not known"));
  EXPECT_THAT(message([](F& f) { f[2].abscissa[2] = 0.005; }), HasSubstr("a.uff:60: abscissa: times must rise evenly"));
  EXPECT_THAT(message([](F& f) { f[2].abscissa_axis.units = "ms"; }),
              HasSubstr("another rate or length than the record of line 40"));
  EXPECT_THAT(message([](F& f) { f[2].response_node = 4; }), HasSubstr("acceleration at node 4, not 3 as in line 40"));
  EXPECT_THAT(message([](F& f) { f.erase(f.begin()); }), HasSubstr("a.uff:40: acceleration without force"));
  EXPECT_THAT(message([](F& f) { f.resize(1); }), HasSubstr("a.uff:40: force without acceleration"));
  EXPECT_THAT(message([](F& f) { f.clear(); }), HasSubstr("a.uff: has no time record"));
}

// Fails where a spoilt file ends in anything but a recording or a line that names it.
TEST(TapRecordingFile, ThatIsCutOffOrSpoiltAtRandomIsReadOrRefused) {
  std::mt19937_64 random(12);
  int refused = 0;
  for (int n = 0; n < 600; ++n) {
    const TapRecording taps = random_taps(random);
    std::ostringstream out;
    write_uff(out, uff_of(std::vector{taps}, {1, -1.0}), n % 2 == 0 ? UffForm::text : UffForm::binary);
    std::string bytes = out.str();
    if (n % 3 == 0) bytes.resize(random() % bytes.size());
    for (int spoilt = n % 3; spoilt > 0; --spoilt) bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    try {
      for (const RecordedTaps& read : tap_file_of(parse_uff(bytes, "a.uff"), "a.uff").taps) {
        EXPECT_GT(read.recording.sample_rate_hz, 0.0);
        for (const std::vector<double>& axis : read.recording.acceleration)
          EXPECT_TRUE(axis.empty() || axis.size() == read.recording.force.size());
      }
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("a.uff"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
}

TEST(TapRecordingFile, IsReadAsTheColumnsOfACsvSay) {
  const TapRecording r =
      parse_tap_csv("force_n,time_s,az_m_per_s2,note\n1,5.000000,-4,a\n2,5.000039,-5,b\n3,5.000078,-6,c\n", "a.csv");
  EXPECT_NEAR(r.sample_rate_hz, 25641.0, 1.0);
  EXPECT_THAT(r.force, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(r.acceleration[2], ElementsAre(-4.0, -5.0, -6.0));
  EXPECT_THAT(r.acceleration[0], IsEmpty());
  // Times of six decimals: a step of 39.0625 us is 39 or 40.
  std::string text = "time_s,force_n,ax_m_per_s2\n";
  for (int i = 0; i < 25600; ++i) text += csv_number(std::round(i / 25600.0 * 1e6) / 1e6) + ",1,2\n";
  EXPECT_EQ(parse_tap_csv(text, "a.csv").sample_rate_hz, 25600.0);
}

TEST(TapRecordingFile, NamesFileAndLineOfWhatIsWrongInACsv) {
  const std::pair<const char*, const char*> cases[] = {
      {"time_s,ax_m_per_s2\n0,1\n", "a.csv:1: force_n: the header lacks"},
      {"time_s,force_n\n0,1\n", "a.csv:1: has no acceleration"},
      {"time_s,force_n,ax_m_per_s2\n0,1,2\n", "a.csv:1: holds no two samples"},
      {"time_s,force_n,ax_m_per_s2\n0,1,2\n1,,2\n", "a.csv:3: force_n: \"\" is no number"},
      {"time_s,force_n,ax_m_per_s2\n0,1,2\n1,1,inf\n", "a.csv:3: ax_m_per_s2: \"inf\""},
      {"time_s,force_n,ax_m_per_s2\n0,1,2\n1,1,2\n3,1,2\n4,1,2\n5,1,2\n", "a.csv:4: time_s: \"3\" does not follow"},
      {"time_s,force_n,ax_m_per_s2\n0,1,2\n-1,1,2\n", "a.csv:3: time_s: \"-1\" does not follow"},
      {"time_s,force_n,ax_m_per_s\n0,1,2\n", "a.csv:1: ax_m_per_s"},
      {"time_s,force_n,ax_m_per_s2\n0,1,2\n1,1\n", "a.csv:3: has 2 fields"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(message_of<InputError>([&] { (void)parse_tap_csv(text, "a.csv"); }), HasSubstr(message)) << text;
}

TEST(TapRecordingFile, IsScaledAsTheChannelsOfAWavAreNamed) {
  const TempFolder folder;
  const std::vector<WavChannel> channels = parse_wav_channels("-,z:-100g,force:2kN");
  for (const WavBytes::Form form : {WavBytes::Form::pcm16, WavBytes::Form::float32}) {
    const auto file =
        folder.write("a.wav", WavBytes::of(form, 51200, 3, {0.5F, 0.25F, 0.125F, 0.5F, -1.0F, 0.5F, 0.0F, 0.5F, 1.0F}));
    const TapFile read = read_tap_file(file, channels);
    ASSERT_EQ(read.taps.size(), 1U);
    EXPECT_FALSE(read.taps[0].direction);
    const TapRecording& r = read.taps[0].recording;
    EXPECT_EQ(r.sample_rate_hz, 51200.0);
    EXPECT_THAT(r.force, ElementsAre(250.0, 1000.0, testing::DoubleNear(2000.0, 0.1)));
    EXPECT_THAT(r.acceleration[2], ElementsAre(-245.16625, 980.665, -490.3325));
    EXPECT_THAT(r.acceleration[0], IsEmpty());
    EXPECT_THAT(r.force_overloads, ElementsAre(2U));
    EXPECT_THAT(r.response_overloads, ElementsAre(1U));
  }
}

TEST(TapRecordingFile, RefusesAWavThatIsCutOffOrAnother) {
  const TempFolder folder;
  const std::vector<WavChannel> two = parse_wav_channels("force:2000N,x:500m/s^2");
  const std::string whole = WavBytes::of(WavBytes::Form::float32, 48000, 2, std::vector<float>(200, 0.1F));
  const auto message = [&](const std::string& bytes, std::span<const WavChannel> channels) {
    const auto file = folder.write("a.wav", bytes);
    return message_of<InputError>([&] { (void)read_tap_file(file, channels); });
  };
  EXPECT_EQ(message(whole, two), "");
  for (std::size_t length = 0; length < whole.size(); length += 7)
    EXPECT_THAT(message(whole.substr(0, length), two), testing::StartsWith((folder.path() / "a.wav: ").string()))
        << length;
  EXPECT_THAT(message(whole.substr(0, 500), two), HasSubstr("is cut off: its head tells of 844 bytes, there are 500"));
  EXPECT_THAT(message("no wave, but long enough to be looked at as one", two), HasSubstr("cannot be read: "));
  EXPECT_THAT(message(whole, {}), HasSubstr("a WAV file tells no units; name its channels"));
  EXPECT_THAT(message(whole, std::span(two).subspan(1)), HasSubstr("has 2 channels, but 1 are named"));
  std::vector<float> spoilt(200, 0.1F);
  spoilt[21] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message(WavBytes::of(WavBytes::Form::float32, 48000, 2, spoilt), two),
              HasSubstr("channel 2 is not finite at sample 10"));
  EXPECT_THAT(message_of<InputError>([&] { (void)read_tap_file(folder.path() / "b.wav", two); }),
              HasSubstr("no such file"));
  EXPECT_THAT(message_of<InputError>([&] { (void)read_tap_file(folder.path() / "b.mp3", two); }),
              HasSubstr("must end in"));
}

TEST(TapRecordingFile, RefusesChannelsThatAreNone) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "'' is no channel"},
      {"force:2000N", "no channel is an acceleration"},
      {"x:10g,-", "no channel is the force"},
      {"force:2000N,x:10g,x:10g", "'x' is named twice"},
      {"force:2000N,w:10g", "'w:10g' is no channel"},
      {"force:2000N,x:g", "'x:g' has no full scale"},
      {"force:2000N,x:0g", "'x:0g' has no full scale"},
      {"force:2000N,x:10m/s", "'x:10m/s' has no unit of acceleration"},
      {"force:2000g,x:10g", "'force:2000g' has no unit of force"},
      {"force:2000N,x:10g,", "'' is no channel"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(message_of<std::invalid_argument>([&] { (void)parse_wav_channels(text); }), HasSubstr(message)) << text;
}

}  // namespace
}  // namespace stillcut
