// Runs a fuzz target over its kept corpus without a fuzzer, so that every build has these inputs as a test: each file
// whole, and cut off in places. replay FOLDER; exit status 0: the target stands, as otherwise it ends the program.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz.hpp"

namespace {

constexpr std::size_t kCuts = 16;

void run(const std::vector<char>& bytes, std::size_t size) {
  const std::vector<std::uint8_t> input(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  LLVMFuzzerTestOneInput(input.data(), input.size());
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> files;
  if (argc == 2)
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
  if (files.empty()) {
    std::fprintf(stderr, "replay: usage: replay FOLDER, with inputs in it\n");
    return 2;
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t cut = 1; cut <= kCuts; ++cut) run(bytes, bytes.size() * cut / kCuts);
  }
  std::printf("%zu inputs, each whole and cut off in %zu places\n", files.size(), kCuts - 1);
  return 0;
}
