// What stillcut-dds takes and refuses on its command line.
#include "adapters/dds_options.hpp"

#include <gtest/gtest.h>

#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

TEST(DdsOptions, DomainsFrom0To232AreTaken) {
  for (int domain = 0; domain <= kMaxDomain; ++domain) EXPECT_EQ(complain_of_domain(std::to_string(domain)), "");
  for (const char* wrong : {"233", "-1", "1.5", "", " 1", "1 ", "0x1", "one", "99999999999999999999"})
    EXPECT_NE(complain_of_domain(wrong).find("0 to 232"), std::string::npos) << wrong;
}

TEST(DdsOptions, NamespacesAreRos2Names) {
  for (const char* good : {"stillcut", "cell_2", "hall/left", "A", "a/b/c9_"})
    EXPECT_EQ(complain_of_namespace(good), "");
  for (const char* wrong : {"", "/cell", "cell/", "2cell", "a//b", "a/2", "_a", "a b", "a-b", "zelle\xC3\xA4", "~"})
    EXPECT_NE(complain_of_namespace(wrong), "") << wrong;
  EXPECT_NE(complain_of_namespace(std::string(300, 'a')), "");
}

TEST(DdsOptions, PartitionsAreNamesAndNoPatterns) {
  for (const char* good : {"hall", "hall 3", "a.b"}) EXPECT_EQ(complain_of_partition(good), "");
  for (const char* wrong : {"", "*", "hall?", "[ab]"}) EXPECT_NE(complain_of_partition(wrong), "") << wrong;
}

TEST(DdsOptions, DiscoveryServersAreWrittenAsForRos2) {
  for (const char* good :
       {"192.168.1.2:11811", "cell-host.local:1", "10.0.0.1", "10.0.0.1:11811;10.0.0.2:65535", ";10.0.0.2:4"})
    EXPECT_EQ(complain_of_servers(good), "") << good;
  for (const char* wrong : {"", ";", "host:0", "host:65536", "host:", ":11811", "a b:1", "host:1:2", "host:port"})
    EXPECT_NE(complain_of_servers(wrong), "") << wrong;
}

TEST(DdsProgram, EndsWithTheCodeOfTheContractAndOneLine) {
  constexpr const char* kDemoCell = EXAMPLES "/demo-cell/cell.toml";
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const std::vector<Case> cases{
      {{}, 2, "stillcut-dds: either CELL or --listen is required; see 'stillcut-dds --help'\n"},
      {{"none.toml"}, 3, "stillcut-dds: none.toml: "},
      {{kDemoCell, "--listen"}, 2, "either CELL or --listen"},
      {{kDemoCell, "--domain", "233"}, 2, "'233' is no DDS domain; --domain and ROS_DOMAIN_ID take 0 to 232"},
      {{kDemoCell, "--namespace", "a b"}, 2, "'a b' is no ROS 2 name"},
      {{kDemoCell, "--partition", "*"}, 2, "'*' is no partition"},
      {{kDemoCell, "--discovery-server", "host:0"}, 2, "'host:0' names no discovery server"},
      {{kDemoCell, "--interface", "eth0"}, 2, "'eth0' is no address"},
      {{kDemoCell, "--lcm", "udpm://no-address:0", "--duration", "1"},
       4,
       "LCM cannot be reached at udpm://no-address:0"}};
  const TempFolder folder;
  for (const Case& wrong : cases) {
    std::vector<std::string> command{"stillcut-dds"};
    command.insert(command.end(), wrong.arguments.begin(), wrong.arguments.end());
    const Finished done = run(command, folder.path());
    EXPECT_EQ(done.exit_code, wrong.exit_code) << done.err;
    EXPECT_NE(done.err.find(wrong.says), std::string::npos) << done.err;
  }
}

TEST(DdsProgram, ExplainsItselfWithAnExample) {
  const TempFolder folder;
  const Finished help = run({"stillcut-dds", "--help"}, folder.path());
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("Example:\n  stillcut-dds "), std::string::npos) << help.out;
}

}  // namespace
}  // namespace stillcut
