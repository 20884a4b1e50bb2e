// local:NAME: a bus between processes of one user on a machine without kernel CAN, through POSIX shared memory. Each
// member gets the frames that the others send from its opening on, stamped by the sender (CLOCK_REALTIME, whole
// microseconds).
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "drivers/can/bus_kinds.hpp"
#include "drivers/can/local_ring.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

// The mapped ring. Every member holds a shared lock on it; the kernel lets go of it when a process dies. Whoever closes
// and gets the lock for itself alone was the last one and removes the memory.
class LocalSegment {
 public:
  explicit LocalSegment(const std::string& bus_name) : name_("/stillcut-can-1-" + bus_name) {
    while (!open_current()) {
    }
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || (status.st_size != 0 && status.st_size != sizeof(LocalRing))) {
      fail("has not the expected size; remove it");
    }
    // Allocated, not only sized: on a full /dev/shm this fails here and not at the first touch.
    if (const int error = ::posix_fallocate(descriptor_, 0, sizeof(LocalRing)); error != 0) {
      fail(std::string("cannot be allocated: ") + std::strerror(error));
    }
    void* memory =
        ::mmap(nullptr, sizeof(LocalRing), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, descriptor_, 0);
    if (memory == MAP_FAILED) fail(std::string("cannot be mapped: ") + std::strerror(errno));
    ring_ = static_cast<LocalRing*>(memory);
  }

  ~LocalSegment() {
    ::munmap(ring_, sizeof(LocalRing));
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) ::shm_unlink(name_.c_str());
    ::close(descriptor_);
  }

  LocalSegment(const LocalSegment&) = delete;
  LocalSegment& operator=(const LocalSegment&) = delete;

  LocalRing& ring() noexcept { return *ring_; }
  [[nodiscard]] const LocalRing& ring() const noexcept { return *ring_; }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    const std::string message = "local bus: shared memory /dev/shm" + name_ + " " + what;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw ComponentError(message);
  }

  // False when the last member removed the memory between our opening and locking it.
  bool open_current() {
    descriptor_ = ::shm_open(name_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor_ < 0) {
      fail(std::string("cannot be opened: ") + std::strerror(errno) +
           (errno == EACCES ? "; all members of a local bus run as one user"
                            : "; mount it: `mount -t tmpfs tmpfs /dev/shm`"));
    }
    struct stat ours {
    }, named{};
    if (::flock(descriptor_, LOCK_SH) != 0 || ::fstat(descriptor_, &ours) != 0) fail("cannot be locked");
    const int again = ::shm_open(name_.c_str(), O_RDWR | O_CLOEXEC, 0600);
    const bool same = again >= 0 && ::fstat(again, &named) == 0 && named.st_ino == ours.st_ino;
    if (again >= 0) ::close(again);
    if (!same) ::close(std::exchange(descriptor_, -1));
    return same;
  }

  std::string name_;
  int descriptor_ = -1;
  LocalRing* ring_ = nullptr;
};

class LocalBus final : public CanBus {
 public:
  explicit LocalBus(const std::string& name)
      : segment_(name), member_(segment_.ring().join()), place_(segment_.ring().end()) {}

  std::size_t receive(std::span<CanFrame> frames) noexcept override {
    std::size_t n = 0;
    std::uint32_t sender = 0;
    std::uint64_t lost = 0;
    while (n < frames.size()) {
      const LocalRing::Read result = segment_.ring().read(place_, frames[n], sender, lost);
      if (result == LocalRing::Read::nothing) break;
      if (result == LocalRing::Read::lost) counted_.dropped.add(static_cast<std::int64_t>(lost));
      if (result == LocalRing::Read::lost || sender == member_) continue;
      frames[n].length = std::min<std::uint8_t>(frames[n].length, 64);  // memory shared with others is not trusted
      counted_.delivered(frames[n++]);
    }
    return n;
  }

  bool send(const CanFrame& frame) noexcept override {
    CanFrame stamped = frame;
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    stamped.stamp_ns = now.tv_sec * 1'000'000'000LL + now.tv_nsec / 1'000 * 1'000;
    return segment_.ring().write(stamped, member_);
  }

  // A bus without other members looks like one on which nobody sends.
  [[nodiscard]] BusState state() const noexcept override { return BusState::up; }

  [[nodiscard]] BusCounters counters() const noexcept override { return counted_.copy(); }

 private:
  LocalSegment segment_;
  std::uint32_t member_;
  std::uint64_t place_;
  CountedBus counted_;
};

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

}  // namespace

std::unique_ptr<CanBus> open_local_bus(const std::string& name) {
  if (name.size() > 64 || !std::all_of(name.begin(), name.end(), is_name_character)) {
    throw InputError("CAN bus 'local:" + name + "'", 0, "a name has up to 64 letters, digits, '-' and '_'");
  }
  return std::make_unique<LocalBus>(name);
}

}  // namespace stillcut
