#include "tools/scope_server.hpp"

#include <gtest/gtest.h>
#include <httplib.h>
#undef _res  // a name of <resolv.h> that Eigen uses for itself: files may share a unit

#include <cmath>
#include <fstream>
#include <random>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

class ScopeServerTest : public testing::Test {
 protected:
  void SetUp() override {
    page_ = std::filesystem::path{testing::TempDir()} / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(page_ / "assets");
    std::ofstream{page_ / "index.html"} << "<!doctype html><title>page</title>";
    std::ofstream{page_ / "assets/page.js"} << "1;";
    std::ofstream{page_.parent_path() / "secret.txt"} << "not of the page";
    options_.page = page_;
    options_.port = 0;
  }
  void TearDown() override { std::filesystem::remove_all(page_); }

  static MonitorReport stable_cut() {
    MonitorReport report;
    report.stamp_ns = 1'700'000'000'000'000'000;
    report.state = State::cut;
    report.indicator = 0.1;
    return report;
  }
  httplib::Client client(const ScopeServer& server) const { return httplib::Client{"127.0.0.1", server.port()}; }

  std::filesystem::path page_;
  ScopeOptions options_;
  LiveFeed feed_{FeedTitle{"cell", "daemon", "memq://", 2, 2800.0, 3800.0}};
};

TEST_F(ScopeServerTest, ServesThePageTheFactsAndTheMetricsWithStrictHeaders) {
  const ScopeServer server{feed_, options_};
  httplib::Client browser = client(server);
  for (const auto& [path, type] :
       std::vector<std::pair<std::string, std::string>>{{"/", "text/html"},
                                                        {"/assets/page.js", "text/javascript"},
                                                        {"/api/about", "application/json"},
                                                        {"/metrics", "text/plain"}}) {
    const auto answer = browser.Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->status, 200) << path;
    EXPECT_TRUE(answer->get_header_value("Content-Type").starts_with(type)) << path;
    EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff");
    EXPECT_TRUE(answer->get_header_value("Content-Security-Policy").starts_with("default-src 'none'"));
  }
  EXPECT_EQ(browser.Get("/nothing")->status, 404);
}

TEST_F(ScopeServerTest, TakesNoCommandsWhateverTheMethod) {
  const ScopeServer server{feed_, options_};
  httplib::Client browser = client(server);
  EXPECT_EQ(browser.Post("/api/about", "x", "text/plain")->status, 405);
  EXPECT_EQ(browser.Put("/", "x", "text/plain")->status, 405);
  EXPECT_EQ(browser.Delete("/api/stream")->status, 405);
  EXPECT_EQ(browser.Options("/")->status, 405);
}

TEST_F(ScopeServerTest, NoPathLeadsOutOfThePage) {
  const ScopeServer server{feed_, options_};
  httplib::Client browser = client(server);
  for (const char* path : {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
                           "//secret.txt", "/assets/..\\..\\secret.txt", "/\x01", "/assets/%00"}) {
    const auto answer = browser.Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_NE(answer->status, 200) << path;
  }
}

TEST_F(ScopeServerTest, RandomRequestsAreAnsweredOrClosedAndTheServerLives) {
  const ScopeServer server{feed_, options_};
  std::mt19937 random{5};
  const std::string letters = "/%.?&=#abcstream0123456789 \t\xC3\xA9\x7F:-_";
  for (int round = 0; round < 300; ++round) {
    std::string path = "/";
    for (unsigned n = random() % 60; n > 0; --n) path += letters[random() % letters.size()];
    httplib::Client browser = client(server);
    browser.set_read_timeout(2);
    browser.set_default_headers({{"Cookie", path}, {"Authorization", path}});
    if (path.find("stream") != std::string::npos) continue;
    if (const auto answer = browser.Get(path)) {
      EXPECT_TRUE(answer->status == 200 || answer->status >= 400) << path;
    }
  }
  EXPECT_EQ(client(server).Get("/api/about")->status, 200);
}

TEST_F(ScopeServerTest, APageFromElsewhereCannotReadALoopbackServer) {
  const ScopeServer server{feed_, options_};
  httplib::Client browser = client(server);
  EXPECT_EQ(browser.Get("/api/about", {{"Host", "evil.example"}})->status, 421);
  EXPECT_EQ(browser.Get("/api/about", {{"Host", "localhost:8421"}})->status, 200);
  EXPECT_EQ(browser.Get("/api/about", {{"Host", "127.0.0.1.evil.example"}})->status, 421);
}

TEST_F(ScopeServerTest, AsksForTheTokenByHeaderCookieOrAddress) {
  options_.token = "0123456789abcdef";
  const ScopeServer server{feed_, options_};
  httplib::Client browser = client(server);
  EXPECT_EQ(browser.Get("/api/about")->status, 401);
  EXPECT_EQ(browser.Get("/metrics", {{"Authorization", "Bearer 0123456789abcdeX"}})->status, 401);
  EXPECT_EQ(browser.Get("/metrics", {{"Authorization", "Bearer 0123456789abcdef"}})->status, 200);
  EXPECT_EQ(browser.Get("/?token=wrong")->status, 401);
  const auto entered = browser.Get("/?token=0123456789abcdef");
  EXPECT_EQ(entered->status, 303);
  const std::string cookie = entered->get_header_value("Set-Cookie");
  EXPECT_NE(cookie.find("HttpOnly"), std::string::npos);
  EXPECT_NE(cookie.find("SameSite=Strict"), std::string::npos);
  EXPECT_EQ(browser.Get("/", {{"Cookie", "a=b; " + cookie.substr(0, cookie.find(';'))}})->status, 200);
  EXPECT_EQ(browser.Get("/", {{"Cookie", "stillcut_token="}})->status, 401);
}

TEST_F(ScopeServerTest, SaysWhatToDoWhenItCannotStart) {
  const ScopeServer server{feed_, options_};
  ScopeOptions taken = options_;
  taken.port = server.port();
  EXPECT_THROW((ScopeServer{feed_, taken}), ComponentError);
  ScopeOptions weak = options_;
  weak.token = "short";
  EXPECT_THROW((ScopeServer{feed_, weak}), InputError);
  ScopeOptions pageless = options_;
  pageless.page = "/nowhere";
  EXPECT_THROW((ScopeServer{feed_, pageless}), ComponentError);
  ScopeOptions odd = options_;
  odd.certificate = odd.key = (page_ / "index.html").string();
  EXPECT_THROW((ScopeServer{feed_, odd}), InputError);
}

// Reads a stream until `enough` says so.
std::string read_stream(const ScopeServer& server, const std::string& path,
                        const std::function<bool(const std::string&)>& enough) {
  std::string heard;
  httplib::Client browser{"127.0.0.1", server.port()};
  browser.Get(path, [&](const char* data, std::size_t size) {
    heard.append(data, size);
    return !enough(heard);
  });
  return heard;
}

TEST_F(ScopeServerTest, AStreamBeginsWithWhatIsKnownAndGoesOnWithWhatComes) {
  feed_.take(stable_cut());
  feed_.take(Event{.stamp_ns = 1, .type = EventType::cut_entry, .note = short_text("first")});
  const ScopeServer server{feed_, options_};
  bool sent = false;
  const std::string heard = read_stream(server, "/api/stream", [&](const std::string& so_far) {
    if (!sent && so_far.find("cut_entry") != std::string::npos) {
      sent = true;
      MonitorReport chatter = stable_cut();
      chatter.state = State::chatter;
      chatter.chatter = true;
      feed_.take(chatter);
    }
    return so_far.find("\"state\":\"chatter\"") != std::string::npos;
  });
  EXPECT_TRUE(sent);
  EXPECT_LT(heard.find("\"state\":\"stable\""), heard.find("\"state\":\"chatter\""));
}

TEST_F(ScopeServerTest, WhoDoesNotReadHoldsNobodyUpAndMissesWhatLiesBetween) {
  feed_.take(stable_cut());
  const std::unique_ptr<FeedReader> slow = feed_.open(0.0, 1.0);
  for (int i = 0; i < 100'000; ++i) {
    MonitorReport report = stable_cut();
    report.stamp_ns += std::int64_t{i} * 50'000'000;
    feed_.take(report);
  }
  std::size_t waiting = 0;
  std::string last;
  for (Chunk chunk = slow->next(std::chrono::milliseconds{0}); chunk; ++waiting) {
    last = *chunk;
    chunk = slow->next(std::chrono::milliseconds{0});
  }
  EXPECT_LE(waiting, 500U);
  EXPECT_NE(last.find("\"t\":1700004999.95"), std::string::npos) << last;
}

TEST_F(ScopeServerTest, BadPlacesAndTooManyViewersAreRefused) {
  feed_.take(stable_cut());
  const ScopeServer server{feed_, options_};
  for (const char* query : {"from=x", "from=-1", "from=nan", "speed=0", "speed=1e9", "speed=inf", "from=1;2"})
    EXPECT_EQ(client(server).Get(std::string("/api/stream?") + query)->status, 400) << query;
  std::vector<std::unique_ptr<std::jthread>> viewers;
  std::atomic<int> watching{0};
  std::atomic<bool> enough{false};
  for (int i = 0; i < ScopeServer::kMostStreams; ++i)
    viewers.push_back(std::make_unique<std::jthread>([&] {
      bool counted = false;
      read_stream(server, "/api/stream", [&](const std::string&) {
        if (!std::exchange(counted, true)) ++watching;
        return enough.load();
      });
    }));
  while (watching < ScopeServer::kMostStreams) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  EXPECT_EQ(client(server).Get("/api/stream")->status, 503);
  EXPECT_EQ(client(server).Get("/api/about")->status, 200) << "others are still served";
  enough = true;
  feed_.take(stable_cut());
}

TEST(About, IsSilentOfLimitsThatTheCellDoesNotName) {
  const auto told = [](const FeedTitle& title) { return nlohmann::json::parse(about_json(title).dump()); };
  EXPECT_EQ(told({.title = "cell", .source = "daemon", .where = "memq://", .teeth = 2, .min_rpm = 2800.0})["min_rpm"],
            2800.0);
  EXPECT_TRUE(told({.title = "cell", .source = "daemon", .where = "memq://"})["min_rpm"].is_null());
}

TEST_F(ScopeServerTest, ATimelinePlaysFromWhereItIsAskedAndEnds) {
  TimelineFeed timeline{FeedTitle{"cell", "recording", "cut.log", 2, 0.0, 0.0}};
  const std::int64_t origin_ns = 1'700'000'000'000'000'000;
  timeline.begin(origin_ns);
  for (int i = 0; i <= 100; ++i) {
    MonitorReport report = stable_cut();
    report.stamp_ns = origin_ns + std::int64_t{i} * 50'000'000;
    timeline.take(report);
    if (i == 40)
      timeline.take(Event{.stamp_ns = report.stamp_ns - 3'000'000, .type = EventType::chatter_onset, .note = {}});
  }
  timeline.finish(origin_ns + 5'000'000'000);
  EXPECT_EQ(timeline.about()["duration_s"], 5.0);
  EXPECT_EQ(timeline.about()["marks"][0]["event"], "chatter_onset");
  const ScopeServer server{timeline, options_};
  const std::string heard = read_stream(server, "/api/stream?from=4.5&speed=50", [](const std::string& so_far) {
    return so_far.find("event: end") != std::string::npos;
  });
  EXPECT_NE(heard.find("chatter_onset"), std::string::npos) << "what was before is shown";
  EXPECT_NE(heard.find("\"t\":4.5,"), std::string::npos);
  EXPECT_EQ(heard.find("\"t\":4.4,"), std::string::npos);
  EXPECT_NE(heard.find("\"t\":5.0"), std::string::npos);
}

TEST_F(ScopeServerTest, MetricsAreInPrometheusFormat) {
  feed_.take(stable_cut());
  HealthReport health;
  health.frames = 12;
  health.kernel_dropped = 3;
  health.sensors = {{25600.0, 25601.0, 1, 1, 0, 0}};
  feed_.take(health);
  const std::string text = feed_.metrics();
  EXPECT_NE(text.find("stillcut_lost_total{cell=\"cell\",hop=\"kernel\"} 3\n"), std::string::npos);
  EXPECT_NE(text.find("stillcut_state{cell=\"cell\",state=\"stable\"} 1\n"), std::string::npos);
  std::istringstream lines{text};
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) name = line.substr(7, line.find(' ', 7) - 7);
    if (line.starts_with('#')) continue;
    EXPECT_TRUE(line.starts_with(name + '{')) << line;
    std::size_t used = 0;
    const std::string value = line.substr(line.rfind(' ') + 1);
    (void)std::stod(value, &used);
    EXPECT_EQ(used, value.size()) << line;
  }
}

// The dashboard of docs/grafana asks for nothing that is not there.
TEST_F(ScopeServerTest, TheDashboardAsksOnlyForMetricsThatAreServed) {
  MonitorReport chatter = stable_cut();
  chatter.chatter = true;
  chatter.chatter_frequency_hz = 500.0;
  chatter.axial_depth = chatter.depth_limit = 1e-3;
  chatter.spindle_speed_rpm = 3000.0;
  feed_.take(chatter);
  feed_.take(Correction{.stamp_ns = chatter.stamp_ns, .valid_for_ms = 500, .kind = CorrectionKind::spindle_speed});
  HealthReport health;
  health.sensors = {{25600.0, 25601.0, 0, 0, 0, 0}};
  feed_.take(health);
  feed_.take(latency_report(LoopTimes{}, 0));
  const std::string served = feed_.metrics();
  std::ifstream in{std::string(EXAMPLES) + "/../docs/grafana/stillcut.json"};
  const nlohmann::json dashboard = nlohmann::json::parse(in);
  int asked = 0;
  for (const auto& panel : dashboard["panels"]) {
    for (const auto& target : panel["targets"]) {
      const std::string expression = target["expr"];
      const std::size_t at = expression.find("stillcut_");
      const std::string name = expression.substr(at, expression.find('{', at) - at);
      EXPECT_NE(served.find('\n' + name + '{'), std::string::npos) << name;
      ++asked;
    }
  }
  EXPECT_GT(asked, 10);
}

}  // namespace
}  // namespace stillcut
