// Where on a ball, seen from its tool, the places are that may still lower a map: of each angle of a tooth's tip the
// edge that can be there then. Angles stand in bins.
#pragma once

#include <array>
#include <cstddef>

namespace stillcut {

class ContactWindow {
 public:
  static constexpr std::size_t kBins = 64;  // of a turn

  struct Kappas {
    double low = 1.0, high = 0.0;  // rad; empty as long as low > high
    [[nodiscard]] bool empty() const { return low > high; }
  };

  // Points of the ball at most `around` rad away from the one at `kappa` and, clockwise about the tool's axis, `phi`.
  // A helix lets the edge trail by `tan_helix` (1 - cos kappa).
  void add(double kappa, double phi, double around, double tan_helix);

  [[nodiscard]] bool empty() const { return empty_; }
  // Of all tip angles from `first` to `last` rad, at most a turn.
  [[nodiscard]] Kappas between(double first, double last) const;

 private:
  std::array<Kappas, kBins> bins_{};
  bool empty_ = true;
};

}  // namespace stillcut
