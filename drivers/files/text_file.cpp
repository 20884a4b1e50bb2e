#include "drivers/files/text_file.hpp"

#include <array>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace

std::string read_text_file(const std::filesystem::path& file) {
  const auto fail = [&](const std::string& message) { throw InputError(file.string(), 0, message); };
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file; check the path");
  if (std::filesystem::is_directory(status)) fail("is a folder; name a file in it");

  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) fail("cannot be opened (" + std::generic_category().message(errno) + "); check its permissions");
  std::string text;
  std::array<char, 65536> chunk{};
  while (in.read(chunk.data(), chunk.size()) || in.gcount() > 0) {
    text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMaxBytes) fail("is larger than 64 MiB; is it the right file?");
  }
  if (in.bad()) fail("cannot be read; check the disk");
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

void write_text_files(const std::filesystem::path& folder, const std::vector<NamedText>& files) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string(), 0, "cannot be made (" + error.message() + ")");
  std::vector<std::filesystem::path> written;
  const auto fail = [&](const std::filesystem::path& file, const std::string& message) {
    std::error_code ignored;
    for (const auto& other : written) std::filesystem::remove(other, ignored);
    throw InputError(file.string(), 0, message);
  };
  for (const NamedText& file : files) {
    // An output that cannot be replaced, a folder say, is found before anything is.
    if (std::filesystem::is_directory(folder / file.name)) fail(folder / file.name, "is a folder; remove it");
    written.push_back(folder / (file.name + ".new"));
    std::ofstream out(written.back(), std::ios::binary);
    if (!out) fail(folder / file.name, "cannot be written; check the folder's permissions");
    out << file.text;
    out.close();
    if (!out) fail(folder / file.name, "cannot be written to its end; is the disk full?");
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::filesystem::rename(written[i], folder / files[i].name, error);
    if (error) fail(folder / files[i].name, "cannot be replaced (" + error.message() + ")");
  }
}

}  // namespace stillcut
