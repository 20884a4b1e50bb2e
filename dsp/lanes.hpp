// Four floats that one instruction works on: a lane for each axis, and one to spare. What is done to every axis alike
// costs no more for three than for one. Plain SSE2 or NEON by the compiler's own vectors; the same bits as in scalars.
#pragma once

#include <cmath>

namespace stillcut {

struct Lanes {
  using Four [[gnu::vector_size(16)]] = float;
  static constexpr int kCount = 4;

  Four v{};

  Lanes() = default;
  Lanes(Four four) noexcept : v{four} {}
  explicit Lanes(float all) noexcept : v{all, all, all, all} {}
  Lanes(float a, float b, float c, float d) noexcept : v{a, b, c, d} {}

  static Lanes load(const float* from) noexcept { return {from[0], from[1], from[2], from[3]}; }

  float operator[](int lane) const noexcept { return v[lane]; }
  void set(int lane, float x) noexcept { v[lane] = x; }

  Lanes& operator+=(Lanes b) noexcept { return v += b.v, *this; }
  friend Lanes operator+(Lanes a, Lanes b) noexcept { return a.v + b.v; }
  friend Lanes operator-(Lanes a, Lanes b) noexcept { return a.v - b.v; }
  friend Lanes operator*(Lanes a, Lanes b) noexcept { return a.v * b.v; }
  friend Lanes operator*(float a, Lanes b) noexcept { return a * b.v; }

  friend Lanes min(Lanes a, Lanes b) noexcept { return a.v < b.v ? a.v : b.v; }
  friend Lanes max(Lanes a, Lanes b) noexcept { return a.v > b.v ? a.v : b.v; }
  friend Lanes sqrt(Lanes a) noexcept {
    return {std::sqrt(a.v[0]), std::sqrt(a.v[1]), std::sqrt(a.v[2]), std::sqrt(a.v[3])};
  }
  // Lane by lane: `then` where it holds, else `otherwise`.
  friend Lanes where_equal(Lanes a, Lanes b, Lanes then, Lanes otherwise) noexcept {
    return a.v == b.v ? then.v : otherwise.v;
  }
  friend Lanes where_finite(Lanes x, Lanes then, Lanes otherwise) noexcept {
    return x.v - x.v == 0.0F ? then.v : otherwise.v;
  }
  friend float sum(Lanes a) noexcept { return a.v[0] + a.v[1] + (a.v[2] + a.v[3]); }
};

}  // namespace stillcut
