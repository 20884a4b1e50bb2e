#include "drivers/files/byte_source.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "drivers/files/input_error.hpp"

namespace stillcut {

struct ByteSource::Decompression {
  Decompression() : stream{ZSTD_createDStream()}, wanted{ZSTD_initDStream(stream)}, buffer(ZSTD_DStreamInSize()) {}
  ~Decompression() { ZSTD_freeDStream(stream); }
  Decompression(const Decompression&) = delete;
  Decompression& operator=(const Decompression&) = delete;

  ZSTD_DStream* stream;
  std::size_t wanted;  // bytes up to the end of the next block
  std::vector<char> buffer;
  std::size_t begin = 0, end = 0;  // unread part of the buffer
  bool more_inside = false;        // the last call filled what it was given
  bool damaged = false;
};

bool is_compressed(const std::filesystem::path& file) { return file.extension() == ".zst"; }

ByteSource::ByteSource() = default;
ByteSource::~ByteSource() { close(); }

bool ByteSource::open(const std::filesystem::path& file) {
  close();
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  error_ = descriptor_ < 0 ? errno : 0;
  if (is_compressed(file)) decompression_ = std::make_unique<Decompression>();
  return descriptor_ >= 0;
}

void ByteSource::close() noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  decompression_.reset();
}

std::size_t ByteSource::read(char* to, std::size_t bytes) noexcept {
  return decompression_ ? decompress(to, bytes) : read_file(to, bytes);
}

std::size_t ByteSource::read_file(char* to, std::size_t bytes) noexcept {
  if (descriptor_ < 0) return 0;
  ssize_t got = 0;
  do {
    got = ::read(descriptor_, to, bytes);
  } while (got < 0 && errno == EINTR);
  if (got < 0) error_ = errno;
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

// Block by block: where one is damaged, zstd gives nothing of what the same call decompressed before it. What follows
// damage (a power cut may leave a page of zeros at the end) cannot be told from noise: it ends there.
std::size_t ByteSource::decompress(char* to, std::size_t bytes) noexcept {
  Decompression& d = *decompression_;
  ZSTD_outBuffer out{to, bytes, 0};
  while (out.pos == 0 && bytes > 0 && !d.damaged) {
    if (d.begin == d.end && !d.more_inside) {
      d.begin = 0;
      d.end = read_file(d.buffer.data(), d.buffer.size());
      if (d.end == 0) return 0;
    }
    ZSTD_inBuffer in{d.buffer.data() + d.begin, std::min(d.end - d.begin, std::max<std::size_t>(d.wanted, 1)), 0};
    d.wanted = ZSTD_decompressStream(d.stream, &out, &in);
    d.begin += in.pos;
    d.damaged = ZSTD_isError(d.wanted) != 0;
    d.more_inside = out.pos == out.size;
  }
  return out.pos;
}

std::string read_whole(const std::filesystem::path& file) {
  ByteSource source;
  source.open(file);
  std::string content;
  std::vector<char> piece(std::size_t{1} << 20);
  while (const std::size_t got = source.read(piece.data(), piece.size())) content.append(piece.data(), got);
  if (source.error() != 0)
    throw InputError(file.string(), 0, std::string("cannot be read: ") + std::strerror(source.error()));
  return content;
}

}  // namespace stillcut
