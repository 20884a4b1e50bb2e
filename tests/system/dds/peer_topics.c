#include "peer_topics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "telemetry.h"
#include "told.h"

typedef stillcut_msgs_msg_dds__Status_ Status;
typedef stillcut_msgs_msg_dds__Indicator_ Indicator;
typedef stillcut_msgs_msg_dds__Spectrum_ Spectrum;
typedef sensor_msgs_msg_dds__Imu_ Imu;
typedef stillcut_msgs_msg_dds__Correction_ Correction;
typedef stillcut_msgs_msg_dds__Event_ Event;
typedef stillcut_msgs_msg_dds__Lobes_ Lobes;
typedef diagnostic_msgs_msg_dds__DiagnosticArray_ Diagnostics;
typedef builtin_interfaces_msg_dds__Time_ Time;

double speed_rpm;

// Numbers and times
static Time stamp_of(long n, int period_ms, int before_ms) {
  const long long ms = (long long)n * period_ms - before_ms;
  const long long s = (ms + 1000000000LL) / 1000 - 1000000;
  Time t = {(int32_t)(FIRST_STAMP_S + s), (uint32_t)((ms - s * 1000) * 1000000)};
  return t;
}
static bool same_time(Time a, Time b) { return a.sec == b.sec && a.nanosec == b.nanosec; }
static long number_of(Time t, int period_ms) {
  return (long)(((long long)(t.sec - FIRST_STAMP_S) * 1000 + t.nanosec / 1000000) / period_ms);
}
static bool near(double a, double b) { return fabs(a - b) <= 1e-6 * fabs(b); }
static char* text_of(const char* word, long n) {
  static char texts[4][32];
  static int next;
  char* text = texts[next++ % 4];
  snprintf(text, 32, "%s %ld", word, n);
  return text;
}

// For each topic: the number of a sample, whether its members are as told, and a sample of that number.
static long status_number(const void* sample) { return (long)((const Status*)sample)->frames; }
static bool status_told(const void* sample, long n) {
  const Status* s = sample;
  return same_time(s->header.stamp, stamp_of(n, STATUS_MS, 0)) && s->state == 3 && s->mode == 2 &&
         s->spindle_speed_rpm == speed_rpm && near(s->indicator, told_indicator(n)) && s->margin == 0.25 &&
         isnan(s->chatter_frequency_hz) && s->frames_lost == 3 &&
         same_time(s->lobes_stamp, stamp_of(n, STATUS_MS, 500));
}
static void status_make(void* sample, long n) {
  Status* s = sample;
  s->header.stamp = stamp_of(n, STATUS_MS, 0);
  s->state = 3, s->mode = 2, s->spindle_speed_rpm = speed_rpm, s->indicator = told_indicator(n), s->frames = n;
}

static long indicator_number(const void* sample) {
  return number_of(((const Indicator*)sample)->header.stamp, INDICATOR_MS);
}
static bool indicator_told(const void* sample, long n) {
  const Indicator* s = sample;
  return s->state == 5 && s->mode == 1 && s->chatter && s->kind == 1 && s->doubts == 2 &&
         near(s->indicator, told_indicator(n)) && s->spindle_speed_rpm == speed_rpm &&
         near(s->chatter_frequency_hz, told_frequency(n)) && s->chatter_amplitude_m_per_s2 == 1.5 &&
         s->chatter_mode == 2 && s->chatter_mode_hz == 2.5 && s->structural_frequency_hz == 3.5 &&
         s->decay_per_s == 4.5 && s->decay_frequency_hz == 5.5 && s->axial_depth_m == 6.5 &&
         s->feed_direction_rad == 0.75 && isinf(s->depth_limit_m) && s->margin == 8.5 && s->predicted_chatter_hz == 9.5;
}
static void indicator_make(void* sample, long n) {
  Indicator* s = sample;
  s->header.stamp = stamp_of(n, INDICATOR_MS, 0);
  s->state = 5, s->chatter = true, s->indicator = told_indicator(n), s->chatter_frequency_hz = told_frequency(n);
}

static long spectrum_number(const void* sample) {
  return number_of(((const Spectrum*)sample)->header.stamp, SPECTRUM_MS);
}
static bool spectrum_told(const void* sample, long n) {
  const Spectrum* s = sample;
  bool told = s->sensor == 1 && s->teeth == 4 && s->window_s == 0.125 && s->bin_hz == 8.0 && s->spindle_hz == 150.0 &&
              s->amplitude_m_per_s2._length == SPECTRUM_BINS;
  for (long bin = 0; told && bin < SPECTRUM_BINS; ++bin)
    told = near(20.0 * log10(s->amplitude_m_per_s2._buffer[bin]) + 100.0,
                TOLD_LOW_DB + told_level(n, bin) * TOLD_STEP_DB + 100.0);
  return told;
}
static void spectrum_make(void* sample, long n) {
  static float bins[SPECTRUM_BINS];
  Spectrum* s = sample;
  s->header.stamp = stamp_of(n, SPECTRUM_MS, 0);
  s->bin_hz = 8.0;
  for (int bin = 0; bin < SPECTRUM_BINS; ++bin) bins[bin] = bin == n % SPECTRUM_BINS ? 2.0F : 1.0F;
  s->amplitude_m_per_s2._buffer = bins;
  s->amplitude_m_per_s2._length = s->amplitude_m_per_s2._maximum = SPECTRUM_BINS;
}

static long imu_number(const void* sample) { return number_of(((const Imu*)sample)->header.stamp, VIBRATION_MS); }
static bool imu_told(const void* sample, long n) {
  const Imu* s = sample;
  return strcmp(s->header.frame_id, "tool") == 0 && s->orientation_covariance[0] == -1.0 &&
         s->angular_velocity_covariance[0] == -1.0 && s->linear_acceleration_covariance[0] == 0.0 &&
         s->linear_acceleration.x == told_acceleration(n, 0) && s->linear_acceleration.y == told_acceleration(n, 1) &&
         s->linear_acceleration.z == told_acceleration(n, 2);
}
static void imu_make(void* sample, long n) {
  Imu* s = sample;
  s->header.stamp = stamp_of(n, VIBRATION_MS, 0);
  s->header.frame_id = "tool";
  s->linear_acceleration.x = (double)n;
}

static long correction_number(const void* sample) { return (long)((const Correction*)sample)->sequence_number; }
static bool correction_told(const void* sample, long n) {
  const Correction* s = sample;
  return same_time(s->header.stamp, stamp_of(n, CORRECTION_MS, 0)) && s->valid_for_ms == 500 && s->mode == 2 &&
         s->kind == 2 && s->spindle_speed_rpm == 7500.5 && s->spindle_speed_target_rpm == 7600.5 &&
         s->speed_variation_ratio == 0.125 && s->speed_variation_hz == 1.5 && s->feed_override == 0.875 &&
         s->feed_direction_rad == 0.5 && near(s->chatter_frequency_hz, told_frequency(n)) &&
         s->predicted_margin_before == -0.25 && s->predicted_margin_after == 0.5 && s->limited_by == 17 &&
         s->confidence_percent == 80 && strcmp(s->reason, text_of("reason", n)) == 0;
}
static void correction_make(void* sample, long n) {
  Correction* s = sample;
  s->header.stamp = stamp_of(n, CORRECTION_MS, 0);
  s->sequence_number = n, s->kind = 2, s->mode = 2, s->spindle_speed_target_rpm = 7600.5,
  s->reason = text_of("reason", n);
}

static long event_number(const void* sample) { return number_of(((const Event*)sample)->header.stamp, EVENT_MS); }
static bool event_told(const void* sample, long n) {
  const Event* s = sample;
  return s->event == 3 && s->kind == 2 && near(s->frequency_hz, told_frequency(n)) &&
         near(s->indicator, told_indicator(n)) && s->spindle_speed_rpm == 9000.5 &&
         strcmp(s->note, text_of("note", n)) == 0;
}
static void event_make(void* sample, long n) {
  Event* s = sample;
  s->header.stamp = stamp_of(n, EVENT_MS, 0);
  s->event = 3, s->kind = 2, s->frequency_hz = told_frequency(n), s->note = text_of("note", n);
}

static long lobes_number(const void* sample) { return number_of(((const Lobes*)sample)->header.stamp, LOBES_MS); }
static bool lobes_told(const void* sample, long n) {
  const Lobes* s = sample;
  bool told = same_time(s->posture_stamp, stamp_of(n, LOBES_MS, 20)) && s->valid && s->min_rpm == 6000.0 &&
              s->max_rpm == 14000.0 && s->speed_scatter == 0.0625 && s->depth_scatter == 0.25 &&
              s->mode_hz._length == 2 && s->mode_hz._buffer[0] == 11.5F && s->mode_hz._buffer[1] == 712.0F &&
              s->mode_damping._length == 2 && s->mode_damping._buffer[0] == 0.03125F &&
              s->mode_damping._buffer[1] == 0.0625F && s->depth_limit_mm._length == LOBES_POINTS;
  for (long point = 0; told && point < LOBES_POINTS; ++point)
    told = s->depth_limit_mm._buffer[point] == told_limit_mm(n, point);
  return told;
}
static void lobes_make(void* sample, long n) {
  static float limits[LOBES_POINTS];
  Lobes* s = sample;
  s->header.stamp = stamp_of(n, LOBES_MS, 0);
  s->min_rpm = 6000.0, s->max_rpm = 14000.0;
  s->depth_limit_mm._buffer = limits;
  s->depth_limit_mm._length = s->depth_limit_mm._maximum = LOBES_POINTS;
}

// The bridge's own: once a second, with the host's time. Numbered by the second.
static long diagnostics_number(const void* sample) { return ((const Diagnostics*)sample)->header.stamp.sec; }
static bool diagnostics_told(const void* sample, long n) {
  static const char* parts[] = {": monitor", ": sensors", ": bus", ": loop"};
  const Diagnostics* s = sample;
  (void)n;
  bool told = s->status._length == 4;
  for (int i = 0; told && i < 4; ++i) {
    const diagnostic_msgs_msg_dds__DiagnosticStatus_* item = &s->status._buffer[i];
    told = strstr(item->name, parts[i]) != NULL && item->level <= 3 && strlen(item->message) > 0 &&
           strlen(item->hardware_id) > 0;
  }
  return told;
}
static void diagnostics_make(void* sample, long n) {
  static diagnostic_msgs_msg_dds__KeyValue_ values[2] = {{"key", "1"}, {"other key", "2"}};
  static diagnostic_msgs_msg_dds__DiagnosticStatus_ items[2];
  Diagnostics* s = sample;
  s->header.stamp.sec = (int32_t)n;
  for (int i = 0; i < 2; ++i) {
    items[i].level = (uint8_t)i;
    items[i].name = i == 0 ? "peer: first" : "peer: second";
    items[i].message = "fine";
    items[i].hardware_id = "";
    items[i].values._buffer = values;
    items[i].values._length = items[i].values._maximum = 2;
  }
  s->status._buffer = items;
  s->status._length = s->status._maximum = 2;
}

#define TOPIC(name, type, prefix) \
  { name, &type##_desc, prefix##_number, prefix##_told, prefix##_make, 0, 0, 0, 0, 0, 0, 0 }
Topic topics[TOPICS] = {TOPIC("status", stillcut_msgs_msg_dds__Status_, status),
                        TOPIC("indicator", stillcut_msgs_msg_dds__Indicator_, indicator),
                        TOPIC("spectrum", stillcut_msgs_msg_dds__Spectrum_, spectrum),
                        TOPIC("vibration", sensor_msgs_msg_dds__Imu_, imu),
                        TOPIC("correction", stillcut_msgs_msg_dds__Correction_, correction),
                        TOPIC("event", stillcut_msgs_msg_dds__Event_, event),
                        TOPIC("lobes", stillcut_msgs_msg_dds__Lobes_, lobes),
                        TOPIC("diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray_, diagnostics)};
