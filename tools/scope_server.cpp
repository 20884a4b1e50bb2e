#include "tools/scope_server.hpp"

#include <httplib.h>
#undef _res  // a name of <resolv.h> that Eigen uses for itself: files may share a unit

#include <algorithm>
#include <atomic>
#include <charconv>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

#include "drivers/files/input_error.hpp"

namespace stillcut {

struct PageFile {
  std::string content;
  const char* type = "";
};
using PageFiles = std::map<std::string, PageFile>;  // by path, "/" among them

namespace {

constexpr std::size_t kMostInOneWrite = 32768;
constexpr std::chrono::milliseconds kWait{250};  // of a stream, before it looks whether the server ends
constexpr std::chrono::seconds kSignOfLife{2};   // a comment on a quiet stream: so a viewer's end is noticed
constexpr std::size_t kOtherThreads = 8;         // beside those that streams hold
constexpr std::size_t kShortestToken = 16;
constexpr int kTimeout_s = 3;  // of a viewer that neither reads nor writes
constexpr const char* kCookie = "stillcut_token";

const httplib::Headers kStrict{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
     "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"}};

const char* type_of(const std::filesystem::path& file) {
  static const std::map<std::string, const char*> kTypes{{".html", "text/html; charset=utf-8"},
                                                         {".js", "text/javascript; charset=utf-8"},
                                                         {".css", "text/css; charset=utf-8"},
                                                         {".svg", "image/svg+xml"},
                                                         {".png", "image/png"},
                                                         {".json", "application/json"}};
  const auto known = kTypes.find(file.extension().string());
  return known == kTypes.end() ? "application/octet-stream" : known->second;
}

// All of the page, once: what is not in here cannot be asked for, whatever the path.
PageFiles read_page(const std::filesystem::path& folder) {
  PageFiles files;
  std::error_code none;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, none)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in{entry.path(), std::ios::binary};
    std::ostringstream content;
    content << in.rdbuf();
    files['/' + entry.path().lexically_relative(folder).generic_string()] = {content.str(), type_of(entry.path())};
  }
  const auto index = files.find("/index.html");
  if (index == files.end())
    throw ComponentError("the page is not in " + folder.string() + "; build it: ninja -C build page");
  files["/"] = index->second;
  return files;
}

// Takes as long whatever the difference.
bool same_secret(const std::string& a, const std::string& b) {
  unsigned different = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()]);
  return different == 0;
}

std::string cookie_of(const httplib::Request& request) {
  const std::string all = request.get_header_value("Cookie"), name = std::string(kCookie) + '=';
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find(';', at), all.size());
    std::size_t begin = at;
    while (begin < end && all[begin] == ' ') ++begin;
    if (all.compare(begin, name.size(), name) == 0) return all.substr(begin + name.size(), end - begin - name.size());
    at = end + 1;
  }
  return {};
}

// Not "127.0.0.1.elsewhere.example".
bool is_ipv4_loopback(const std::string& host) {
  return host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string::npos;
}

// "[::1]:8421" is "[::1]".
std::string without_port(const std::string& host) {
  const std::size_t colon = host.rfind(':');
  return colon == std::string::npos || host.back() == ']' ? host : host.substr(0, colon);
}

// The number a query asks for; nothing: it is no number in the range.
std::optional<double> query_number(const httplib::Request& request, const char* name, double otherwise, double lowest,
                                   double highest) {
  if (!request.has_param(name)) return otherwise;
  const std::string text = request.get_param_value(name);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc{} && end == text.data() + text.size() && value >= lowest && value <= highest;
  return good ? std::optional{value} : std::nullopt;
}

void plain(httplib::Response& response, int status, const std::string& text) {
  response.status = status;
  response.set_content(text + '\n', "text/plain; charset=utf-8");
}

std::unique_ptr<httplib::Server> make_server(const ScopeOptions& options) {
  if (options.certificate.empty()) return std::make_unique<httplib::Server>();
  const char* wrong = nullptr;
  auto server = std::make_unique<httplib::SSLServer>([&](SSL_CTX& context) {
    SSL_CTX_set_min_proto_version(&context, TLS1_2_VERSION);
    if (SSL_CTX_use_certificate_chain_file(&context, options.certificate.c_str()) != 1) {
      wrong = "holds no certificate in PEM form that can be read";
    } else if (SSL_CTX_use_PrivateKey_file(&context, options.key.c_str(), SSL_FILETYPE_PEM) != 1) {
      wrong = "";
    }
    return wrong == nullptr;
  });
  if (wrong == nullptr) return server;
  if (*wrong != '\0') throw InputError(options.certificate, 0, wrong);
  throw InputError(options.key, 0, "holds no key in PEM form that belongs to " + options.certificate);
}

}  // namespace

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || is_ipv4_loopback(address);
}

struct ScopeServer::Parts {
  Parts(Feed& feed_served, const ScopeOptions& wanted)
      : feed{feed_served}, options{wanted}, files{read_page(wanted.page)}, server{make_server(wanted)} {}

  void answer(const httplib::Request& request, httplib::Response& response);
  void get(const httplib::Request& request, httplib::Response& response);
  void stream(const httplib::Request& request, httplib::Response& response);
  bool send_next(FeedReader& reader, std::chrono::steady_clock::time_point& last_sent, httplib::DataSink& sink) const;
  [[nodiscard]] bool called_by_its_name(const httplib::Request& request) const;
  [[nodiscard]] bool knows_the_token(const httplib::Request& request) const;

  Feed& feed;
  ScopeOptions options;
  PageFiles files;
  std::unique_ptr<httplib::Server> server;
  int port = 0;
  std::atomic<int> streams{0};
  std::atomic<bool> stopping{false}, ended{false};
  std::jthread thread;
};

bool ScopeServer::Parts::called_by_its_name(const httplib::Request& request) const {
  if (!is_loopback(options.address)) return true;  // the token says who may
  const std::string host = without_port(request.get_header_value("Host"));
  return host == "localhost" || host == "[::1]" || is_ipv4_loopback(host);
}

bool ScopeServer::Parts::knows_the_token(const httplib::Request& request) const {
  if (options.token.empty()) return true;
  return same_secret("Bearer " + options.token, request.get_header_value("Authorization")) ||
         same_secret(options.token, cookie_of(request));
}

void ScopeServer::Parts::answer(const httplib::Request& request, httplib::Response& response) {
  for (const auto& [name, value] : kStrict) response.set_header(name, value);
  if (request.method != "GET" && request.method != "HEAD") {
    response.set_header("Allow", "GET, HEAD");
    response.set_header("Connection", "close");  // what its body holds is not read
    return plain(response, 405, "this server only shows: GET");
  }
  if (!called_by_its_name(request)) return plain(response, 421, "call this server by its own address");
  if (!options.token.empty() && request.path == "/" && request.has_param("token")) {
    if (!same_secret(options.token, request.get_param_value("token"))) return plain(response, 401, "wrong token");
    response.set_header("Set-Cookie", std::string(kCookie) + '=' + options.token +
                                          "; Path=/; HttpOnly; SameSite=Strict" +
                                          (options.certificate.empty() ? "" : "; Secure"));
    response.set_redirect("/", 303);
    return;
  }
  if (!knows_the_token(request)) {
    response.set_header("WWW-Authenticate", "Bearer");
    return plain(response, 401, "a token is asked for: open /?token=TOKEN, or send 'Authorization: Bearer TOKEN'");
  }
  get(request, response);
}

void ScopeServer::Parts::get(const httplib::Request& request, httplib::Response& response) {
  if (request.path == "/api/stream") return stream(request, response);
  if (request.path == "/api/about") return response.set_content(feed.about().dump(), "application/json");
  if (request.path == "/metrics")
    return response.set_content(feed.metrics(), "text/plain; version=0.0.4; charset=utf-8");
  const auto file = files.find(request.path);
  if (file == files.end()) return plain(response, 404, "nothing here; the page is at /");
  response.set_content(file->second.content, file->second.type);
}

void ScopeServer::Parts::stream(const httplib::Request& request, httplib::Response& response) {
  const auto from_s = query_number(request, "from", 0.0, 0.0, 1e9);
  const auto speed = query_number(request, "speed", 1.0, 0.1, 50.0);
  if (!from_s) return plain(response, 400, "from: seconds from 0 on");
  if (!speed) return plain(response, 400, "speed: from 0.1 to 50");
  if (request.method == "HEAD") return response.set_content("", "text/event-stream");
  if (streams.fetch_add(1) >= kMostStreams) {
    streams.fetch_sub(1);
    response.set_header("Retry-After", "5");
    return plain(response, 503, "too many viewers; close one");
  }
  const std::shared_ptr<FeedReader> reader = feed.open(*from_s, *speed);
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, reader, last_sent = std::chrono::steady_clock::now()](std::size_t, httplib::DataSink& sink) mutable {
        return send_next(*reader, last_sent, sink);
      },
      [this](bool) { streams.fetch_sub(1); });
}

// Returns whether the stream goes on.
bool ScopeServer::Parts::send_next(FeedReader& reader, std::chrono::steady_clock::time_point& last_sent,
                                   httplib::DataSink& sink) const {
  std::string text;
  for (Chunk chunk = reader.next(kWait); chunk != nullptr; chunk = reader.next(std::chrono::milliseconds{0})) {
    text += *chunk;
    if (text.size() > kMostInOneWrite) break;
  }
  if (stopping) return false;
  const auto now = std::chrono::steady_clock::now();
  if (text.empty() && now - last_sent < kSignOfLife) return true;
  last_sent = now;
  if (text.empty()) text = ": still here\n\n";
  return sink.write(text.data(), text.size());
}

ScopeServer::ScopeServer(Feed& feed, const ScopeOptions& options) {
  if (!options.token.empty() && options.token.size() < kShortestToken)
    throw InputError("--token-file", 0, "the token must have 16 characters or more; make one: openssl rand -hex 16");
  parts_ = std::make_unique<Parts>(feed, options);
  httplib::Server& server = *parts_->server;
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    parts_->answer(request, response);
    return httplib::Server::HandlerResponse::Handled;
  });
  // Not SO_REUSEPORT, the library's default: a second server must hear that the port is taken.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_tcp_nodelay(true);
  server.set_read_timeout(kTimeout_s);
  server.set_write_timeout(kTimeout_s);
  server.set_keep_alive_timeout(kTimeout_s);
  server.set_payload_max_length(1024);
  server.new_task_queue = [] { return new httplib::ThreadPool(kOtherThreads + kMostStreams); };
  parts_->port = options.port == 0 ? server.bind_to_any_port(options.address)
                                   : (server.bind_to_port(options.address, options.port) ? options.port : -1);
  if (parts_->port < 0)
    throw ComponentError("cannot listen on " + options.address + " port " + std::to_string(options.port) +
                         ": it is taken, or the address is not of this host; choose another with --port or --address");
  parts_->thread = std::jthread{[parts = parts_.get()] {
    parts->server->listen_after_bind();
    parts->ended = true;
  }};
}

ScopeServer::~ScopeServer() {
  parts_->stopping = true;
  while (!parts_->server->is_running() && !parts_->ended)
    std::this_thread::sleep_for(std::chrono::milliseconds{1});  // stop() before it runs would be lost
  parts_->server->stop();
}

bool ScopeServer::serves() const { return !parts_->ended; }

int ScopeServer::port() const { return parts_->port; }

std::string ScopeServer::url() const {
  const std::string& address = parts_->options.address;
  const std::string host = address.find(':') == std::string::npos ? address : '[' + address + ']';
  return (parts_->options.certificate.empty() ? "http://" : "https://") + host + ':' + std::to_string(parts_->port) +
         '/';
}

}  // namespace stillcut
