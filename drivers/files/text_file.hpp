// Reading and writing whole text files (cell file, map, DBC) with the errors that users understand.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillcut {

// The file's bytes, a UTF-8 byte order mark at its start removed. Throws InputError when the file is missing, a folder,
// unreadable, or larger than 64 MiB (no cell file, map or DBC is).
std::string read_text_file(const std::filesystem::path& file);

struct NamedText {
  std::string name, text;
};

// Files that belong together: all of them are written, under other names, before the first takes its place; what is
// there already stays whole until then. Makes the folder. Throws InputError naming the file that cannot be written.
void write_text_files(const std::filesystem::path& folder, const std::vector<NamedText>& files);

}  // namespace stillcut
