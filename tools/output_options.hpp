// What a command that answers a question may be asked to write: a table, a picture, one JSON object.
#pragma once

#include <string>

#include "tools/commands.hpp"

namespace stillcut {

struct OutputOptions {
  std::string csv, plot;  // file names, `-` is standard output for csv; empty: not asked for
  bool json = false;
};

// `csv` and `plot` say in the command's help what the two files show.
void add_output_options(CLI::App& command, OutputOptions& options, const char* csv, const char* plot);

// Throws CLI::ValidationError where two outputs want standard output, InputError for a picture that cannot be.
void check_output_options(const OutputOptions& options);

}  // namespace stillcut
