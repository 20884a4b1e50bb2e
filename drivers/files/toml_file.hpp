// A TOML file (cell, scenario) as a table whose nodes know their lines.
#pragma once

#include <toml++/toml.h>

#include <filesystem>

namespace stillcut {

// Throws InputError, with line and key where it can tell them, for a file that cannot be read or parsed.
toml::table read_toml_file(const std::filesystem::path& file);

}  // namespace stillcut
