#include "drivers/files/compressed_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>

namespace stillcut {
namespace {

constexpr int kLevel = 3;

// A new file's name is in its folder: without this a power cut may leave a file that nobody finds.
int sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int result = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return result == EINVAL ? 0 : result;  // a file system that cannot
}

}  // namespace

CompressedFile::CompressedFile(const std::filesystem::path& file)
    : stream_{ZSTD_createCCtx()}, buffer_(ZSTD_CStreamOutSize()) {
  auto* stream = static_cast<ZSTD_CCtx*>(stream_);
  ZSTD_CCtx_setParameter(stream, ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(stream, ZSTD_c_checksumFlag, 1);
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  error_ = descriptor_ < 0 ? errno : sync_folder(file.parent_path());
}

CompressedFile::~CompressedFile() {
  close();
  ZSTD_freeCCtx(static_cast<ZSTD_CCtx*>(stream_));
}

bool CompressedFile::write(std::string_view bytes) { return compress(bytes, ZSTD_e_continue); }

bool CompressedFile::flush() {
  if (!compress({}, ZSTD_e_flush)) return false;
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL) error_ = errno;
  return error_ == 0;
}

bool CompressedFile::close() {
  if (descriptor_ < 0) return error_ == 0;
  if (compress({}, ZSTD_e_end) && ::fdatasync(descriptor_) != 0 && errno != EINVAL) error_ = errno;
  if (::close(descriptor_) != 0 && error_ == 0) error_ = errno;
  descriptor_ = -1;
  return error_ == 0;
}

bool CompressedFile::compress(std::string_view bytes, int directive) {
  if (error_ != 0 || descriptor_ < 0) return false;
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  for (;;) {
    ZSTD_outBuffer out{buffer_.data(), buffer_.size(), 0};
    const std::size_t left =
        ZSTD_compressStream2(static_cast<ZSTD_CCtx*>(stream_), &out, &in, static_cast<ZSTD_EndDirective>(directive));
    if (ZSTD_isError(left) != 0) error_ = EIO;
    if (error_ != 0 || !put(buffer_.data(), out.pos)) return false;
    if (directive == ZSTD_e_continue ? in.pos == in.size : left == 0) return true;
  }
}

bool CompressedFile::put(const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t put = ::write(descriptor_, bytes, count);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      error_ = errno;
      return false;
    }
    bytes += put;
    count -= static_cast<std::size_t>(put);
    on_disk_ += put;
  }
  return true;
}

}  // namespace stillcut
