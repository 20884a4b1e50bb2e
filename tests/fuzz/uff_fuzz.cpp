// Universal files, and the frequency responses in them.
#include <sstream>

#include "drivers/files/frf_file.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/uff58_file.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

namespace {

std::string binary_of(const UffFile& content) {
  std::ostringstream out;
  write_uff(out, content, UffForm::binary);
  return out.str();
}

void check_functions(UffFile content) {
  for (UffFunction& function : content.functions) function.double_precision = true;  // holds all that text can say
  const UffFile again = parse_uff(binary_of(content), "again");
  require_that(again.functions.size() == content.functions.size(), "as many functions");
  for (std::size_t i = 0; i < again.functions.size(); ++i) {
    const UffFunction &a = content.functions[i], &b = again.functions[i];
    require_that(a.abscissa == b.abscissa && a.values == b.values, "the same numbers");
    require_that(a.type == b.type && a.response_node == b.response_node && a.reference_node == b.reference_node &&
                     a.response_direction == b.response_direction && a.reference_direction == b.reference_direction,
                 "the same place");
    require_that(a.ordinate.data_type == b.ordinate.data_type && a.denominator.data_type == b.denominator.data_type,
                 "the same quantities");
  }
  if (content.units)
    require_that(
        again.units && again.units->length == content.units->length && again.units->force == content.units->force,
        "the same units");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  const UffFile content = parse_uff(text_of(data, size), "a.uff");
  check_functions(content);
  const FrfFile frf = frf_of(content, "a.uff");
  const std::string bytes = binary_of(uff_of(frf.response));
  const FrfFile again = frf_of(parse_uff(bytes, "again"), "again");
  require_that(again.response.frequencies_hz == frf.response.frequencies_hz &&
                   again.response.receptance == frf.response.receptance && again.notes.empty(),
               "the same response");
  return 0;
} catch (const InputError&) {
  return 0;
}
