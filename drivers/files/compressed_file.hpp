// A file that is written compressed (zstd) and can be read up to the last flush() whatever happens after it: a crash, a
// power cut, a full disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace stillcut {

class CompressedFile {
 public:
  // Makes the file and puts its name on the disk. Fails as write() does: see error().
  explicit CompressedFile(const std::filesystem::path& file);
  ~CompressedFile();  // closes
  CompressedFile(const CompressedFile&) = delete;
  CompressedFile& operator=(const CompressedFile&) = delete;

  // After the first error all of these do nothing and give false.
  bool write(std::string_view bytes);
  bool flush();  // all that was written is on the disk
  bool close();  // the compressed stream ends; flushed

  [[nodiscard]] int error() const { return error_; }                     // errno; 0: none
  [[nodiscard]] std::int64_t bytes_on_disk() const { return on_disk_; }  // compressed

 private:
  bool compress(std::string_view bytes, int directive);
  bool put(const char* bytes, std::size_t count);

  void* stream_;  // ZSTD_CCtx
  int descriptor_ = -1;
  int error_ = 0;
  std::int64_t on_disk_ = 0;
  std::vector<char> buffer_;
};

}  // namespace stillcut
