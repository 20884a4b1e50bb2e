// What the page's server serves: a live cell, or one that has already been (a recording, a simulation).
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/cell_stream.hpp"

namespace stillcut {

// One viewer's way through a feed.
class FeedReader {
 public:
  virtual ~FeedReader() = default;
  // Waits at most so long; nullptr: nothing to send yet.
  virtual Chunk next(std::chrono::milliseconds longest) = 0;
};

class Feed {
 public:
  virtual ~Feed() = default;
  // Any thread.
  [[nodiscard]] virtual nlohmann::ordered_json about() const = 0;
  // from_s and speed are for what can be played again; a live cell has only now.
  [[nodiscard]] virtual std::unique_ptr<FeedReader> open(double from_s, double speed) = 0;
  [[nodiscard]] virtual std::string metrics() const = 0;
};

struct FeedTitle {
  std::string title, source, where;  // source: "daemon", "recording", "simulation"
  int teeth = 0;
  double min_rpm = kNaN, max_rpm = kNaN;  // NaN, null as JSON: the cell names no limits
};
nlohmann::ordered_json about_json(const FeedTitle& title);

// Messages go in on one thread, readers are on their own. A reader that does not keep up loses what lies between and
// goes on from now.
class LiveFeed : public Feed {
 public:
  explicit LiveFeed(FeedTitle title);

  void take(const TelemetryMessage& message);
  // To be called about ten times a second: says that nothing is heard any more.
  void tick();

  [[nodiscard]] nlohmann::ordered_json about() const override { return about_json(title_); }
  [[nodiscard]] std::unique_ptr<FeedReader> open(double from_s, double speed) override;
  [[nodiscard]] std::string metrics() const override;

 private:
  friend class LiveReader;
  using Queue = std::deque<Chunk>;

  void emit(const StreamItem& item);
  void fill(Queue& queue) const;

  FeedTitle title_;
  mutable std::mutex mutex_;
  std::condition_variable more_;
  CellStream stream_;
  std::map<std::string, Chunk> newest_;
  std::deque<Chunk> past_;  // events and corrections
  std::vector<Queue*> readers_;
  std::int64_t state_told_ns_ = 0;
};

// Everything that a viewer can be sent, in the order of data time. Filled by one thread before anyone reads.
class TimelineFeed : public Feed {
 public:
  explicit TimelineFeed(FeedTitle title) : title_{std::move(title)} {}

  // `received`: the messages of a run in their order. Stamps before origin_ns (time zero) count as of then.
  void begin(std::int64_t origin_ns);
  void take(const TelemetryMessage& message);
  void finish(std::int64_t end_ns);

  [[nodiscard]] nlohmann::ordered_json about() const override;
  [[nodiscard]] std::unique_ptr<FeedReader> open(double from_s, double speed) override;
  [[nodiscard]] std::string metrics() const override;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  friend class TimelineReader;
  struct Entry {
    double time_s;
    std::string newest_of;
    Chunk chunk;
  };

  void thin_out();

  FeedTitle title_;
  std::unique_ptr<CellStream> stream_;
  std::vector<Entry> entries_;
  nlohmann::ordered_json marks_ = nlohmann::ordered_json::array();
  std::int64_t origin_ns_ = 0, newest_ns_ = 0;
  double duration_s_ = 0.0;
  std::size_t bytes_ = 0;
  int keep_one_of_ = 1;  // of pictures that follow each other
  std::map<std::string, int> seen_;
};

}  // namespace stillcut
