// The adapters as a user starts them: help, and what a wrong start says and ends with.
#include <gtest/gtest.h>

#include "adapters/udp_port.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

constexpr const char* kDemoCell = EXAMPLES "/demo-cell/cell.toml";

TEST(AdapterPrograms, ExplainThemselvesWithAnExample) {
  const TempFolder folder;
  for (const char* program : {"stillcut-rsi", "stillcut-rsi-controller", "stillcut-egm", "stillcut-egm-controller",
                              "stillcut-linuxcnc", "stillcut-linuxcnc-controller"}) {
    const Finished help = run({program, "--help"}, folder.path());
    EXPECT_EQ(help.exit_code, 0) << program;
    EXPECT_NE(help.out.find(std::string{"Example:\n  "} + program + " "), std::string::npos) << help.out;
  }
}

TEST(AdapterPrograms, EndWithTheCodeOfTheContractAndOneLine) {
  const TempFolder folder;
  const std::string no_spindle = folder.write("cell.toml", "[lcm]\nurl = \"memq://\"\n").string();
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const std::vector<Case> cases{
      {{"stillcut-rsi"}, 2, "stillcut-rsi: CELL is required; see 'stillcut-rsi --help'\n"},
      {{"stillcut-rsi", kDemoCell, "--cycle-ms", "5"}, 2, "--cycle-ms"},
      {{"stillcut-egm", kDemoCell, "--listen", "here"}, 2, "'here' is no address"},
      {{"stillcut-egm", kDemoCell, "--answer", "both"}, 2, "both"},
      {{"stillcut-linuxcnc", "none.toml"}, 3, "stillcut-linuxcnc: none.toml: "},
      {{"stillcut-rsi", no_spindle}, 3, no_spindle + ": [spindle] is missing; add this section"},
      {{"stillcut-rsi", kDemoCell, "--lcm", "memq://", "--record", "none/x", "--duration", "1"},
       3,
       "none/x: cannot be"},
      {{"stillcut-rsi", kDemoCell, "--lcm", "memq://", "--listen", "192.0.2.77:49152"}, 4, "cannot listen on UDP port"},
      {{"stillcut-rsi-controller", "--adapter", "nowhere", "--duration", "1"}, 2, "'nowhere' is no address"}};
  for (const Case& wrong : cases) {
    const Finished done = run(wrong.arguments, folder.path());
    EXPECT_EQ(done.exit_code, wrong.exit_code) << done.err;
    EXPECT_NE(done.err.find(wrong.says), std::string::npos) << done.err;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  }
}

// What is recorded while a real controller and a stranger talk to it.
TEST(AdapterPrograms, ServesOneControllerAndRecordsTheExchange) {
  const TempFolder folder;
  {
    Running adapter{{"stillcut-rsi", kDemoCell, "--lcm", "memq://", "--listen", "127.0.0.1:49321", "--record", "x.txt"},
                    folder.path()};
    UdpPort controller{ipv4_address("127.0.0.1:0")}, stranger{ipv4_address("127.0.0.1:0")};
    const sockaddr_in address = ipv4_address("127.0.0.1:49321");
    const auto packet = [](int ipoc) {
      return R"(<Rob Type="KUKA"><RIst X="0" Y="0" Z="0" A="0" B="0" C="0"/><IPOC>)" + std::to_string(ipoc) +
             "</IPOC></Rob>";
    };
    UdpPort::Packet answer;
    int ipoc = 4;
    for (; answer.bytes.empty() && ipoc < 4000; ipoc += 4) {  // until it has started
      controller.send(address, packet(ipoc));
      answer = controller.receive(50);
    }
    ASSERT_FALSE(answer.bytes.empty());
    stranger.send(address, packet(ipoc));
    controller.send(address, packet(ipoc + 4));
    EXPECT_FALSE(controller.receive(10'000).bytes.empty());
    EXPECT_TRUE(stranger.receive(0).bytes.empty());
    adapter.signal(SIGTERM);
    const Finished done = adapter.wait();
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_NE(done.err.find("of strangers 1"), std::string::npos) << done.err;
  }
  const std::string recorded = content_of(folder.path() / "x.txt");
  EXPECT_NE(recorded.find(" packet <Rob Type=\"KUKA\">"), std::string::npos);
  EXPECT_NE(recorded.find(" answer <Sen Type=\"Stillcut\">"), std::string::npos);
}

}  // namespace
}  // namespace stillcut
