// Truth of the detection benchmark: how far the tool tip moves at the chatter frequency, from the simulation itself.
// The forced vibration is taken out as what repeats every revolution; what is left is mixed down at the frequency that
// Floquet theory gives and weighted by a Hann window of a few cycles about the moment. No detector has a say in it.
#pragma once

#include <vector>

namespace stillcut::detection {

struct TipMotion {  // one value a simulated sample
  double rate_hz = 0.0;
  std::vector<double> x, y;   // m
  std::vector<double> angle;  // rad, of the spindle, rising
};

struct TipLine {
  double frequency_hz = 0.0;
  double growth_per_s = 0.0;  // that theory gives: corrects for what subtracting earlier revolutions does to a line
  bool slow = false;          // far below the spindle: nothing needs to be subtracted
};

// Takes out what repeated every revolution between two moments, times `share` of every sample (its depth of cut over
// that of those moments): a change of depth then leaves little in the revolutions that are subtracted afterwards.
void remove_repetition(TipMotion& motion, double from, double to, const std::vector<double>& share);

// Amplitude of a line at every millisecond, m, centred; 0 where it cannot be known yet. Both axes together.
std::vector<double> line_amplitude(const TipMotion& motion, const TipLine& line);

// Its frequency about a moment (s), from the phase over `length` s, Hz.
double line_frequency(const TipMotion& motion, const TipLine& line, double at, double length);

// Amplitude of the whole motion in a stretch of sound cutting: sqrt(2) of its standard deviation, m.
double forced_amplitude(const TipMotion& motion, double from, double to);

// When the line came to stand above `limit` for good before it first stood above `proof` for 20 ms, not before `from`;
// s, NaN: it never did.
struct Rise {
  double limit_s, proof_s;
};
Rise rise_of(const std::vector<double>& amplitude, double limit, double proof, double from);

}  // namespace stillcut::detection
