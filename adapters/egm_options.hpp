// What stillcut-egm and its simulated controller must be told alike.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "adapters/egm_packets.hpp"

namespace stillcut {

inline void add_egm_options(CLI::App& app, EgmAnswer& answer, double& cycle_ms) {
  static const std::map<std::string, EgmAnswer> kAnswers{{"data", EgmAnswer::data}, {"path", EgmAnswer::path}};
  app.add_option("--answer", answer, "data: feed and spindle as values for RAPID (default); path: path correction")
      ->transform(CLI::CheckedTransformer(kAnswers))
      ->option_text("data|path");
  app.add_option("--cycle-ms", cycle_ms, "the controller's, a multiple of 4")
      ->capture_default_str()
      ->check(CLI::Range(4.0, 100.0));
}

}  // namespace stillcut
