// Which reader a file gets, and that spoilt files are read or refused, never worse.
#include "drivers/files/tool_path_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

#include "drivers/files/cl_file.hpp"
#include "drivers/files/gcode_file.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/text_file.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

const std::string kShortGcode = "G0 X0 Y0 Z0\nX1\n";
const std::string kShortCl = "GOTO/0,0,0\nRAPID\nGOTO/1,0,0\n";

TEST(ToolPathFile, EndingChooses) {
  const TempFolder folder;
  for (const char* name : {"a.nc", "a.NGC", "a.gcode", "a.tap", "a.cnc"})
    EXPECT_EQ(read_tool_path(folder.write(name, kShortGcode)).moves.size(), 1U) << name;
  for (const char* name : {"a.cl", "a.CLS", "a.apt", "a.aptsource"})
    EXPECT_EQ(read_tool_path(folder.write(name, kShortCl)).moves.size(), 1U) << name;
  // The ending's reader speaks even where the other would have read the file.
  EXPECT_NE(message_of<InputError>([&] {
              (void)read_tool_path(folder.write("b.nc", kShortCl));
            }).find("b.nc:1: G is followed by no number"),
            std::string::npos);
  EXPECT_NE(message_of<InputError>([&] {
              (void)read_tool_path(folder.write("b.cls", kShortGcode));
            }).find("b.cls:1: G0 X0 Y0 Z0: is not known"),
            std::string::npos);
  EXPECT_NE(message_of<InputError>([&] {
              (void)read_tool_path(folder.write("b.mpf", kShortGcode));
            }).find("b.mpf: is a Sinumerik program, which is not read; post G-code"),
            std::string::npos);
}

TEST(ToolPathFile, ElseTheFirstWordsChoose) {
  const TempFolder folder;
  for (const std::string& text :
       {kShortGcode, "%\n" + kShortGcode, "\n(first)\n; second\n" + kShortGcode, "N1" + kShortGcode})
    EXPECT_EQ(read_tool_path(folder.write("program", text)).moves.size(), 1U) << text;
  for (const std::string& text :
       {kShortCl, "$$ made by hand\nUNITS/MM\n" + kShortCl, "PARTNO A\n" + kShortCl, "TOOL PATH/A,TOOL,B\n" + kShortCl})
    EXPECT_EQ(read_tool_path(folder.write("path.txt", text)).moves.size(), 1U) << text;
  for (const char* text : {"", "dear colleagues,\n", "<?xml?>", "1,2,3\n", "(unclosed\n", "GOTO/$"}) {
    const std::string message = message_of<InputError>([&] { (void)read_tool_path(folder.write("path.txt", text)); });
    EXPECT_NE(message.find("path.txt: begins neither as G-code (%, G21, N10 G0) nor as APT cutter locations"),
              std::string::npos)
        << text << ": " << message;
  }
}

std::string spoilt(std::string text, std::mt19937_64& random) {
  static constexpr std::string_view kLikely = "GXYZIJRFSM0123456789.-+/,$()%;\n #[ENANOT";
  for (int i = std::uniform_int_distribution<int>(1, 4)(random); i > 0; --i) {
    const auto at = std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random);
    const char likely = kLikely[std::uniform_int_distribution<std::size_t>(0, kLikely.size() - 1)(random)];
    switch (std::uniform_int_distribution<int>(0, 4)(random)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << std::uniform_int_distribution<int>(0, 7)(random)));
        break;
      case 1:
        text.erase(at, std::uniform_int_distribution<std::size_t>(1, 20)(random));
        break;
      case 2:
        text.insert(at, 1, likely);
        break;
      case 3:
        text.insert(at, text.substr(at / 2, 30));
        break;
      default:
        text[at] = likely;
    }
    if (text.empty()) return "G";
  }
  return text;
}

// Whatever stands in the file, it is read or refused by a line that names it: a crash, a hang, another exception or
// moves without end fail this. Thousands of files spoilt by a few bytes each, the same ones every time.
TEST(ToolPathFile, SpoiltFilesAreReadOrRefused) {
  std::mt19937_64 random(17);
  const std::string cl = read_text_file(TEST_DATA "/paths/wave.cls");
  const std::array<std::string, 2> good{read_text_file(TEST_DATA "/paths/face.nc"),
                                        "FEDRAT/9\nSPINDL/9\n" + kShortCl + cl.substr(0, cl.find("GOTO/20"))};
  std::array<int, 2> read{}, refused{};
  for (int i = 0; i < 6000; ++i) {
    const std::size_t kind = i % 2;
    const std::string text = spoilt(good.at(kind), random);
    try {
      const ToolPath path = kind == 0 ? parse_gcode(text, "p") : parse_cutter_locations(text, "p");
      ++read.at(kind);
      for (const PathMove& move : path.moves) {
        ASSERT_TRUE(move.to.allFinite() && move.to.cwiseAbs().maxCoeff() <= 100.0) << text;
        ASSERT_TRUE(!move.cutting || (move.feed_rate > 0.0 && move.spindle_speed != 0.0)) << text;
      }
      for (std::size_t k = 1; k < path.moves.size(); ++k) ASSERT_EQ(path.moves[k].from, path.moves[k - 1].to) << text;
    } catch (const InputError& error) {
      ++refused.at(kind);
      const std::string message = error.what();
      ASSERT_TRUE(message.starts_with("p:") && message.size() < 300) << message;
    }
  }
  for (const std::size_t kind : {0U, 1U}) {  // else the spoiling is too coarse or too fine to prove anything
    EXPECT_GT(read.at(kind), 300);
    EXPECT_GT(refused.at(kind), 300);
  }
}

}  // namespace
}  // namespace stillcut
