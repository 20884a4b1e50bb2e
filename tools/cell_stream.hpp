// Turns what the daemon tells into the server-sent events of the page (docs/scope.md): live, of a recording and of a
// simulation alike. One thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "tools/cell_view.hpp"

namespace stillcut {

// Server-sent events as they go over the wire, shared by all who get them.
using Chunk = std::shared_ptr<const std::string>;

struct StreamItem {
  // Of one name only the newest counts ("state", "spectrum 0"); empty: each counts (an event, a correction).
  std::string newest_of;
  std::int64_t stamp_ns = 0;  // data time
  Chunk chunk;
};

class CellStream {
 public:
  using Emit = std::function<void(StreamItem)>;

  // origin_ns: time zero of the page.
  CellStream(std::int64_t origin_ns, Emit emit) : origin_ns_{origin_ns}, emit_{std::move(emit)} {}

  // received_ns: see CellView::take.
  void take(const TelemetryMessage& message, std::int64_t received_ns);
  // The state as it is now, heard or not; time_ns: data time.
  void tell_state(std::int64_t now_ns, std::int64_t time_ns);

  [[nodiscard]] const CellView& view() const { return view_; }

 private:
  void tell_news(std::int64_t received_ns);

  std::int64_t origin_ns_;
  Emit emit_;
  CellView view_;
  Shown shown_ = Shown::no_daemon;
  std::string reason_;
  std::pair<std::int64_t, std::int64_t> correction_told_{-1, 0};  // its sequence and stamp
};

// `event: NAME`, `data: JSON`.
Chunk server_sent_event(const char* name, const std::string& json);

}  // namespace stillcut
