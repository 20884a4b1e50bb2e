#include "models/frequency_response.hpp"

#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"

namespace stillcut {

std::size_t measured_entries(const FrequencyResponse& response) {
  std::size_t count = 0;
  for (const auto& row : response.receptance)
    for (const ComplexValues& entry : row) count += entry.empty() ? 0 : 1;
  return count;
}

void require_sound_response(const FrequencyResponse& response) {
  const std::vector<double>& hz = response.frequencies_hz;
  for (std::size_t i = 0; i < hz.size(); ++i)
    if (!std::isfinite(hz[i]) || hz[i] < 0.0 || (i > 0 && hz[i] <= hz[i - 1]))
      throw std::invalid_argument("frequencies must rise, from 0 up");
  if (hz.empty() || measured_entries(response) == 0)
    throw std::invalid_argument("a frequency response needs frequencies and a measured entry");
  for (const auto& row : response.receptance)
    for (const ComplexValues& entry : row) {
      if (!entry.empty() && entry.size() != hz.size())
        throw std::invalid_argument("every measured entry needs a value at each frequency");
      for (const std::complex<double>& value : entry)
        if (!std::isfinite(value.real()) || !std::isfinite(value.imag()))
          throw std::invalid_argument("a value of a frequency response is not finite");
    }
}

ComplexValues receptance_of(ResponseKind kind, std::span<const double> frequencies_hz,
                            std::span<const std::complex<double>> values) {
  ComplexValues result(values.begin(), values.end());
  if (kind == ResponseKind::receptance) return result;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double w = kTwoPi * frequencies_hz[i];
    if (w == 0.0)
      result[i] = {kNaN, kNaN};
    else if (kind == ResponseKind::mobility)
      result[i] = std::complex<double>(result[i].imag(), -result[i].real()) / w;
    else
      result[i] /= -(w * w);
  }
  return result;
}

}  // namespace stillcut
