// The bytes of a file, plain or compressed by zstd, as one reads on. A compressed file that was cut short, as a power
// cut leaves it, gives all that is whole and then ends as if it ended there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace stillcut {

[[nodiscard]] bool is_compressed(const std::filesystem::path& file);  // by its name: .zst

class ByteSource {
 public:
  ByteSource();
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  // False: errno in error().
  bool open(const std::filesystem::path& file);
  void close() noexcept;

  // Up to `bytes` bytes; 0 at the end or on an error.
  std::size_t read(char* to, std::size_t bytes) noexcept;

  [[nodiscard]] int error() const noexcept { return error_; }  // errno; 0: none

 private:
  struct Decompression;
  std::size_t read_file(char* to, std::size_t bytes) noexcept;
  std::size_t decompress(char* to, std::size_t bytes) noexcept;

  int descriptor_ = -1;
  int error_ = 0;
  std::unique_ptr<Decompression> decompression_;  // empty: a plain file
};

// All of a file. Throws InputError when it cannot be read.
std::string read_whole(const std::filesystem::path& file);

}  // namespace stillcut
