#include "tools/scope_feed.hpp"

#include <algorithm>
#include <cmath>

#include "rt/periodic.hpp"
#include "tools/cell_json.hpp"
#include "tools/event_csv.hpp"
#include "tools/live_loop.hpp"
#include "tools/scope_metrics.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMostChunksWaiting = 400;          // chunks of a reader: eight seconds
constexpr std::size_t kPastKept = 100;                   // events and corrections that a new viewer gets
constexpr std::int64_t kStateEvery_ns = 250'000'000;     // where nothing is heard
constexpr std::size_t kMostTimelineBytes = 256U << 20U;  // of a timeline

}  // namespace

nlohmann::ordered_json about_json(const FeedTitle& title) {
  return {{"title", title.title},        {"source", title.source},
          {"where", title.where},        {"duration_s", nullptr},
          {"start_utime", nullptr},      {"teeth", title.teeth},
          {"min_rpm", title.min_rpm},    {"max_rpm", title.max_rpm},
          {"version", STILLCUT_VERSION}, {"marks", nlohmann::ordered_json::array()}};
}

// The live cell.

class LiveReader : public FeedReader {
 public:
  explicit LiveReader(LiveFeed& feed) : feed_{feed} {
    const std::scoped_lock lock{feed_.mutex_};
    feed_.fill(queue_);
    feed_.readers_.push_back(&queue_);
  }
  ~LiveReader() override {
    const std::scoped_lock lock{feed_.mutex_};
    std::erase(feed_.readers_, &queue_);
  }
  LiveReader(const LiveReader&) = delete;
  LiveReader& operator=(const LiveReader&) = delete;

  Chunk next(std::chrono::milliseconds longest) override {
    std::unique_lock lock{feed_.mutex_};
    if (!feed_.more_.wait_for(lock, longest, [this] { return !queue_.empty(); })) return nullptr;
    Chunk chunk = std::move(queue_.front());
    queue_.pop_front();
    return chunk;
  }

 private:
  LiveFeed& feed_;
  LiveFeed::Queue queue_;
};

LiveFeed::LiveFeed(FeedTitle title)
    : title_{std::move(title)}, stream_{0, [this](const StreamItem& item) { emit(item); }} {}

void LiveFeed::take(const TelemetryMessage& message) {
  const std::scoped_lock lock{mutex_};
  stream_.take(message, monotonic_ns());
}

void LiveFeed::tick() {
  const std::scoped_lock lock{mutex_};
  if (monotonic_ns() - state_told_ns_ >= kStateEvery_ns) stream_.tell_state(monotonic_ns(), realtime_ns());
}

// Under the lock.
void LiveFeed::emit(const StreamItem& item) {
  if (item.newest_of == "state") state_told_ns_ = monotonic_ns();
  if (item.newest_of.empty()) {
    past_.push_back(item.chunk);
    if (past_.size() > kPastKept) past_.pop_front();
  } else {
    newest_[item.newest_of] = item.chunk;
  }
  for (Queue* queue : readers_) {
    if (queue->size() < kMostChunksWaiting) {
      queue->push_back(item.chunk);
    } else {
      queue->clear();
      fill(*queue);
    }
  }
  more_.notify_all();
}

void LiveFeed::fill(Queue& queue) const {
  for (const auto& [name, chunk] : newest_) queue.push_back(chunk);
  queue.insert(queue.end(), past_.begin(), past_.end());
}

std::unique_ptr<FeedReader> LiveFeed::open(double /*from_s*/, double /*speed*/) {
  return std::make_unique<LiveReader>(*this);
}

std::string LiveFeed::metrics() const {
  const std::scoped_lock lock{mutex_};
  return prometheus_text(stream_.view(), title_.title, monotonic_ns());
}

// What has already been.

class TimelineReader : public FeedReader {
 public:
  TimelineReader(const TimelineFeed& feed, double from_s, double speed) : feed_{feed}, from_s_{from_s}, speed_{speed} {
    const auto& entries = feed.entries_;
    next_ = static_cast<std::size_t>(
        std::partition_point(entries.begin(), entries.end(), [&](const auto& e) { return e.time_s <= from_s; }) -
        entries.begin());
    // The page as it was then: the newest of each picture, and the events before.
    std::map<std::string, Chunk> newest;
    std::deque<Chunk> past;
    for (std::size_t i = 0; i < next_; ++i) {
      if (!entries[i].newest_of.empty()) {
        newest[entries[i].newest_of] = entries[i].chunk;
      } else {
        past.push_back(entries[i].chunk);
        if (past.size() > kPastKept) past.pop_front();
      }
    }
    for (const auto& [name, chunk] : newest) first_.push_back(chunk);
    first_.insert(first_.end(), past.begin(), past.end());
  }

  Chunk next(std::chrono::milliseconds longest) override {
    if (!first_.empty()) {
      Chunk chunk = std::move(first_.front());
      first_.pop_front();
      return chunk;
    }
    const bool at_end = next_ >= feed_.entries_.size();
    const double due_s = at_end ? feed_.duration_s_ : feed_.entries_[next_].time_s;
    const auto due = started_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                    std::chrono::duration<double>{(due_s - from_s_) / speed_});
    const auto until = std::min(due, std::chrono::steady_clock::now() + longest);
    if (ended_ || until < due) {
      std::this_thread::sleep_until(ended_ ? std::chrono::steady_clock::now() + longest : until);
      return nullptr;
    }
    std::this_thread::sleep_until(due);
    if (!at_end) return feed_.entries_[next_++].chunk;
    ended_ = true;
    return server_sent_event("end", nlohmann::ordered_json{{"t", feed_.duration_s_}}.dump());
  }

 private:
  const TimelineFeed& feed_;
  double from_s_, speed_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::deque<Chunk> first_;
  std::size_t next_ = 0;
  bool ended_ = false;
};

void TimelineFeed::begin(std::int64_t origin_ns) {
  origin_ns_ = newest_ns_ = origin_ns;
  stream_ = std::make_unique<CellStream>(origin_ns, [this](StreamItem item) {
    // Decisions carry the stamp of the samples that they rest on, a little before the present: order is what counts.
    newest_ns_ = std::max(newest_ns_, item.stamp_ns);
    if (!item.newest_of.empty() && seen_[item.newest_of]++ % keep_one_of_ != 0) return;
    bytes_ += item.chunk->size();
    entries_.push_back({static_cast<double>(newest_ns_ - origin_ns_) * 1e-9, std::move(item.newest_of), item.chunk});
    if (bytes_ > kMostTimelineBytes) thin_out();
  });
}

void TimelineFeed::take(const TelemetryMessage& message) {
  stream_->take(message, newest_ns_);
  if (const auto* event = std::get_if<Event>(&message))
    marks_.push_back({{"t", static_cast<double>(event->stamp_ns - origin_ns_) * 1e-9},
                      {"event", event_name(event->type)},
                      {"kind", kind_name(*event)}});
}

// Hours take more room than there is: every other picture goes, no event does.
void TimelineFeed::thin_out() {
  keep_one_of_ *= 2;
  bytes_ = 0;
  std::map<std::string, int> seen;
  std::erase_if(entries_, [&](const Entry& entry) {
    const bool goes = !entry.newest_of.empty() && seen[entry.newest_of]++ % 2 != 0;
    if (!goes) bytes_ += entry.chunk->size();
    return goes;
  });
}

void TimelineFeed::finish(std::int64_t end_ns) {
  duration_s_ = static_cast<double>(std::max(end_ns, newest_ns_) - origin_ns_) * 1e-9;
}

nlohmann::ordered_json TimelineFeed::about() const {
  nlohmann::ordered_json json = about_json(title_);
  json["duration_s"] = duration_s_;
  json["start_utime"] = origin_ns_ / 1000;
  json["marks"] = marks_;
  return json;
}

std::unique_ptr<FeedReader> TimelineFeed::open(double from_s, double speed) {
  return std::make_unique<TimelineReader>(*this, std::clamp(from_s, 0.0, duration_s_), speed);
}

std::string TimelineFeed::metrics() const { return prometheus_text(stream_->view(), title_.title, newest_ns_); }

}  // namespace stillcut
