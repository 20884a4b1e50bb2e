// Reading a whole text file (cell file, map, DBC) with the errors that users understand.
#pragma once

#include <filesystem>
#include <string>

namespace stillcut {

// The file's bytes, a UTF-8 byte order mark at its start removed. Throws InputError when the file is missing, a folder,
// unreadable, or larger than 64 MiB (no cell file, map or DBC is).
std::string read_text_file(const std::filesystem::path& file);

}  // namespace stillcut
