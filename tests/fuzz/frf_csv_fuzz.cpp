// Frequency responses as CSV.
#include <sstream>

#include "drivers/files/frf_csv.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  const FrequencyResponse response = parse_frf_csv(text_of(data, size), "a.csv");
  std::ostringstream out;
  write_frf_csv(out, response);
  const FrequencyResponse again = parse_frf_csv(out.str(), "again");
  require_that(again.frequencies_hz == response.frequencies_hz && again.receptance == response.receptance,
               "the same response");
  return 0;
} catch (const InputError&) {
  return 0;
}
