// stillcut doctor, as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/healthy_host.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

void expect_pinned_shape(const Finished& done) {
  ASSERT_THAT(done.exit_code, AnyOf(0, 4)) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  bool fit = true;
  ASSERT_GE(json.at("checks").size(), 20U);
  for (const auto& check : json.at("checks")) {
    for (const char* key : {"name", "found", "wanted", "mend"}) EXPECT_TRUE(check.at(key).is_string()) << check;
    EXPECT_EQ(check.at("ok").get<bool>(), check.at("mend").get<std::string>().empty()) << check;
    fit = fit && check.at("ok").get<bool>();
  }
  EXPECT_EQ(done.exit_code, fit ? 0 : 4);
  EXPECT_EQ(json.at("fit").get<bool>(), fit);
}

// Fails if a real host makes it crash, or its answer does not have the shape of the contract.
TEST(DoctorCommand, LooksAtThisHost) {
  const TempFolder folder;
  expect_pinned_shape(run({"stillcut", "doctor", "--json"}, folder.path()));
}

TEST(DoctorCommand, CopiedHostIsFitUntilSomethingIsWrongThere) {
  const HealthyHost host;
  const std::vector<std::string> look{"stillcut", "doctor", "--root", host.path().string()};
  const Finished fit = run(look, host.path());
  EXPECT_EQ(fit.exit_code, 0) << fit.out;
  EXPECT_THAT(fit.out, HasSubstr("\nfit, as far as a copied folder tells\n"));
  EXPECT_THAT(fit.out, HasSubstr("\nok   can0 MTU "));
  EXPECT_EQ(fit.out.find('\033'), std::string::npos) << "colours are for terminals";
  host.put("proc/swaps", "Filename\n/dev/s\xffwap\x1b[2J partition 1 0 -2\n");
  const Finished unfit = run(look, host.path());
  EXPECT_EQ(unfit.exit_code, 4);
  EXPECT_EQ(unfit.err, "");
  EXPECT_THAT(unfit.out, HasSubstr("\nNOT  swap "));
  EXPECT_THAT(unfit.out, HasSubstr("mend: swapoff -a"));
  EXPECT_THAT(unfit.out, HasSubstr("\nnot fit: 1 of "));
  EXPECT_EQ(unfit.out.find('\033'), std::string::npos) << "a host's bytes reach the terminal";
  expect_pinned_shape(run({"stillcut", "doctor", "--json", "--root", host.path().string()}, host.path()));
}

TEST(DoctorCommand, CellNamesInterfaceAndAddress) {
  const DemoCell cell;
  const HealthyHost host;
  const auto found = [&](const std::string& name) {
    const Finished done =
        run({"stillcut", "doctor", "cell.toml", "--json", "--root", host.path().string()}, cell.path());
    for (const auto& check : nlohmann::json::parse(done.out).at("checks")) {
      if (check.at("name") == name) return check.dump();
    }
    return "no check " + name + done.out + done.err;
  };
  const std::string text = content_of(cell.path() / "cell.toml");
  const auto bus = text.find("bus = "), end = text.find('\n', bus);
  cell.change(text.substr(bus, end - bus), "bus = \"socketcan:can9\"");
  EXPECT_THAT(found("CAN interface"), HasSubstr(R"("found":"none","wanted":"can9")"));
  cell.change("socketcan:can9", "local:here");
  EXPECT_THAT(found("CAN interface"), HasSubstr("no interface"));
}

TEST(DoctorCommand, WrongUseAndInputAreTold) {
  const TempFolder folder;
  EXPECT_EQ(run({"stillcut", "doctor", "--priority", "100"}, folder.path()).exit_code, 2);
  const Finished none = run({"stillcut", "doctor", "none.toml"}, folder.path());
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, StartsWith("stillcut: none.toml: "));
  EXPECT_EQ(run({"stillcut", "doctor", "--root", "none"}, folder.path()).exit_code, 3);
  EXPECT_THAT(run({"stillcut", "doctor", "--help"}, folder.path()).out, HasSubstr("Example"));
}

}  // namespace
}  // namespace stillcut
