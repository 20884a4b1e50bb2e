// Universal files (UFF, UNV) of modal analysis: dataset 58, functions at nodal degrees of freedom, as text or binary
// (58b), and dataset 164, the units. Other datasets are passed over. Formats: SDRC's descriptions of 58, 58b and 164,
// kept by the University of Cincinnati.
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

// Of an axis of a function: what the numbers are, and how the writer called it.
struct UffAxis {
  int data_type = 0;  // kUff…; 0 unknown
  std::string label, units;
};
inline constexpr int kUffUnknown = 0, kUffDisplacement = 8, kUffReactionForce = 9, kUffVelocity = 11,
                     kUffAcceleration = 12, kUffExcitationForce = 13, kUffTime = 17, kUffFrequency = 18;

inline constexpr int kUffTimeResponse = 1, kUffFrequencyResponse = 4, kUffCoherence = 6;  // types of a function

struct UffFunction {
  std::array<std::string, 5> id;  // lines of text, up to 80 characters each
  int type = kUffFrequencyResponse;
  int response_node = 0, reference_node = 0;
  int response_direction = 0, reference_direction = 0;  // 1 +x, -1 -x, … 3; 4 to 6 rotations; 0 none
  bool complex = true, double_precision = true;
  bool even = false;  // the abscissa was given by its begin and step
  UffAxis abscissa_axis, ordinate, denominator;
  std::vector<double> abscissa;
  std::vector<std::complex<double>> values;  // imaginary part 0 where not complex
  int line = 0;                              // of the file, where the dataset begins
};

// Numbers of the file divided by these are SI.
struct UffUnits {
  int code = 1;  // 1: SI
  std::string description = "SI";
  double length = 1.0, force = 1.0;
  int line = 0;
};

struct UffFile {
  std::optional<UffUnits> units;
  std::vector<UffFunction> functions;
};

// The bytes of a file; `file` is the name used in messages. A binary function's size follows from its points, as
// writers differ in what they say; the abscissa of double precision may be single. Throws InputError with the line (of
// binary data, where its dataset begins) for what is cut off, is no number or not finite, for other binary numbers than
// IEEE 754, and for a second dataset of other units.
[[nodiscard]] UffFile parse_uff(std::string_view bytes, const std::string& file);

enum class UffForm { text, binary };

// Binary gives the same numbers back. Text has the digits that its format has room for: 13 of values in double
// precision, 6 of values in single precision and of an uneven abscissa. An abscissa is written as begin and step where
// six digits of both give the same numbers. Throws std::invalid_argument where abscissa and values do not go together,
// for what is not finite, and for an id with more than 80 characters or a line break.
void write_uff(std::ostream& out, const UffFile& content, UffForm form);

}  // namespace stillcut
