// The page's server: reads, never commands. Bound to loopback it asks for nothing but that it was called by its own
// name (a page from elsewhere may have its name resolve to this machine); elsewhere only with a token and TLS.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "tools/scope_feed.hpp"

namespace stillcut {

struct ScopeOptions {
  std::string address = "127.0.0.1";
  int port = 8421;               // 0: any free one
  std::string token;             // empty: none is asked for; loopback only
  std::string certificate, key;  // PEM files; empty: no TLS; loopback only
  std::filesystem::path page;    // folder with the built page
};

bool is_loopback(const std::string& address);

class ScopeServer {
 public:
  static constexpr int kMostStreams = 16;

  // Binds and begins to serve. Throws InputError (token, certificate, page) and ComponentError (port taken). The feed
  // must outlive it.
  ScopeServer(Feed& feed, const ScopeOptions& options);
  ~ScopeServer();  // ends all streams
  ScopeServer(const ScopeServer&) = delete;
  ScopeServer& operator=(const ScopeServer&) = delete;

  // False once listening has failed for good (the address went away).
  [[nodiscard]] bool serves() const;
  [[nodiscard]] int port() const;
  [[nodiscard]] std::string url() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stillcut
