#include "drivers/can/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace stillcut {
namespace {

static_assert(CanFrame::kExtended == CAN_EFF_FLAG && CanFrame::kRemote == CAN_RTR_FLAG &&
              CanFrame::kError == CAN_ERR_FLAG);

template <class Value>
bool set_option(int descriptor, int level, int name, const Value& value) {
  return ::setsockopt(descriptor, level, name, &value, sizeof value) == 0;
}

bool set_filter(int descriptor, std::span<const std::uint32_t> ids) {
  if (ids.empty()) return true;
  std::vector<can_filter> filters;
  for (const std::uint32_t id : ids) {
    filters.push_back({id, CAN_EFF_FLAG | CAN_RTR_FLAG | ((id & CAN_EFF_FLAG) != 0 ? CAN_EFF_MASK : CAN_SFF_MASK)});
  }
  return ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                      static_cast<socklen_t>(filters.size() * sizeof(can_filter))) == 0;
}

std::int64_t whole_microseconds(const timespec& t) { return t.tv_sec * 1'000'000'000LL + t.tv_nsec / 1'000 * 1'000; }

}  // namespace

bool kernel_has_can() {
  const int descriptor = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

unsigned interface_index(const std::string& interface) { return ::if_nametoindex(interface.c_str()); }

InterfaceState interface_state(const std::string& interface) {
  // Any socket can ask about interfaces; AF_UNIX is always there.
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return InterfaceState::gone;
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  const bool known = ::ioctl(descriptor, SIOCGIFFLAGS, &request) == 0;
  ::close(descriptor);
  if (!known) return InterfaceState::gone;
  constexpr int kUsable = IFF_UP | IFF_RUNNING;  // a controller that went bus-off is up but not running
  return (request.ifr_flags & kUsable) == kUsable ? InterfaceState::up : InterfaceState::down;
}

int open_can_socket(unsigned index, std::span<const std::uint32_t> ids) {
  const int descriptor = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (descriptor < 0) return -1;
  const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_CRTL | CAN_ERR_RESTARTED | CAN_ERR_BUSERROR | CAN_ERR_ACK;
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE | SOF_TIMESTAMPING_RX_HARDWARE |
                     SOF_TIMESTAMPING_RAW_HARDWARE;
  constexpr int kBufferBytes = 8 << 20;
  // Beyond the limit for ordinary users only with CAP_NET_ADMIN; without it the kernel gives what it allows.
  if (!set_option(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, kBufferBytes)) {
    set_option(descriptor, SOL_SOCKET, SO_RCVBUF, kBufferBytes);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  const bool ready = set_option(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1) && set_filter(descriptor, ids) &&
                     set_option(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) &&
                     set_option(descriptor, SOL_SOCKET, SO_TIMESTAMPING, stamps) &&
                     set_option(descriptor, SOL_SOCKET, SO_RXQ_OVFL, 1) &&
                     ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  if (ready) return descriptor;
  const int error = errno;
  ::close(descriptor);
  errno = error;
  return -1;
}

struct CanBatch::Impl {
  static constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(scm_timestamping)) + CMSG_SPACE(sizeof(std::uint32_t));
  std::array<canfd_frame, kFrames> frame{};
  std::array<iovec, kFrames> vector{};
  alignas(cmsghdr) std::array<std::array<char, kControlBytes>, kFrames> control{};
  std::array<mmsghdr, kFrames> message{};

  enum class StampSource : std::uint8_t { undecided, hardware, software } stamp_source = StampSource::undecided;
  std::int64_t last_stamp_ns = 0;
  std::uint32_t last_drops = 0;  // the socket's count, which wraps

  // The stamp of a message, and the drop count where it carries one.
  std::int64_t read_control(msghdr& header, std::uint32_t& drops) noexcept {
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != SOL_SOCKET) continue;
      if (c->cmsg_type == SO_RXQ_OVFL) std::memcpy(&drops, CMSG_DATA(c), sizeof drops);
      if (c->cmsg_type != SO_TIMESTAMPING) continue;
      scm_timestamping stamps{};
      std::memcpy(&stamps, CMSG_DATA(c), sizeof stamps);
      const std::int64_t software = whole_microseconds(stamps.ts[0]), hardware = whole_microseconds(stamps.ts[2]);
      if (stamp_source == StampSource::undecided) {
        stamp_source = hardware != 0 ? StampSource::hardware : StampSource::software;
      }
      const std::int64_t stamp = stamp_source == StampSource::hardware ? hardware : software;
      if (stamp != 0) last_stamp_ns = stamp;
    }
    return last_stamp_ns;
  }
};

CanBatch::CanBatch() : impl_(new Impl) {
  for (std::size_t i = 0; i < kFrames; ++i) {
    impl_->vector[i] = {&impl_->frame[i], sizeof(canfd_frame)};
    impl_->message[i].msg_hdr.msg_iov = &impl_->vector[i];
    impl_->message[i].msg_hdr.msg_iovlen = 1;
    impl_->message[i].msg_hdr.msg_control = impl_->control[i].data();
  }
}

void CanBatch::Delete::operator()(Impl* impl) const noexcept { delete impl; }

void CanBatch::reset() noexcept {
  impl_->stamp_source = Impl::StampSource::undecided;
  impl_->last_stamp_ns = 0;
  impl_->last_drops = 0;
}

CanBatch::Result CanBatch::receive(int descriptor, std::span<CanFrame> frames) noexcept {
  Result result;
  const unsigned room = static_cast<unsigned>(std::min<std::size_t>(kFrames, frames.size()));
  for (unsigned i = 0; i < room; ++i) impl_->message[i].msg_hdr.msg_controllen = Impl::kControlBytes;
  const int received = ::recvmmsg(descriptor, impl_->message.data(), room, MSG_DONTWAIT, nullptr);
  if (received <= 0) {
    result.error = received < 0 ? errno : 0;
    return result;
  }
  result.received = static_cast<std::size_t>(received);
  for (std::size_t i = 0; i < result.received; ++i) {
    std::uint32_t drops = impl_->last_drops;
    const std::int64_t stamp_ns = impl_->read_control(impl_->message[i].msg_hdr, drops);
    result.dropped += static_cast<std::uint32_t>(drops - impl_->last_drops);
    impl_->last_drops = drops;
    const std::size_t bytes = impl_->message[i].msg_len;
    const canfd_frame& from = impl_->frame[i];
    if ((bytes != CAN_MTU && bytes != CANFD_MTU) || from.len > (bytes == CAN_MTU ? CAN_MAX_DLEN : CANFD_MAX_DLEN)) {
      continue;  // no frame, or one cut short
    }
    CanFrame& to = frames[result.frames++];
    to.stamp_ns = stamp_ns;
    to.id = from.can_id;
    to.length = from.len;
    to.fd = bytes == CANFD_MTU;
    to.fd_flags = to.fd ? from.flags & 0x0F : 0;
    const auto rest = std::copy_n(from.data, from.len, to.data.begin());
    std::fill(rest, to.data.end(), std::uint8_t{0});
  }
  return result;
}

bool send_frame(int descriptor, const CanFrame& frame) noexcept {
  canfd_frame out{};  // a classic frame is its beginning
  out.can_id = frame.id;
  out.len = std::min<std::uint8_t>(frame.length, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  out.flags = frame.fd ? frame.fd_flags & (CANFD_BRS | CANFD_ESI) : 0;
  std::copy_n(frame.data.begin(), out.len, out.data);
  const std::size_t bytes = frame.fd ? CANFD_MTU : CAN_MTU;
  return ::send(descriptor, &out, bytes, MSG_DONTWAIT) == static_cast<ssize_t>(bytes);
}

}  // namespace stillcut
