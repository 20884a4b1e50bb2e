// What telemetry_source sends over LCM and dds_peer expects, or sends itself, on DDS: message n of a kind has the stamp
// FIRST_STAMP_S + n periods, and members that follow from n. Read by both, so that neither asks the bridge's code.
#ifndef STILLCUT_TESTS_DDS_TOLD_H
#define STILLCUT_TESTS_DDS_TOLD_H

enum {
  FIRST_STAMP_S = 1700000000,
  STATUS_MS = 100,
  INDICATOR_MS = 50,
  SPECTRUM_MS = 50,
  SPECTRUM_BINS = 512,
  VIBRATION_MS = 5,  // a sample; a message of LCM has VIBRATION_SAMPLES
  VIBRATION_SAMPLES = 10,
  CORRECTION_MS = 100,
  EVENT_MS = 200,
  LOBES_MS = 1000,
  LOBES_POINTS = 256,
  HEALTH_MS = 1000
};

static inline double told_indicator(long n) { return 0.001 * (double)(n % 1000); }
static inline double told_frequency(long n) { return 700.0 + 0.25 * (double)(n % 400); }
static inline float told_acceleration(long n, int axis) { return (float)(n % 4096) * 0.5F + (float)axis * 0.125F; }
static inline unsigned char told_level(long n, long bin) { return (unsigned char)((n * 7 + bin) % 200); }
// dB re 1 m/s^2 of a level
static const double TOLD_LOW_DB = -60.0, TOLD_STEP_DB = 0.5;
static inline float told_limit_mm(long n, long point) { return (float)(n % 16) + (float)point / 64.0F; }

#endif
